// Detail charts: residual over any signal, folding by PWM period, histograms and spectra, and the time offsets of other
// logs.

import * as api from "../../api.js";
import { axis, clear, draw, label, layout } from "../../chart.js";
import { element, fill, showProblems } from "../../dom.js";
import { count, duration, number } from "../../format.js";
import { colour } from "../../theme.js";
import { NAMES } from "../../time-view.js";
import * as view from "../../view.js";
import { Look, chooser, rangeQuery } from "./look.js";
import { Shifts } from "./shifts.js";
import { Distribution, Spectrum } from "./statistics.js";

/** Builds the charts below the plots; `refresh` follows the visible range, `redraw` the colours. */
export function closerLooks(place, log, logs, comparison, project, onShift) {
  const names = log.summary.signals.map((signal) => signal.name);
  const compared = comparison.signals.map((signal) => signal.name);
  const looks = [new Scatter(log, compared, names), new Fold(log, names, compared), new Distribution(log, compared, names), new Spectrum(log, compared, names)];
  // The names of exports have the plant.
  for (const look of looks) look.plant = project.plant;
  const others = logs.filter((one) => one !== log);
  const shifts = new Shifts(log, others, onShift);
  fill(place, element("div", { class: "columns even" }, looks.map((look) => look.element)), others.length > 0 && shifts.element);
  const all = (act) => Promise.all(looks.map((look) => act(look).catch((error) => showProblems(error, look.title))));
  return { refresh: () => all((look) => look.fetch()), redraw: () => all((look) => look.paint()), showShift: (moved) => shifts.show(moved), leave: () => looks.forEach((look) => clear(look.chart)) };
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
      element("span", { class: "space" }), this.exports());
  }

  get content() { return `${this.signal} over ${this.over}`; }

  choose(change) {
    Object.assign(this, change);
    view.set(change);
    this.again();
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
    const dots = (of, role, size, name) => ({ name, type: "scatter", mode: "markers", x: of.x, y: of.y, customdata: of.t, marker: { color: colour(role), size, opacity: role === "residual" ? 0.55 : 0.9 }, hovertemplate: "%{x:.5g}, %{y:.4g}<br>at %{customdata:.4f} s<extra></extra>" });
    await draw(this.chart, [dots(points, "residual", 3.5, "measured − modelled"), dots(selected, "model", 5, selected.x.length > 0 ? "marked samples" : undefined)], layout({
      height: 320, xaxis: axis({ title: { text: label(`${this.over} [${overUnit}]`) } }), yaxis: axis({ title: { text: label(`${this.signal}: measured − modelled [${unit}]`) }, zeroline: true }),
    }));
    this.note.textContent = `${count(samples)} samples in the visible range; coinciding ones share a dot.${selected.x.length > 0 ? " Orange: marked samples." : ""}`;
  }
}

class Fold extends Look {
  constructor(log, names, compared) {
    super("Fold by PWM period", "fold");
    Object.assign(this, { log });
    const signals = names.filter((name) => !name.startsWith("duty_"));
    this.signal = signals.includes(view.text("fold")) ? view.text("fold") : signals.find((name) => name.startsWith("i_") && compared.includes(name)) ?? signals[0];
    this.period = element("input", { type: "number", min: 0, step: "any", class: "short", id: "fold-period", value: view.numberOf("period") ?? "", placeholder: "PWM", on: { change: () => { view.set({ period: this.period.value }); this.again(); } } });
    fill(this.tools,
      element("label", {}, "Signal ", chooser("fold-signal", signals.map((name) => [name, name]), this.signal, (value) => { this.signal = value; view.set({ fold: value }); this.again(); })),
      element("label", {}, " period ", this.period, " ms"), element("span", { class: "space" }), this.exports());
  }

  get content() { return this.signal; }

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
    const line = (of, role) => ({ name: NAMES[role], type: "scatter", mode: "lines", x: of.mean_phase_ms, y: of.mean, line: { color: colour(role), width: 2 }, hovertemplate: `%{x:.3f} ms: %{y:.4g} ${label(unit)}<extra></extra>` });
    const isCoarse = interval !== null && interval > period / 4;
    await draw(this.chart, [dots(measured, "measured"), dots(model, "model"), line(measured, "measured"), line(model, "model")], layout({
      height: 320, xaxis: axis({ title: { text: "time within the period [ms]" }, range: [0, period] }), yaxis: axis({ title: { text: label(`${this.signal} [${unit}]`) } }),
    }));
    this.note.textContent = `${count(samples)} samples in the visible range, period ${number(period, 4)} ms; lines are means.`
      + (isCoarse ? ` Samples every ${duration(interval / 1e3)} cannot resolve a PWM period; enter a longer period, or use a scope log.` : "");
  }
}
