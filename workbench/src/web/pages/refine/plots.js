// Measured and modelled signals over time; the modelled signals change with the sliders.

import * as api from "../../api.js";
import { axis, clear, draw, label, layout } from "../../chart.js";
import { button, element, showProblems } from "../../dom.js";
import { number, titled } from "../../format.js";
import { colour } from "../../theme.js";
import * as view from "../../view.js";

const HEIGHT = { signal: 150, gap: 32 };
const MARGIN = { l: 64, r: 14, t: 30, b: 44 };

export class Plots {
  /** `onView` is called when the visible range changes. */
  constructor(log, onView) {
    Object.assign(this, { log, onView, measurement: null, model: [], seen: "", fades: false });
    this.chart = element("div", { class: "chart", id: "refine-plots", role: "img", "aria-label": "Measured and modelled traces" });
    this.element = element("section", { class: "card", "aria-label": "Traces" },
      element("div", { class: "row" }, element("h2", {}, "Measured and modelled"),
        element("span", { class: "row legend" }, element("span", { class: "key measured" }, "measured"), element("span", { class: "key model" }, "modelled")),
        element("span", { class: "space" }), button("Whole log", () => this.look(null, null))),
      this.over = element("div", { class: "over" }, this.chart), element("p", { class: "quiet hint" }, "Drag to zoom, double-click for the whole log."));
    this.chart.addEventListener("dblclick", () => this.look(null, null));
  }

  /** Returns the request of the view's simulation. */
  query() {
    const query = { points: Math.max(400, Math.min(2400, Math.round(0.8 * (this.chart.clientWidth || 900)))) };
    for (const end of ["from", "to"]) if (view.numberOf(end) !== null) query[`${end}_s`] = view.numberOf(end);
    return query;
  }

  look(from, to) {
    view.set({ from, to });
    this.onView();
  }

  /** Shows the modelled signals; measured signals are fetched once for each view. */
  async take(signals) {
    this.model = signals;
    const query = new URLSearchParams(this.query()).toString();
    if (query !== this.seen) {
      this.measurement = await api.get(`/logs/${this.log.number}/traces?${query}`);
      this.seen = query;
    }
    await this.redraw();
  }

  /** Lets the present curves fade over those of the next step. */
  fadeToNext() {
    this.fades = !matchMedia("(prefers-reduced-motion: reduce)").matches;
  }

  /** Returns a copy of the present curves that fades and goes; null if they are not to fade. */
  past() {
    const curves = this.fades ? this.chart.querySelector(".svg-container")?.cloneNode(true) : null;
    this.fades = false;
    if (!curves) return null;
    curves.classList.add("past");
    curves.setAttribute("aria-hidden", "true");
    curves.addEventListener("animationend", () => curves.remove());
    return curves;
  }

  leave() {
    clear(this.chart);
  }

  async redraw() {
    if (!this.measurement) return;
    const panels = this.model;
    const plotted = panels.length * HEIGHT.signal + HEIGHT.gap * Math.max(0, panels.length - 1);
    const [begin, end] = this.measurement.whole_s;
    const plotLayout = layout({
      height: plotted + MARGIN.t + MARGIN.b, margin: MARGIN, hovermode: false, annotations: [],
      xaxis: axis({ range: [view.numberOf("from") ?? begin, view.numberOf("to") ?? end], title: { text: "time in the log [s]", standoff: 6 }, anchor: "free", position: 0 }),
    });
    const traces = panels.flatMap((panel, index) => {
      const name = index === 0 ? "y" : `y${index + 1}`;
      const top = 1 - index * (HEIGHT.signal + HEIGHT.gap) / plotted;
      const domain = [Math.max(0, top - HEIGHT.signal / plotted), top];
      const measured = this.measurement.signals.find((signal) => signal.name === panel.name)?.measured;
      plotLayout[`yaxis${index === 0 ? "" : index + 1}`] = axis({ domain, fixedrange: true, nticks: 6, anchor: "x", range: rangeOf(measured, panel.model) });
      const { rms, noise_floor: floor, unit } = panel.error;
      const times = rms !== null && floor ? ` = ${number(rms / floor, 3)} × noise` : "";
      plotLayout.annotations.push({ xref: "paper", yref: "paper", x: 0, y: domain[1], xanchor: "left", yanchor: "bottom", showarrow: false, font: { size: 12 }, text: label(`${titled(panel.name)} [${panel.unit}]: rms of the error ${number(rms, 3)} ${unit}${times}`) });
      const line = (trace, role, width) => ({ x: trace.t, y: trace.y, xaxis: "x", yaxis: name, mode: "lines", type: "scatter", hoverinfo: "skip", line: { color: colour(role), width } });
      return [...(measured ? [line(measured, "measured", 2)] : []), line(panel.model, "model", 1.2)];
    });
    const past = this.past();
    await draw(this.chart, traces, plotLayout).catch((error) => showProblems(error, "Plot"));
    if (past) this.over.append(past);
    this.watchLibrary();
  }

  /** Handles zooming and moving with the library's own tools. */
  watchLibrary() {
    if (this.isWatched) return;
    this.isWatched = true;
    this.chart.on("plotly_relayout", (change) => {
      const [from, to] = [change["xaxis.range[0]"], change["xaxis.range[1]"]];
      if (Number.isFinite(from) && Number.isFinite(to)) this.look(from, to);
    });
  }
}

/** Returns a range around both traces, with a margin. */
function rangeOf(...traces) {
  let low = Infinity, high = -Infinity;
  for (const trace of traces) for (const value of trace?.y ?? []) if (value !== null) { low = Math.min(low, value); high = Math.max(high, value); }
  const air = 0.06 * (high - low) || 1;
  return low > high ? [0, 1] : [low - air, high + air];
}
