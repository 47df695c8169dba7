// Traces: one plot for each signal, with the residual and its noise below, all on one time axis.

import * as api from "../../api.js";
import { axis, clear, draw, label, layout, plotly, saveImage } from "../../chart.js";
import { button, element, fill, save, scrolling, showProblems } from "../../dom.js";
import { Filter } from "../../filter.js";
import { count, fileName, number, percent, ratesOf, signed, titled } from "../../format.js";
import { menu } from "../../menu.js";
import { colour } from "../../theme.js";
import { NAMES, TimeView } from "../../time-view.js";
import * as view from "../../view.js";
import { Differences } from "./differences.js";
import { Dividers, fitted } from "./rows.js";

/** Heights (px) with enough space: a signal, its residual, an input. */
const HEIGHT = { signal: 150, residual: 84, input: 78 };
/** Margins (px) around the plots, and the gap between two, so that many fit the window. */
const FRAME = { margin: { l: 64, r: 14, t: 18, b: 40 }, gap: 18 };
const TIME_AXIS = "time in the log [s]";
/** Idle time (ms) after an input before the detail charts are updated. */
const REST = 400;
/** Share of the view that is also fetched on either side, so that panning shows no empty edge. */
const BESIDE = 0.5;

/** States with a background colour. */
const STATES = ["filling", "venting", "both"];

const showsStates = () => view.text("states") !== null;

const isDuty = (signal) => signal.name.startsWith("duty_");

/** Creates time intervals as one shape through all plots. */
function bands(pieces, role) {
  const path = pieces.map(([begin, end]) => `M${begin},0L${begin},1L${end},1L${end},0Z`).join("");
  return path === "" ? [] : [{ type: "path", xref: "x", yref: "paper", path, fillcolor: colour(role), line: { width: 0 }, layer: "below" }];
}

/** Returns the share of the visible samples outside the tolerance, as a chip. */
function verdictOf(band) {
  if (!band) return "–";
  const word = band.holds === null ? "open" : band.holds ? "good" : "bad";
  return element("span", { class: `chip ${word}`, title: `allowed: ${percent(band.beyond_max)} of the visible samples` }, band.beyond > 0 && band.beyond < 0.0005 ? "< 0.1 %" : percent(band.beyond));
}

export class TimePlots extends TimeView {
  constructor(log, logs, plant, cursors, limits, { onView, onShift, onCursor }) {
    super("time-plots", ", a and b set a cursor in the centre", FRAME);
    Object.assign(this, { log, logs, plant, cursors, onView, onShift, onCursor, overlays: [], hidden: new Set(view.texts("hide")) });
    this.choices = element("div", { class: "row choices" });
    this.filter = new Filter("signals");
    this.differences = new Differences(log, () => this.refresh());
    this.filter.element.append(button("Show only these", () => this.chooseFound((name) => !this.isFound(name)), { id: "show-found" }), button("Hide these", () => this.chooseFound((name) => this.isFound(name) || this.hidden.has(name)), { id: "hide-found" }));
    this.legend = element("span", { class: "row legend", id: "legend" });
    this.metrics = scrolling("Numbers of the visible range");
    this.hint = element("p", { class: "quiet hint" }, "Drag or Ctrl and wheel to zoom, drag with Shift to pan, double-click for the whole log. A click sets cursor A, with Alt cursor B.",
      logs.length > 1 && " Drag with Ctrl to shift the overlaid log.");
    this.dividers = new Dividers(() => this.paint());
    this.over.append(this.dividers.element);
    // Stays at the lower edge where the rows need more than the window.
    this.timeAxis = element("div", { class: "time-axis", "aria-hidden": "true", hidden: true });
    this.scroller = element("div", { class: "scroller" }, this.over, this.timeAxis);
    const signals = element("div", { class: "popup stack" }, this.filter.element, this.choices, this.differences.element);
    this.element = element("section", { class: "card plots", "aria-label": "Traces" },
      this.tools("Measured and modelled", "Whole log", this.exports(), [menu("Signals", signals, { id: "signals" }), limits]),
      this.legend, this.scroller);
    this.sizes = new ResizeObserver(() => this.redraw());
    this.sizes.observe(this.scroller);
    this.listenToClicks();
    this.listenToShifts();
  }

  /** Lists what is drawn. */
  showLegend() {
    const shown = this.shown();
    const residuals = shown.map((signal) => signal.residual).filter(Boolean);
    const isDrawn = {
      measured: shown.some((signal) => !isDuty(signal)), model: shown.some((signal) => signal.model), residual: residuals.length > 0,
      noise: residuals.some((residual) => residual.noise), limit: residuals.some((residual) => residual.limit), tolerance: residuals.some((residual) => residual.band),
      fill: shown.some((signal) => signal.name === "duty_fill"), vent: shown.some((signal) => signal.name === "duty_vent"),
    };
    const roles = Object.keys(isDrawn).filter((role) => isDrawn[role]).map((role) => [role, NAMES[role]]);
    const overlays = this.overlays.map(({ log }, index) => [`overlay-${index % 2}`, log.name]);
    fill(this.legend, [...roles, ...overlays].map(([role, text]) => element("span", { class: `key ${role}` }, text)));
  }

  shown() {
    return this.traces.signals.filter((signal) => !this.hidden.has(signal.name));
  }

  exports() {
    const name = () => fileName(this.log.name, this.plant.name, this.shown().map((signal) => signal.name));
    const title = () => `${this.log.name}, plant ${this.plant.name}: ${this.shown().map((signal) => signal.name).join(", ")}`;
    const image = (format) => saveImage(this.chart, format, name(), title()).catch((error) => showProblems(error, format));
    const data = (format) => save(`${fileName(this.log.name, this.plant.name, "samples")}.${format}`, api.address(`/logs/${this.log.number}/${format}?${this.rangeQuery()}`));
    return element("div", { class: "popup stack" },
      button("PNG", () => image("png"), { id: "export-png" }), button("SVG", () => image("svg"), { id: "export-svg" }),
      button("CSV of the visible range", () => data("csv"), { id: "export-csv" }), button("MF4 of the visible range", () => data("mf4"), { id: "export-mf4" }));
  }

  rangeQuery() {
    const { from, to } = this.range();
    return new URLSearchParams({ from_s: from, to_s: to }).toString();
  }

  leave() {
    super.leave();
    this.sizes.disconnect();
    clear(this.timeAxis);
    clearTimeout(this.resting);
  }

  /** Fetches the visible range, and draws it. */
  async refresh() {
    const signal = this.fetchAnew();
    const points = this.points(0.8);
    const piece = (from, to, more) => {
      const query = new URLSearchParams({ points: Math.round(points * (1 + 2 * BESIDE)), beside: BESIDE, ...more });
      if (from !== null) query.set("from_s", from);
      if (to !== null) query.set("to_s", to);
      return query;
    };
    const fetch = (log, query) => api.get(`/logs/${log}/traces?${query}`, signal);
    const [from, to] = [view.numberOf("from"), view.numberOf("to")];
    const select = view.text("select");
    try {
      this.traces = await fetch(this.log.number, piece(from, to, { ...select ? { select } : {}, states: showsStates() }));
      const beyond = this.logs.filter((log) => this.overlaid().includes(log.number));
      this.overlays = await Promise.all(beyond.map(async (log) => {
        const shift = log.offset_s - this.log.offset_s;
        const [traces, differences] = await Promise.all([fetch(log.number, piece(from === null ? null : from - shift, to === null ? null : to - shift)), this.differences.fetch(log, piece(from, to), signal)]);
        return { log, shift, traces, differences };
      }));
    } catch (error) {
      if (error.name === "AbortError") return;
      throw error;
    }
    await this.paint();
    this.showChoices();
    this.showMetrics();
    this.differences.show(this.overlays);
    this.cursors.refresh(this.traces);
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.onView(), REST);
  }

  overlaid() {
    return (view.text("with") ?? "").split(",").filter(Boolean).map(Number);
  }

  /** Shows a time, with cursor A at it. */
  goToMoment(time) {
    const [begin, end] = this.traces.whole_s;
    const half = (end - begin) / 40;
    this.cursors.set("a", time);
    this.goTo(time - half, time + half);
  }

  showChoices() {
    const others = this.logs.filter((log) => log !== this.log);
    const overlay = (log) => () => {
      const now = this.overlaid();
      view.set({ with: (now.includes(log.number) ? now.filter((one) => one !== log.number) : [...now, log.number]).join(",") });
      this.refresh();
    };
    const check = (text, checked, act, data, role = "") => element("label", { class: "choice" }, element("input", { type: "checkbox", checked, data, on: { change: act } }), element("span", { class: role && `key ${role}` }, ` ${text}`));
    const hue = (log) => { const place = this.overlays.findIndex((one) => one.log === log); return place < 0 ? "" : `overlay-${place % 2}`; };
    const signals = this.traces.signals.map(({ name, quantity, unit }) => ({
      name, text: `${titled(name)} ${quantity} ${unit}`, line: check(name, !this.hidden.has(name), () => this.choose((one) => this.hidden.has(one) !== (one === name)), { signal: name }),
    }));
    this.filter.take(signals);
    const states = check("valve states", showsStates(), () => { view.set({ states: showsStates() ? null : "shown" }); this.refresh(); }, { states: "" });
    fill(this.choices,
      element("span", { class: "quiet" }, "Signals"), signals.map((signal) => signal.line),
      element("span", { class: "quiet" }, "Background"), states, showsStates() && STATES.map((state) => element("span", { class: `key state-${state}` }, state)),
      others.length > 0 && element("span", { class: "quiet" }, "Overlay"), others.map((log) => check(log.name, this.overlaid().includes(log.number), overlay(log), { overlay: log.number }, hue(log))));
  }

  isFound(name) {
    return this.filter.fitting().some((one) => one.name === name);
  }

  /** Hides the signals for which `isHidden` is true. */
  choose(isHidden) {
    this.hidden = new Set(this.traces.signals.map((signal) => signal.name).filter(isHidden));
    view.set({ hide: [...this.hidden] });
    this.paint();
  }

  chooseFound(isHidden) {
    this.choose(isHidden);
    this.showChoices();
  }

  showMetrics() {
    const compared = this.traces.signals.filter((signal) => signal.residual?.metrics);
    const residuals = compared.map((signal) => signal.residual);
    const row = (name, cell) => element("tr", {}, element("th", { scope: "row" }, name), residuals.map((residual, index) => cell(residual, compared[index])));
    const figures = (name, figure) => row(name, (residual) => element("td", {}, figure(residual.metrics)));
    const judged = ({ holds }) => element("td", {}, element("span", {
      class: `chip ${holds === null ? "open" : holds ? "good" : "bad"}`, title: "rms over the whole log, compared with its limit",
    }, holds === null ? "no limit" : holds ? "within" : "above"));
    fill(this.metrics, compared.length === 0 ? element("p", { class: "quiet" }, "Not compared yet.") : element("table", { class: "numbers dense", id: "metrics" },
      element("thead", {}, element("tr", {}, ["", ...compared.map(({ name, residual }) => `${name} [${residual.unit}]`)].map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {},
        figures("samples", (metrics) => count(metrics.samples)), figures("rms", (metrics) => number(metrics.rms)),
        figures("mean |e|", (metrics) => number(metrics.mean_absolute)), figures("bias", (metrics) => signed(metrics.bias)),
        figures("std", (metrics) => number(metrics.standard_deviation)), figures("lowest", (metrics) => signed(metrics.lowest)),
        figures("highest", (metrics) => signed(metrics.highest)),
        row("limit of rms", ({ limit }) => element("td", {}, number(limit))), row("whole log", judged),
        residuals.some((residual) => residual.band) && row("outside tolerance", ({ band }, { name }) => element("td", { data: { band: name } }, verdictOf(band))))));
  }

  /** Returns the plots from top to bottom. */
  panels() {
    const rates = ratesOf(this.log.summary);
    const rated = (name, title) => rates.has(name) ? `${title}, ${rates.get(name)}` : title;
    const shown = this.shown();
    const outputs = shown.filter((one) => !one.is_input).flatMap((signal) => [
      { height: HEIGHT.signal, title: rated(signal.name, `${titled(signal.name)} [${signal.unit}]`), draw: (yaxis) => this.drawSignal(signal, yaxis) },
      ...this.differences.panels(this, signal.name),
      ...signal.residual ? [{ height: HEIGHT.residual, title: `${signal.name}: measured − modelled [${signal.residual.unit}]`, ink: "label", draw: (yaxis) => this.drawResidual(signal.residual, yaxis) }] : [],
    ]);
    const inputs = shown.filter((one) => one.is_input);
    const duties = inputs.filter(isDuty);
    const input = (signals, title) => ({ height: HEIGHT.input, title: rated(signals[0].name, `${title} [${signals[0].unit}]`), draw: (yaxis) => this.drawInput(signals, yaxis) });
    return [
      ...outputs,
      ...duties.length > 0 ? [input(duties, "duty cycles")] : [],
      ...inputs.filter((one) => !duties.includes(one)).map((one) => input([one], titled(one.name))),
      ...inputs.flatMap((one) => this.differences.panels(this, one.name)),
    ];
  }

  async paint() {
    const marks = { shapes: this.cursors.shapes(), annotations: this.cursors.labels() };
    const panels = this.panels();
    const heights = await this.drawStack(panels, { title: TIME_AXIS, shapes: [...this.states(), ...this.selection(), ...marks.shapes], annotations: marks.annotations });
    this.dividers.take(panels, heights, FRAME.margin.t, FRAME.gap);
    await this.drawTimeAxis();
    const { shapes, annotations } = this.chart.layout;
    this.showLegend();
    this.unmarked = { shapes: shapes.length - marks.shapes.length, annotations: annotations.length - marks.annotations.length };
  }

  /** Shares the height of the window among the rows. */
  heights(panels) {
    const { margin, gap } = FRAME;
    return fitted(panels, this.scroller.clientHeight - margin.t - margin.b - gap * Math.max(0, panels.length - 1));
  }

  async drawTimeAxis() {
    const { l, r, b } = FRAME.margin;
    this.timeAxis.hidden = this.chart.layout.height <= this.scroller.clientHeight;
    if (this.timeAxis.hidden) return;
    const { from, to } = this.range();
    await draw(this.timeAxis, [], layout({
      height: b + 1, margin: { l, r, t: 0, b }, hovermode: false, xaxis: axis({ range: [from, to], title: { text: TIME_AXIS, standoff: 6 }, fixedrange: true }),
      yaxis: axis({ visible: false, fixedrange: true }),
    }));
  }

  async showRange() {
    await super.showRange();
    if (!this.timeAxis.hidden) await this.drawTimeAxis();
  }

  drawSignal(signal, yaxis) {
    const { name, unit, measured, model } = signal;
    const overlays = this.overlays.flatMap(({ log, traces, shift }, index) => traces.signals.filter((one) => one.name === name && one.unit === unit)
      .map((one) => [{ t: one.measured.t.map((time) => time === null ? null : time + shift), y: one.measured.y }, index % 2, label(log.name)]));
    const measuredLine = this.line(measured, yaxis, "measured", { width: 2 });
    if (measured.t.length < 120) Object.assign(measuredLine, { mode: "lines+markers", marker: { size: 4, color: colour("measured") } });
    return {
      traces: [...overlays.map(([trace, hue, title]) => ({ ...this.line(trace, yaxis, `overlay-${hue}`, { width: 1.1 }), name: title })), measuredLine, ...model ? [this.line(model, yaxis, "model", { width: 1.2 })] : []],
      range: this.rangeOf([measured, ...model ? [model] : [], ...overlays.map(([trace]) => trace)]), ticks: 6,
    };
  }

  /** Draws the residual, its noise band, its limit and its tolerance. */
  drawResidual({ trace: error, noise, limit, band }, yaxis) {
    const across = { xref: "paper", x0: 0, x1: 1, yref: yaxis };
    const shapes = limit ? [limit, -limit].map((at) => ({ ...across, type: "line", y0: at, y1: at, line: { color: colour("limit"), width: 1, dash: "dot" } })) : [];
    if (noise) shapes.unshift({ ...across, type: "rect", y0: -2 * noise, y1: 2 * noise, fillcolor: colour("band"), line: { width: 0 }, layer: "below" });
    const bounds = band ? [band.low, band.high] : [];
    const traces = [...bounds.map((bound) => this.line(bound, yaxis, "tolerance", { width: 1.2 })), this.line(error, yaxis, "residual")];
    return { traces, shapes, range: this.rangeOf([error, ...bounds], noise ? [2 * noise, -2 * noise] : []) };
  }

  drawInput(signals, yaxis) {
    const areDuties = isDuty(signals[0]);
    const role = { duty_fill: "fill", duty_vent: "vent" };
    return {
      traces: signals.map((one) => this.line(one.measured, yaxis, role[one.name] ?? "measured", { shape: areDuties ? "hv" : "linear" })),
      range: areDuties ? [-6, 106] : this.rangeOf(signals.map((one) => one.measured)),
    };
  }

  /** Returns the selected samples as bands through all plots. */
  selection() {
    const { from, to } = this.range();
    const least = (to - from) / 1500;
    const pieces = this.traces.selection?.pieces_s ?? [];
    return bands(pieces.map(([begin, end]) => [begin, Math.max(end, begin + least)]), "selection");
  }

  /** Returns the commanded states of the valves; no background: both valves shut. */
  states() {
    const of = (state) => this.traces.states.filter((one) => one.state === state).map((one) => [one.from_s, one.to_s]);
    return STATES.flatMap((state) => bands(of(state), `state-${state}`));
  }

  /** Moves the cursors without drawing the traces again. */
  async mark() {
    if (!this.chart.layout) return;
    const library = await plotly();
    const { annotations, shapes } = this.chart.layout;
    await library.relayout(this.chart, {
      annotations: [...annotations.slice(0, this.unmarked.annotations), ...this.cursors.labels()],
      shapes: [...shapes.slice(0, this.unmarked.shapes), ...this.cursors.shapes()],
    });
  }

  hover(time) {
    this.cursors.hover(time, this.traces);
  }

  acts() {
    const { from, to } = this.range();
    const middle = (from + to) / 2;
    return { a: () => this.cursors.set("a", middle), b: () => this.cursors.set("b", middle) };
  }

  /** Sets a cursor at a click. */
  listenToClicks() {
    let pressed = null;
    this.chart.addEventListener("pointerdown", (event) => { pressed = { x: event.clientX, y: event.clientY }; }, true);
    // The library covers the whole window while a button is pressed.
    addEventListener("pointerup", (event) => {
      const moved = pressed ? Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) : Infinity;
      const at = this.timeAt(event);
      if (moved < 4 && at) {
        this.cursors.set(event.altKey ? "b" : "a", at.time);
        this.onCursor();
      }
      pressed = null;
    }, { capture: true, signal: this.ending.signal });
  }

  /** Moves the log that was overlaid last, at a drag with Ctrl. */
  listenToShifts() {
    const { chart } = this;
    let dragged = null;
    chart.addEventListener("pointerdown", (event) => {
      const overlay = this.overlays.at(-1);
      if (!event.ctrlKey || !overlay || !this.timeAt(event)) return;
      // The library must not receive a click, since it would zoom.
      event.preventDefault();
      chart.setPointerCapture(event.pointerId);
      dragged = { overlay, from: event.clientX, shift: overlay.shift, offset_s: overlay.log.offset_s };
    }, true);
    chart.addEventListener("pointermove", (event) => {
      if (!dragged) return;
      const by = this.timeBetween(dragged.from, event.clientX);
      dragged.overlay.shift = dragged.shift + by;
      dragged.overlay.log.offset_s = dragged.offset_s + by;
      if (!this.isShifting) {
        this.isShifting = true;
        requestAnimationFrame(() => { this.isShifting = false; this.paint(); });
      }
    });
    chart.addEventListener("pointerup", async () => {
      if (!dragged) return;
      const { log } = dragged.overlay;
      dragged = null;
      try {
        await api.put(`/logs/${log.number}/offset`, { offset_s: log.offset_s });
        this.onShift(log);
        await this.refresh();
      } catch (refusal) {
        showProblems(refusal, log.name);
      }
    });
  }
}
