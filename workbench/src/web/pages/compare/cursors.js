// Two cursors with their values and differences, and the values under the pointer.

import * as api from "../../api.js";
import { element, fill, scrolling, showProblems } from "../../dom.js";
import { brief, number, signed } from "../../format.js";
import { colour } from "../../theme.js";
import * as view from "../../view.js";

export class Cursors {
  constructor(log, onMove) {
    Object.assign(this, { log, onMove, values: { a: null, b: null }, traces: null });
    const field = (name) => element("input", {
      type: "number", step: "any", class: "time", id: `cursor-${name}`, placeholder: "none", value: view.numberOf(name) ?? "",
      on: { change: (event) => this.set(name, event.target.value === "" ? null : Number(event.target.value)) },
    });
    this.fields = { a: field("a"), b: field("b") };
    this.body = scrolling("Values at the cursors");
    this.element = element("section", { class: "stack tight", "aria-labelledby": "cursors-title" },
      element("h2", { id: "cursors-title" }, "Values"),
      element("p", { class: "row" },
        element("label", {}, element("b", { class: "cursor-a" }, "A "), this.fields.a, " s"),
        element("label", {}, element("b", { class: "cursor-b" }, "B "), this.fields.b, " s")),
      this.difference = element("p", { class: "quiet" }), this.body);
  }

  /** Moves a cursor; a null time removes it. */
  set(name, time) {
    view.set({ [name]: time });
    this.fields[name].value = time === null ? "" : String(+time.toPrecision(8));
    this.onMove();
    this.fetch(name);
  }

  async refresh(traces) {
    this.traces = traces;
    await Promise.all(["a", "b"].map((name) => this.fetch(name)));
  }

  async fetch(name) {
    const time = view.numberOf(name);
    try {
      this.values[name] = time === null ? null : (await api.get(`/logs/${this.log.number}/values?time_s=${time}`)).signals;
    } catch (refusal) {
      showProblems(refusal, "Cursor");
    }
    this.show();
  }

  hover(time, traces) {
    this.pointer = time === null || !traces ? null : new Map(traces.signals.map((signal) => [signal.name, {
      measured: at(signal.measured, time), model: signal.model && at(signal.model, time), residual: signal.residual && at(signal.residual.trace, time),
    }]));
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => { this.isWaiting = false; this.show(); });
  }

  show() {
    if (!this.traces) return;
    const { a, b } = this.values;
    const [from, to] = [view.numberOf("a"), view.numberOf("b")];
    this.difference.textContent = from !== null && to !== null
      ? `B − A = ${signed(to - from, 5)} s${to === from ? "" : `, 1/Δt = ${number(1 / Math.abs(to - from), 4)} Hz`}` : "Click in a plot for A, Alt-click for B.";
    const rows = [];
    for (const signal of this.traces.signals.toSorted((one, other) => one.is_input - other.is_input)) {
      const of = (values) => values?.find((one) => one.name === signal.name);
      const [left, right] = [of(a), of(b)];
      const pointer = this.pointer?.get(signal.name);
      const row = (title, key, role) => {
        const [x, y] = [left?.[key] ?? null, right?.[key] ?? null];
        rows.push(element("tr", { class: key === "measured" ? "first" : undefined }, element("th", { scope: "row" }, element("span", { class: `key ${role}` }, title)),
          element("td", {}, brief(pointer?.[key])), element("td", {}, brief(x)), element("td", {}, brief(y)),
          element("td", {}, x !== null && y !== null ? `${y > x ? "+" : ""}${brief(y - x)}` : "–")));
      };
      row(`${signal.name} [${signal.unit}]`, "measured", signal.is_input ? "input" : "measured");
      if (signal.model) row("modelled", "model", "model");
      if (signal.residual) row(`residual [${signal.residual.unit}]`, "residual", "residual");
    }
    fill(this.body, element("table", { class: "numbers", id: "values" },
      element("thead", {}, element("tr", {}, ["", "pointer", "A", "B", "B\u00a0−\u00a0A"].map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {}, rows)));
  }

  lines() {
    return ["a", "b"].map((name) => [name, view.numberOf(name)]).filter(([, time]) => time !== null);
  }

  shapes() {
    return this.lines().map(([name, time]) => ({ type: "line", xref: "x", x0: time, x1: time, yref: "paper", y0: 0, y1: 1, line: { color: colour(`cursor-${name}`), width: 1.5, dash: name === "a" ? "solid" : "dash" } }));
  }

  labels() {
    return this.lines().map(([name, time]) => ({ xref: "x", x: time, yref: "paper", y: 0, yanchor: "top", yshift: 2, showarrow: false, text: name.toUpperCase(), font: { color: colour("card"), size: 11 }, bgcolor: colour(`cursor-${name}`), borderpad: 2 }));
  }
}

/** Returns the value of a trace at its last point before a time. */
function at(trace, time) {
  let low = 0, high = trace.t.length - 1;
  if (high < 0) return null;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    const there = trace.t[middle] ?? trace.t[middle - 1];
    if (there <= time) low = middle; else high = middle - 1;
  }
  return trace.y[low];
}
