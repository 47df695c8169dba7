// The courses over time: one plot for each signal, the residual with its noise below, all on one time axis.

import * as api from "../../api.js";
import { axis, clear, draw, label, layout, plotly, saveImage } from "../../chart.js";
import { button, element, fill, save, tellProblems } from "../../dom.js";
import { count, number, signed, titled } from "../../format.js";
import { colour } from "../../theme.js";
import * as view from "../../view.js";

/** Heights (px): a signal, its residual, an input, the room between, the room for the title above each. */
const HEIGHT = { signal: 150, residual: 84, input: 78, gap: 30 };
const MARGIN = { l: 64, r: 14, t: 30, b: 44 };
/** Until a person rests for so long (ms), only the axes follow; then the points, and then the looks below. */
const REST = { points: 120, looks: 400 };
/** A view is fetched with so much of its width on either side, so that moving shows no empty edge. */
const BESIDE = 0.5;

export class TimePlots {
  constructor(log, logs, cursors, onView) {
    Object.assign(this, { log, logs, cursors, onView, courses: null, overlays: [], hidden: new Set((view.text("hide") ?? "").split(",").filter(Boolean)) });
    this.chart = element("div", { class: "chart", id: "time-plots", tabIndex: 0, role: "application", "aria-label": "Courses over time. Plus and minus zoom, arrows move, Home shows all, a and b set a cursor in the middle." });
    this.pointer = element("div", { class: "pointer", hidden: true });
    this.choices = element("div", { class: "row choices" });
    this.metrics = element("div", { class: "scroll" });
    this.element = element("section", { class: "card", "aria-label": "Courses" },
      element("div", { class: "row tools" }, element("h2", {}, "Measured and modelled"), element("span", { class: "space" }),
        button("−", () => this.zoom(2), { title: "Zoom out (−)", "aria-label": "Zoom out" }),
        button("+", () => this.zoom(0.5), { title: "Zoom in (+)", "aria-label": "Zoom in" }),
        button("◀", () => this.move(-0.25), { title: "Earlier (←)", "aria-label": "Earlier" }),
        button("▶", () => this.move(0.25), { title: "Later (→)", "aria-label": "Later" }),
        button("Whole log", () => this.look(null, null), { title: "Home", id: "whole" }),
        this.exportMenu()),
      this.legend(), this.choices,
      element("div", { class: "over" }, this.chart, this.pointer),
      element("p", { class: "quiet hint" }, "Drag to zoom, drag with Shift to move, Ctrl and the wheel to zoom, double-click for the whole log. A click sets cursor A, with Alt cursor B."),
      element("h3", {}, "Residual within the visible range"), this.metrics);
    this.listen();
  }

  legend() {
    const entry = (role, text) => element("span", { class: `key ${role}` }, text);
    return element("span", { class: "row legend" }, entry("measured", "measured"), entry("model", "modelled"), entry("residual", "measured − modelled"), entry("noise", "±2 σ of the noise"), entry("limit", "limit of the rms"));
  }

  exportMenu() {
    const name = `${this.log.name.replace(/\.[^.]*$/, "")}-comparison`;
    const image = (format) => saveImage(this.chart, format, name).catch((error) => tellProblems(error, format));
    const data = (format) => save(`${name}.${format}`, api.address(`/logs/${this.log.number}/${format}?${this.rangeQuery()}`));
    return element("details", { class: "menu" }, element("summary", {}, "Export"),
      element("div", { class: "popup stack" },
        button("PNG", () => image("png"), { id: "export-png" }), button("SVG", () => image("svg"), { id: "export-svg" }),
        button("CSV of the visible range", () => data("csv"), { id: "export-csv" }), button("MF4 of the visible range", () => data("mf4"), { id: "export-mf4" })));
  }

  rangeQuery() {
    const { from, to } = this.range();
    return new URLSearchParams({ from_s: from, to_s: to }).toString();
  }

  /** What is visible (s). */
  range() {
    const [begin, end] = this.courses?.whole_s ?? [0, 1];
    return { from: view.numberOf("from") ?? begin, to: view.numberOf("to") ?? end };
  }

  leave() {
    this.ending.abort();
    this.fetching?.abort();
    clearTimeout(this.waiting);
    clearTimeout(this.resting);
    clear(this.chart);
  }

  redraw() {
    if (this.courses) this.paint();
  }

  /** Fetches what is visible, and draws it. */
  async refresh() {
    this.fetching?.abort();
    const fetching = this.fetching = new AbortController();
    const points = Math.max(400, Math.min(2400, Math.round(0.8 * (this.chart.clientWidth || 900))));
    const fetch = (log, from, to, more) => {
      const query = new URLSearchParams({ points: Math.round(points * (1 + 2 * BESIDE)), ...more });
      if (from !== null) query.set("from_s", from);
      if (to !== null) query.set("to_s", to);
      return api.get(`/logs/${log}/courses?${query}`, fetching.signal);
    };
    const beside = (from, to) => from === null || to === null ? [null, null] : [from - BESIDE * (to - from), to + BESIDE * (to - from)];
    const [from, to] = beside(view.numberOf("from"), view.numberOf("to"));
    const select = view.text("select");
    try {
      this.courses = await fetch(this.log.number, from, to, select ? { select } : {});
      const beyond = this.logs.filter((log) => this.overlaid().includes(log.number));
      this.overlays = await Promise.all(beyond.map(async (log) => {
        const shift = log.offset_s - this.log.offset_s;
        return { log, shift, courses: await fetch(log.number, from === null ? null : from - shift, to === null ? null : to - shift, {}) };
      }));
    } catch (error) {
      if (error.name === "AbortError") return;
      throw error;
    }
    await this.paint();
    this.showChoices();
    this.showMetrics();
    this.cursors.refresh(this.courses);
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.onView(), REST.looks);
  }

  overlaid() {
    return (view.text("with") ?? "").split(",").filter(Boolean).map(Number);
  }

  /** Goes to a range; none is the whole log. */
  look(from, to) {
    if (from !== null) {
      const [begin, end] = this.courses.whole_s;
      const least = 1e-6 * (end - begin);
      if (to - from < least) to = from + least;
      // Beyond twice the log there is nothing to see.
      if (to - from > 2 * (end - begin)) [from, to] = [null, null];
    }
    view.set({ from, to });
    this.showRange();
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.refresh().catch((error) => tellProblems(error, "View")), REST.points);
  }

  /** Moves the axes at once, with the points that are there. */
  async showRange() {
    if (!this.courses || !this.chart.layout) return;
    const { from, to } = this.range();
    const library = await plotly();
    await library.relayout(this.chart, { "xaxis.range": [from, to] });
  }

  zoom(factor, share = 0.5) {
    const { from, to } = this.range();
    const middle = from + share * (to - from);
    this.look(middle - share * factor * (to - from), middle + (1 - share) * factor * (to - from));
  }

  move(share) {
    const { from, to } = this.range();
    this.look(from + share * (to - from), to + share * (to - from));
  }

  goTo(time) {
    const [begin, end] = this.courses.whole_s;
    const half = (end - begin) / 40;
    this.cursors.set("a", time);
    this.look(time - half, time + half);
    this.element.scrollIntoView({ behavior: "smooth", block: "start" });
  }

  showChoices() {
    const signals = this.courses.signals.map((signal) => signal.name);
    const choose = (name) => () => {
      if (!this.hidden.delete(name)) this.hidden.add(name);
      view.set({ hide: [...this.hidden].join(",") });
      this.paint();
    };
    const others = this.logs.filter((log) => log !== this.log);
    const overlay = (log) => () => {
      const now = this.overlaid();
      view.set({ with: (now.includes(log.number) ? now.filter((one) => one !== log.number) : [...now, log.number]).join(",") });
      this.refresh();
    };
    const check = (text, checked, act, data, role = "") => element("label", { class: "choice" }, element("input", { type: "checkbox", checked, data, on: { change: act } }), element("span", { class: role && `key ${role}` }, ` ${text}`));
    const hue = (log) => { const place = this.overlays.findIndex((one) => one.log === log); return place < 0 ? "" : `overlay-${place % 2}`; };
    fill(this.choices,
      element("span", { class: "quiet" }, "Signals"), signals.map((name) => check(name, !this.hidden.has(name), choose(name), { signal: name })),
      others.length > 0 && element("span", { class: "quiet" }, "and beside it"), others.map((log) => check(log.name, this.overlaid().includes(log.number), overlay(log), { overlay: log.number }, hue(log))));
  }

  showMetrics() {
    const rows = this.courses.signals.filter((signal) => signal.residual?.metrics).map((signal) => {
      const { metrics, unit, limit, holds } = signal.residual;
      return element("tr", {}, element("th", { scope: "row" }, signal.name),
        [count(metrics.samples), number(metrics.rms), number(metrics.mean_absolute), signed(metrics.bias), number(metrics.standard_deviation), signed(metrics.lowest), signed(metrics.highest), number(limit), unit].map((cell) => element("td", {}, cell)),
        element("td", {}, element("span", { class: `chip ${holds === null ? "open" : holds ? "good" : "bad"}`, title: "over the whole log" }, holds === null ? "no limit" : holds ? "holds" : "beyond")));
    });
    fill(this.metrics, rows.length === 0 ? element("p", { class: "quiet" }, "Not compared yet.") : element("table", { class: "numbers", id: "metrics" },
      element("thead", {}, element("tr", {}, ["signal", "samples", "rms", "mean |e|", "bias", "std", "lowest", "highest", "limit of rms", "unit", "whole log"].map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {}, rows)));
  }

  /** The plots from top to bottom: place, height and what is in it. */
  panels() {
    const shown = this.courses.signals.filter((signal) => !this.hidden.has(signal.name));
    const panels = [];
    for (const signal of shown.filter((one) => !one.is_input)) {
      panels.push({ kind: "signal", height: HEIGHT.signal, signals: [signal], title: `${titled(signal.name)} [${signal.unit}]` });
      if (signal.residual) panels.push({ kind: "residual", height: HEIGHT.residual, signals: [signal], title: `${signal.name}: measured − modelled [${signal.residual.unit}]` });
    }
    const duties = shown.filter((one) => one.is_input && one.name.startsWith("duty_"));
    if (duties.length > 0) panels.push({ kind: "input", height: HEIGHT.input, signals: duties, title: `duty cycles [${duties[0].unit}]` });
    for (const signal of shown.filter((one) => one.is_input && !one.name.startsWith("duty_"))) {
      panels.push({ kind: "input", height: HEIGHT.input, signals: [signal], title: `${titled(signal.name)} [${signal.unit}]` });
    }
    return panels;
  }

  async paint() {
    const panels = this.panels();
    const plotted = panels.reduce((sum, panel) => sum + panel.height, 0) + HEIGHT.gap * Math.max(0, panels.length - 1);
    const { from, to } = this.range();
    const wished = layout({
      height: plotted + MARGIN.t + MARGIN.b, margin: MARGIN, hovermode: false, annotations: [], shapes: [],
      xaxis: axis({ range: [from, to], title: { text: "time in the log [s]", standoff: 6 }, anchor: "free", position: 0, domain: [0, 1] }),
    });
    const traces = [];
    let above = 0;
    panels.forEach((panel, index) => {
      const name = index === 0 ? "y" : `y${index + 1}`;
      const domain = [1 - (above + panel.height) / plotted, 1 - above / plotted].map((share) => Math.max(0, Math.min(1, share)));
      above += panel.height + HEIGHT.gap;
      const drawn = this.drawPanel(panel, name, wished);
      traces.push(...drawn.traces);
      wished[`yaxis${index === 0 ? "" : index + 1}`] = axis({ domain, range: drawn.range, fixedrange: true, nticks: panel.kind === "signal" ? 6 : 4, anchor: "x" });
      wished.annotations.push({ xref: "paper", yref: "paper", x: 0, y: domain[1], xanchor: "left", yanchor: "bottom", showarrow: false, text: label(panel.title), font: { size: 12, color: colour(panel.kind === "residual" ? "label" : "ink") } });
    });
    wished.shapes.push(...this.selection(), ...this.cursors.shapes());
    wished.annotations.push(...this.cursors.labels());
    this.basis = { annotations: wished.annotations.length - this.cursors.labels().length, shapes: wished.shapes.length - this.cursors.shapes().length };
    await draw(this.chart, traces, wished);
    this.watchLibrary();
  }

  drawPanel(panel, yaxis, wished) {
    const { from, to } = this.range();
    const values = [];
    const line = (course, role, more = {}) => {
      course.t.forEach((time, index) => { if (time !== null && time >= from && time <= to && course.y[index] !== null) values.push(course.y[index]); });
      return { x: course.t, y: course.y, xaxis: "x", yaxis, mode: "lines", type: "scatter", hoverinfo: "skip", line: { color: colour(role), width: 1.4, ...more } };
    };
    const [signal] = panel.signals;
    if (panel.kind === "residual") {
      const { course, noise, limit } = signal.residual;
      const band = (half, role, layer = "below") => wished.shapes.push({ type: "rect", xref: "paper", x0: 0, x1: 1, yref: yaxis, y0: -half, y1: half, fillcolor: colour(role), line: { width: 0 }, layer });
      if (noise) { values.push(2 * noise, -2 * noise); band(2 * noise, "band"); }
      const traces = [line(course, "residual")];
      if (limit) for (const at of [limit, -limit]) wished.shapes.push({ type: "line", xref: "paper", x0: 0, x1: 1, yref: yaxis, y0: at, y1: at, line: { color: colour("limit"), width: 1, dash: "dot" } });
      return { traces, range: padded(values) };
    }
    if (panel.kind === "input") {
      const role = (name) => name === "duty_fill" ? "fill" : name === "duty_vent" ? "vent" : "measured";
      const traces = panel.signals.map((one) => line(one.measured, role(one.name), { shape: one.name.startsWith("duty_") ? "hv" : "linear" }));
      return { traces, range: panel.signals[0].name.startsWith("duty_") ? [-6, 106] : padded(values) };
    }
    const overlays = this.overlays.flatMap(({ courses, shift }, index) => courses.signals.filter((one) => one.name === signal.name && one.unit === signal.unit)
      .map((one) => line({ t: one.measured.t.map((time) => time === null ? null : time + shift), y: one.measured.y }, `overlay-${index % 2}`, { width: 1.1 })));
    const few = signal.measured.t.length < 120;
    const measured = line(signal.measured, "measured", { width: 2 });
    if (few) Object.assign(measured, { mode: "lines+markers", marker: { size: 4, color: colour("measured") } });
    return { traces: [...overlays, measured, ...(signal.model ? [line(signal.model, "model", { width: 1.2 })] : [])], range: padded(values) };
  }

  /** The picked samples as bands through all plots. */
  selection() {
    const { from, to } = this.range();
    const pieces = this.courses.selection?.pieces_s ?? [];
    const least = (to - from) / 1500;
    const path = pieces.map(([begin, end]) => [begin, Math.max(end, begin + least)]).map(([begin, end]) => `M${begin},0L${begin},1L${end},1L${end},0Z`).join("");
    return path === "" ? [] : [{ type: "path", xref: "x", yref: "paper", path, fillcolor: colour("selection"), line: { width: 0 }, layer: "below" }];
  }

  /** Moves the cursors without drawing the courses again. */
  async mark() {
    if (!this.chart.layout) return;
    const library = await plotly();
    const { annotations, shapes } = this.chart.layout;
    await library.relayout(this.chart, {
      annotations: [...annotations.slice(0, this.basis.annotations), ...this.cursors.labels()],
      shapes: [...shapes.slice(0, this.basis.shapes), ...this.cursors.shapes()],
    });
  }

  /** What a person did with the library's own hands. */
  watchLibrary() {
    if (this.isWatched) return;
    this.isWatched = true;
    this.chart.on("plotly_relayout", (change) => {
      const range = change["xaxis.range"] ?? [change["xaxis.range[0]"], change["xaxis.range[1]"]];
      const { from, to } = this.range();
      if (Number.isFinite(range[0]) && (range[0] !== from || range[1] !== to)) this.look(range[0], range[1]);
    });
  }

  /** The time under a pointer; none beside the plots. */
  timeAt(event) {
    const box = this.chart.getBoundingClientRect();
    const share = (event.clientX - box.left - MARGIN.l) / (box.width - MARGIN.l - MARGIN.r);
    const { from, to } = this.range();
    return share >= 0 && share <= 1 ? { time: from + share * (to - from), share } : null;
  }

  listen() {
    const { chart } = this;
    const { signal } = this.ending = new AbortController();
    let pressed = null;
    chart.addEventListener("pointerdown", (event) => { pressed = { x: event.clientX, y: event.clientY }; }, true);
    // The library covers the whole window while a button is down.
    addEventListener("pointerup", (event) => {
      const moved = pressed ? Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) : 99;
      const at = this.timeAt(event);
      if (moved < 4 && at) this.cursors.set(event.altKey ? "b" : "a", at.time);
      pressed = null;
    }, { capture: true, signal });
    chart.addEventListener("dblclick", () => this.look(null, null));
    chart.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      const at = this.timeAt(event);
      if (at) this.zoom(Math.exp(event.deltaY / 400), at.share);
    }, { passive: false });
    chart.addEventListener("pointermove", (event) => {
      const at = this.timeAt(event);
      this.pointer.hidden = !at;
      if (!at) return;
      this.pointer.style.left = `${event.clientX - this.chart.getBoundingClientRect().left}px`;
      this.cursors.hover(at.time, this.courses);
    });
    chart.addEventListener("pointerleave", () => { this.pointer.hidden = true; this.cursors.hover(null); });
    chart.addEventListener("keydown", (event) => {
      const { from, to } = this.range();
      const acts = {
        "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2), ArrowLeft: () => this.move(-0.1), ArrowRight: () => this.move(0.1),
        Home: () => this.look(null, null), a: () => this.cursors.set("a", (from + to) / 2), b: () => this.cursors.set("b", (from + to) / 2),
      };
      const act = Object.hasOwn(acts, event.key) && acts[event.key];
      if (!act || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      act();
    });
  }
}

/** A range around the values, with some air. */
function padded(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
  if (low > high) return [0, 1];
  const air = 0.06 * (high - low) || 0.05 * Math.abs(high) || 1;
  return [low - air, high + air];
}
