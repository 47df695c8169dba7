// Stacked plots on one time axis; tools, keys, wheel and pointer change the visible range.

import { axis, clear, draw, label, layout, plotly } from "./chart.js";
import { button, element, showProblems } from "./dom.js";
import { menu } from "./menu.js";
import { colour } from "./theme.js";
import * as view from "./view.js";

/** Margins (px) around the plots, and the gap between two. */
const FRAME = { margin: { l: 64, r: 14, t: 28, b: 44 }, gap: 29 };
/** Names of the roles in a legend. */
export const NAMES = {
  measured: "measured", model: "modelled", residual: "measured − modelled", fill: "fill valve", vent: "vent valve", tolerance: "tolerance",
  noise: "±2 σ of the noise", limit: "rms limit",
};
/** Idle time (ms) after an input before the traces are fetched again; until then only the axes follow. */
const REST = 120;

/**
 * Base class of the views over time. A subclass implements `refresh`, which fetches the traces of the visible range,
 * and `paint`, which draws them with `drawStack`.
 */
export class TimeView {
  /** Creates a view; `keys` describes the additional keys of a subclass. */
  constructor(id, keys = "", frame = FRAME) {
    this.traces = null;
    this.frame = frame;
    this.chart = element("div", { class: "chart", id, tabIndex: 0, role: "application", "aria-label": `Traces over time. Plus and minus zoom, arrows pan, Home shows all${keys}.` });
    this.pointer = element("div", { class: "pointer", hidden: true });
    this.over = element("div", { class: "over" }, this.chart, this.pointer);
    this.ending = new AbortController();
    this.listen();
  }

  /** Creates the row above the plots. */
  tools(title, whole, exports, menus = []) {
    return element("div", { class: "row tools" }, element("h2", {}, title), element("span", { class: "space" }),
      button("−", () => this.zoom(2), { title: "Zoom out (−)", "aria-label": "Zoom out" }),
      button("+", () => this.zoom(0.5), { title: "Zoom in (+)", "aria-label": "Zoom in" }),
      button("◀", () => this.move(-0.25), { title: "Earlier (←)", "aria-label": "Earlier" }),
      button("▶", () => this.move(0.25), { title: "Later (→)", "aria-label": "Later" }),
      button(whole, () => this.look(null, null), { title: "Home", id: "whole" }),
      menus, menu("Export", exports, { id: "export" }));
  }

  leave() {
    this.ending.abort();
    this.fetching?.abort();
    clearTimeout(this.waiting);
    clear(this.chart);
  }

  redraw() {
    if (this.traces) this.paint();
  }

  /** Aborts the running request; returns the signal of the new one. */
  fetchAnew() {
    this.fetching?.abort();
    this.fetching = new AbortController();
    return this.fetching.signal;
  }

  /** Returns the number of points that a screen of this width can show. */
  points(share = 1) {
    return Math.max(400, Math.min(2400, Math.round(share * (this.chart.clientWidth || 900))));
  }

  /** Returns the visible range (s). */
  range() {
    const [begin, end] = this.traces?.whole_s ?? [0, 1];
    return { from: view.numberOf("from") ?? begin, to: view.numberOf("to") ?? end };
  }

  /** Goes to a range; without one to the whole log. */
  look(from, to) {
    if (!this.traces) return;
    if (from !== null) {
      const [begin, end] = this.traces.whole_s;
      to = Math.max(to, from + 1e-6 * (end - begin));
      // A range more than twice as long as the log shows the whole log.
      if (to - from > 2 * (end - begin)) [from, to] = [null, null];
    }
    view.set({ from, to });
    this.showRange();
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.refresh().catch((error) => showProblems(error, "View")), REST);
  }

  /** Moves the axes immediately, with the points that are loaded. */
  async showRange() {
    if (!this.chart.layout) return;
    const { from, to } = this.range();
    await (await plotly()).relayout(this.chart, { "xaxis.range": [from, to] });
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

  /** Shows a time range, and scrolls to the plots. */
  goTo(from, to) {
    this.look(from, to);
    this.element.scrollIntoView({ behavior: "smooth", block: "start" });
  }

  /**
   * Draws the panels from top to bottom. Each has a `height` (px), a `title`, the colour role of its `ink`, and `draw`.
   * `draw` gets the name of its axis and returns its `traces`, the `range` of its axis, and optionally `ticks` and
   * `shapes`. Returns the drawn heights (px).
   */
  async drawStack(panels, { title, shapes = [], annotations = [] }) {
    const { margin, gap } = this.frame;
    const heights = this.heights(panels);
    const plotted = heights.reduce((sum, height) => sum + height, 0) + gap * Math.max(0, panels.length - 1);
    const { from, to } = this.range();
    const plotLayout = layout({
      height: plotted + margin.t + margin.b, margin, hovermode: false, annotations: [], shapes: [],
      xaxis: axis({ range: [from, to], title: { text: title, standoff: 6 }, anchor: "free", position: 0, domain: [0, 1] }),
    });
    const traces = [];
    let above = 0;
    panels.forEach((panel, index) => {
      const number = index === 0 ? "" : index + 1;
      const domain = [1 - (above + heights[index]) / plotted, 1 - above / plotted].map((share) => Math.max(0, Math.min(1, share)));
      above += heights[index] + gap;
      const drawn = panel.draw(`y${number}`);
      traces.push(...drawn.traces);
      plotLayout.shapes.push(...drawn.shapes ?? []);
      plotLayout[`yaxis${number}`] = axis({ domain, range: drawn.range, fixedrange: true, nticks: drawn.ticks ?? 4, anchor: "x" });
      plotLayout.annotations.push({ xref: "paper", yref: "paper", x: 0, y: domain[1], xanchor: "left", yanchor: "bottom", showarrow: false, text: label(panel.title), font: { size: 12, color: colour(panel.ink ?? "ink") } });
    });
    plotLayout.shapes.push(...shapes);
    plotLayout.annotations.push(...annotations);
    await draw(this.chart, traces, plotLayout);
    this.watchLibrary();
    return heights;
  }

  /** Returns the heights (px) of the panels. */
  heights(panels) {
    return panels.map((panel) => panel.height);
  }

  /** Returns a trace as a line; its name is that of its role. */
  line(trace, yaxis, role, more = {}) {
    return { name: NAMES[role], x: trace.t, y: trace.y, xaxis: "x", yaxis, mode: "lines", type: "scatter", hoverinfo: "skip", line: { color: colour(role), width: 1.4, ...more } };
  }

  /** Returns a range around the visible values of the traces, with a margin; it also includes `values`. */
  rangeOf(traces, values = []) {
    const { from, to } = this.range();
    let [low, high] = [Math.min(...values), Math.max(...values)];
    for (const { t, y } of traces) {
      for (let index = 0; index < y.length; index += 1) {
        const value = y[index];
        if (value === null || t[index] === null || t[index] < from || t[index] > to) continue;
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    if (low > high) return [0, 1];
    const air = 0.06 * (high - low) || 0.05 * Math.abs(high) || 1;
    return [low - air, high + air];
  }

  /** Handles zooming and moving with the library's own tools. */
  watchLibrary() {
    if (this.isWatched) return;
    this.isWatched = true;
    this.chart.on("plotly_relayout", (change) => {
      const range = change["xaxis.range"] ?? [change["xaxis.range[0]"], change["xaxis.range[1]"]];
      const { from, to } = this.range();
      if (Number.isFinite(range[0]) && (range[0] !== from || range[1] !== to)) this.look(range[0], range[1]);
    });
  }

  /** Returns the time under a pointer; null outside the plots. */
  timeAt(event) {
    const { left, width } = this.chart.getBoundingClientRect();
    const { l, r } = this.frame.margin;
    const share = (event.clientX - left - l) / (width - l - r);
    const { from, to } = this.range();
    return share >= 0 && share <= 1 ? { time: from + share * (to - from), share } : null;
  }

  /** Returns the time between two positions of the pointer (px). */
  timeBetween(from, to) {
    const visible = this.range();
    const { l, r } = this.frame.margin;
    return (to - from) * (visible.to - visible.from) / (this.chart.getBoundingClientRect().width - l - r);
  }

  /** Handles the pointer at a time, or outside the plots (null). */
  hover() {}

  /** Returns the view's own keys. */
  acts() {
    return {};
  }

  listen() {
    const { chart } = this;
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
      if (at) this.pointer.style.left = `${event.clientX - chart.getBoundingClientRect().left}px`;
      this.hover(at?.time ?? null);
    });
    chart.addEventListener("pointerleave", () => { this.pointer.hidden = true; this.hover(null); });
    chart.addEventListener("keydown", (event) => {
      const acts = {
        "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2), ArrowLeft: () => this.move(-0.1), ArrowRight: () => this.move(0.1),
        Home: () => this.look(null, null), ...this.acts(),
      };
      const act = Object.hasOwn(acts, event.key) && acts[event.key];
      if (!act || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      act();
    });
  }
}
