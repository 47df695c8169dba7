// Closer looks: the residual over any signal, the PWM period folded, and another log brought onto this one.

import * as api from "../../api.js";
import { axis, clear, draw, label, layout, saveImage } from "../../chart.js";
import { button, element, fill, tell, tellProblems } from "../../dom.js";
import { count, duration, number, signed } from "../../format.js";
import { colour } from "../../theme.js";
import * as view from "../../view.js";

/** Builds the looks below the plots; `refresh` follows the visible range, `redraw` the colours. */
export function closerLooks(place, log, logs, comparison, project, onShift) {
  const names = log.summary.signals.map((signal) => signal.name);
  const compared = comparison.signals.map((signal) => signal.name);
  const looks = [new Scatter(log, compared, names), new Fold(log, names, compared)];
  const others = logs.filter((one) => one !== log);
  const shifts = new Shifts(log, others, onShift);
  fill(place, element("div", { class: "columns even" }, looks.map((look) => look.element)), others.length > 0 && shifts.element);
  const all = (act) => Promise.all(looks.map((look) => act(look).catch((error) => tellProblems(error, look.title))));
  return { refresh: () => all((look) => look.fetch()), redraw: () => all((look) => look.paint()), showShift: (moved) => shifts.show(moved), leave: () => looks.forEach((look) => clear(look.chart)) };
}

/** The visible range for a request. */
function rangeQuery(query) {
  for (const [name, key] of [["from", "from_s"], ["to", "to_s"]]) {
    const value = view.numberOf(name);
    if (value !== null) query.set(key, value);
  }
  return query;
}

const chooser = (name, entries, value, act) => element("select", { "aria-label": name, id: name, on: { change: (event) => act(event.target.value) } },
  entries.map(([key, text]) => element("option", { value: key, selected: key === value }, text)));

class Look {
  constructor(title, id) {
    this.title = title;
    this.chart = element("div", { class: "chart", id });
    this.tools = element("div", { class: "row" });
    this.note = element("p", { class: "quiet" });
    this.element = element("section", { class: "card", "aria-label": title }, element("h2", {}, title), this.tools, this.chart, this.note);
  }

  exports(name) {
    return ["png", "svg"].map((format) => button(format.toUpperCase(), () => saveImage(this.chart, format, name).catch((error) => tellProblems(error, format))));
  }
}

class Scatter extends Look {
  constructor(log, compared, names) {
    super("Residual over a signal", "scatter");
    Object.assign(this, { log });
    this.signal = compared.includes(view.text("signal")) ? view.text("signal") : compared[0];
    const overs = [["time", "time"], ...names.map((name) => [name, name]), ...compared.map((name) => [`${name}_model`, `${name}, modelled`])];
    this.over = overs.some(([key]) => key === view.text("over")) ? view.text("over") : names.includes("p_ch") ? "p_ch" : "time";
    fill(this.tools,
      element("label", {}, "Residual of ", chooser("scatter-signal", compared.map((name) => [name, name]), this.signal, (value) => this.choose({ signal: value }))),
      element("label", {}, " over ", chooser("scatter-over", overs, this.over, (value) => this.choose({ over: value }))),
      element("span", { class: "space" }), this.exports("scatter"));
  }

  choose(change) {
    Object.assign(this, change);
    view.set(change);
    this.fetch().catch((error) => tellProblems(error, this.title));
  }

  async fetch() {
    const query = rangeQuery(new URLSearchParams({ signal: this.signal, over: this.over }));
    if (view.text("select")) query.set("select", view.text("select"));
    this.data = await api.get(`/logs/${this.log.number}/scatter?${query}`);
    await this.paint();
  }

  async paint() {
    if (!this.data) return;
    const { unit, over_unit: overUnit, points, selected, samples } = this.data;
    const dots = (of, role, size) => ({ type: "scatter", mode: "markers", x: of.x, y: of.y, customdata: of.t, marker: { color: colour(role), size, opacity: role === "residual" ? 0.55 : 0.9 }, hovertemplate: "%{x:.5g}, %{y:.4g}<br>at %{customdata:.4f} s<extra></extra>" });
    await draw(this.chart, [dots(points, "residual", 3.5), dots(selected, "model", 5)], layout({
      height: 320, xaxis: axis({ title: { text: label(`${this.over} [${overUnit}]`) } }), yaxis: axis({ title: { text: label(`${this.signal}: measured − modelled [${unit}]`) }, zeroline: true }),
    }));
    this.note.textContent = `${count(samples)} samples in the visible range, one dot for each place.${selected.x.length > 0 ? " Orange: those that are marked." : ""}`;
  }
}

class Fold extends Look {
  constructor(log, names, compared) {
    super("Periods on top of each other", "fold");
    Object.assign(this, { log });
    const signals = names.filter((name) => !name.startsWith("duty_"));
    this.signal = signals.includes(view.text("fold")) ? view.text("fold") : signals.find((name) => name.startsWith("i_") && compared.includes(name)) ?? signals[0];
    this.period = element("input", { type: "number", min: 0, step: "any", class: "short", id: "fold-period", value: view.numberOf("period") ?? "", placeholder: "PWM", on: { change: () => { view.set({ period: this.period.value }); this.again(); } } });
    fill(this.tools,
      element("label", {}, "Signal ", chooser("fold-signal", signals.map((name) => [name, name]), this.signal, (value) => { this.signal = value; view.set({ fold: value }); this.again(); })),
      element("label", {}, " period ", this.period, " ms"), element("span", { class: "space" }), this.exports("fold"));
  }

  again() {
    this.fetch().catch((error) => tellProblems(error, this.title));
  }

  async fetch() {
    const query = rangeQuery(new URLSearchParams({ signal: this.signal }));
    if (this.period.value !== "") query.set("period_ms", this.period.value);
    this.data = await api.get(`/logs/${this.log.number}/fold?${query}`);
    await this.paint();
  }

  async paint() {
    if (!this.data) return;
    const { period_ms: period, unit, measured, model, samples, sample_interval_ms: interval } = this.data;
    const dots = (of, role) => ({ type: "scatter", mode: "markers", x: of.phase_ms, y: of.value, marker: { color: colour(role), size: 3, opacity: 0.35 }, hoverinfo: "skip" });
    const line = (of, role) => ({ type: "scatter", mode: "lines", x: of.mean_phase_ms, y: of.mean, line: { color: colour(role), width: 2 }, hovertemplate: `%{x:.3f} ms: %{y:.4g} ${label(unit)}<extra></extra>` });
    const isCoarse = interval !== null && interval > period / 4;
    await draw(this.chart, [dots(measured, "measured"), dots(model, "model"), line(measured, "measured"), line(model, "model")], layout({
      height: 320, xaxis: axis({ title: { text: "time within the period [ms]" }, range: [0, period] }), yaxis: axis({ title: { text: label(`${this.signal} [${unit}]`) } }),
    }));
    this.note.textContent = `${count(samples)} samples in the visible range, period ${number(period, 4)} ms; lines are means.`
      + (isCoarse ? ` A sample every ${duration(interval / 1e3)} cannot show what is within a PWM period; choose a longer one, or a scope log.` : "");
  }
}

/** The time offset of each other log: by number, by a slider, by cross-correlation. */
class Shifts {
  constructor(log, others, onShift) {
    Object.assign(this, { log, onShift, fields: new Map() });
    this.element = element("section", { class: "card" }, element("h2", {}, "Other logs on this time axis"),
      element("p", { class: "quiet" }, "Tick a log above the plots to lay it over this one; its offset moves all its signals. Dragging in the plots with Ctrl moves it too."),
      element("div", { class: "scroll" }, element("table", {}, element("thead", {}, element("tr", {}, ["log", "offset", "drag", "by cross-correlation"].map((cell) => element("th", { scope: "col" }, cell)))), element("tbody", {}, others.map((other) => this.row(other))))));
  }

  row(other) {
    const reach = Math.max(1, 0.1 * this.log.summary.duration_s);
    const field = element("input", { type: "number", step: "any", class: "time", "aria-label": `offset of ${other.name}`, on: { change: () => this.apply(other, Number(field.value)) } });
    const slider = element("input", { type: "range", min: other.offset_s - reach, max: other.offset_s + reach, step: reach / 1000, "aria-label": `drag the offset of ${other.name}`, on: { input: () => this.apply(other, Number(slider.value)) } });
    this.fields.set(other, [field, slider]);
    this.show(other);
    const names = this.log.summary.signals.map((one) => one.name).filter((name) => other.summary.signals.some((one) => one.name === name));
    const signal = element("select", { "aria-label": "signal to align by" }, names.map((name) => element("option", { value: name, selected: name === "p_ch" }, name)));
    const note = element("span", { class: "quiet" });
    return element("tr", {}, element("th", { scope: "row" }, other.name), element("td", {}, field, " s"), element("td", {}, slider),
      element("td", {}, names.length > 0 && ["by ", signal, " ", button("Align", () => this.align(other, signal.value, note))], " ", note));
  }

  /** Shows the offset that a log has. */
  show(other) {
    for (const field of this.fields.get(other) ?? []) field.value = String(+other.offset_s.toPrecision(8));
  }

  async apply(other, offset) {
    try {
      await api.put(`/logs/${other.number}/offset`, { offset_s: offset });
      other.offset_s = offset;
      this.show(other);
      this.onShift();
    } catch (refusal) {
      tellProblems(refusal, other.name);
    }
  }

  async align(other, signal, note) {
    try {
      const found = await api.get(`/logs/${other.number}/alignment?${new URLSearchParams({ with: this.log.number, signal })}`);
      await this.apply(other, found.offset_s + this.log.offset_s);
      note.textContent = `${signed(found.offset_s, 4)} s, correlation ${number(found.correlation, 3)}`;
      if (found.correlation < 0.8) tell(`${other.name}: the two logs hardly resemble each other (correlation ${number(found.correlation, 3)}).`);
    } catch (refusal) {
      tellProblems(refusal, other.name);
    }
  }
}
