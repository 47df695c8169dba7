// The courses of the runs: pressure against reference, duty cycles, coil currents, armature positions, on one time axis.

import * as api from "../../api.js";
import { axis, clear, draw, label, layout, plotly, saveImage } from "../../chart.js";
import { button, element, fill, save, tellProblems } from "../../dom.js";
import { number } from "../../format.js";
import { colour } from "../../theme.js";
import * as view from "../../view.js";

/** From top to bottom: signal, height (px) and title. */
const PANELS = [
  ["p_ch", 230, "chamber pressure"], ["duty_fill", 64, "duty cycle of the fill valve"], ["duty_vent", 64, "duty cycle of the vent valve"],
  ["i_fill", 64, "current of the fill coil"], ["i_vent", 64, "current of the vent coil"],
  ["x_fill", 64, "armature position of the fill valve"], ["x_vent", 64, "armature position of the vent valve"],
];
const GAP = 28;
const MARGIN = { l: 64, r: 14, t: 26, b: 44 };
/** Until a person rests for so long (ms), only the axes follow. */
const REST = 120;
/** Shown before and after the beginning of a step (s). */
const AROUND = [0.2, 1.2];

export const roleOf = (plant) => plant.role === "plain" ? "plain" : "refined";

export class RunPlots {
  constructor() {
    this.chart = element("div", { class: "chart", id: "run-plots", tabIndex: 0, role: "application", "aria-label": "Courses over time. Plus and minus zoom, arrows move, Home shows all." });
    this.pointer = element("div", { class: "pointer", hidden: true });
    this.legend = element("span", { class: "row legend" });
    this.values = element("div", { class: "scroll" });
    this.exports = element("div", { class: "popup stack" });
    this.element = element("section", { class: "card", "aria-label": "Courses" },
      element("div", { class: "row tools" }, element("h2", {}, "The loop"), element("span", { class: "space" }),
        button("−", () => this.zoom(2), { title: "Zoom out (−)", "aria-label": "Zoom out" }),
        button("+", () => this.zoom(0.5), { title: "Zoom in (+)", "aria-label": "Zoom in" }),
        button("◀", () => this.move(-0.25), { title: "Earlier (←)", "aria-label": "Earlier" }),
        button("▶", () => this.move(0.25), { title: "Later (→)", "aria-label": "Later" }),
        button("Whole run", () => this.look(null, null), { title: "Home" }),
        element("details", { class: "menu" }, element("summary", {}, "Export"), this.exports)),
      this.legend,
      element("div", { class: "over" }, this.chart, this.pointer), this.values);
    this.listen();
  }

  /** Shows the runs of a result. */
  async take(result) {
    this.result = result;
    const key = (role, text) => element("span", { class: `key ${role}` }, text);
    fill(this.legend, key("measured", "reference"), key("noise", `±${number(result.requirement.p_tol_bar, 2)} bar`),
      result.runs.map(({ plant }) => key(`run-${roleOf(plant)}`, plant.role === "plant" ? plant.name : `${plant.role}: ${plant.name}`)));
    const image = (format) => saveImage(this.chart, format, "control").catch((error) => tellProblems(error, format));
    fill(this.exports, button("PNG", () => image("png")), button("SVG", () => image("svg")),
      result.runs.map(({ plant }, index) => button(`CSV of the ${plant.role === "plant" ? "run" : plant.role + " plant"}`, () => save("control.csv", api.address(`/control/csv?run=${index}`)))));
    await this.refresh();
  }

  leave() {
    this.ending.abort();
    this.fetching?.abort();
    clearTimeout(this.waiting);
    clear(this.chart);
  }

  redraw() {
    if (this.courses) this.paint();
  }

  range() {
    const [begin, end] = this.courses?.whole_s ?? [0, 1];
    return { from: view.numberOf("from") ?? begin, to: view.numberOf("to") ?? end };
  }

  async refresh() {
    this.fetching?.abort();
    const fetching = this.fetching = new AbortController();
    const query = new URLSearchParams({ points: Math.max(400, Math.min(2400, Math.round(this.chart.clientWidth || 900))) });
    const [from, to] = [view.numberOf("from"), view.numberOf("to")];
    if (from !== null && to !== null) {
      query.set("from_s", from);
      query.set("to_s", to);
    }
    try {
      this.courses = await api.get(`/control/courses?${query}`, fetching.signal);
    } catch (error) {
      if (error.name === "AbortError") return;
      throw error;
    }
    await this.paint();
  }

  /** Goes to a range; none is the whole run. */
  look(from, to) {
    if (!this.courses) return;
    if (from !== null) {
      const [begin, end] = this.courses.whole_s;
      if (to - from < 0.02) to = from + 0.02;
      if (to - from > 2 * (end - begin)) [from, to] = [null, null];
    }
    view.set({ from, to });
    this.showRange();
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.refresh().catch((error) => tellProblems(error, "View")), REST);
  }

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

  /** Shows a step from shortly before to shortly after it. */
  goTo(time) {
    this.look(time - AROUND[0], time + AROUND[1]);
    this.element.scrollIntoView({ behavior: "smooth", block: "start" });
  }

  signal(name) {
    return this.courses.signals.find((one) => one.name === name);
  }

  async paint() {
    const plotted = PANELS.reduce((sum, [, height]) => sum + height, 0) + GAP * (PANELS.length - 1);
    const { from, to } = this.range();
    const wished = layout({
      height: plotted + MARGIN.t + MARGIN.b, margin: MARGIN, hovermode: false, annotations: [], shapes: [],
      xaxis: axis({ range: [from, to], title: { text: "time [s]", standoff: 6 }, anchor: "free", position: 0, domain: [0, 1] }),
    });
    const traces = [];
    let above = 0;
    PANELS.forEach(([name, height, words], index) => {
      const yaxis = index === 0 ? "y" : `y${index + 1}`;
      const domain = [1 - (above + height) / plotted, 1 - above / plotted].map((share) => Math.max(0, Math.min(1, share)));
      above += height + GAP;
      const signal = this.signal(name);
      const line = (course, role, more) => ({ x: course.t, y: course.y, xaxis: "x", yaxis, mode: "lines", type: "scatter", hoverinfo: "skip", line: { color: colour(role), width: 1.4, ...more } });
      const shape = name.startsWith("duty_") ? "hv" : "linear";
      if (name === "p_ch") traces.push(...this.reference(line));
      this.result.runs.forEach(({ plant }, run) => traces.push(line(signal.runs[run], `run-${roleOf(plant)}`, { shape, dash: roleOf(plant) === "plain" && run === 0 && this.result.runs.length > 1 ? "dash" : "solid" })));
      const shown = [...signal.runs, ...(name === "p_ch" ? [this.signal("p_ref").runs[0]] : [])];
      wished[`yaxis${index === 0 ? "" : index + 1}`] = axis({ domain, range: name.startsWith("duty_") ? [-6, 106] : padded(shown, from, to), fixedrange: true, nticks: index === 0 ? 8 : 3, anchor: "x" });
      wished.annotations.push({ xref: "paper", yref: "paper", x: 0, y: domain[1], xanchor: "left", yanchor: "bottom", showarrow: false, text: label(`${words} [${signal.unit}]`), font: { size: 12, color: colour("ink") } });
    });
    await draw(this.chart, traces, wished);
    this.watchLibrary();
  }

  /** The reference with its tolerance, below everything. */
  reference(line) {
    const course = this.signal("p_ref").runs[0];
    const tolerance = this.result.requirement.p_tol_bar;
    const moved = (by) => ({ t: course.t, y: course.y.map((value) => value === null ? null : value + by) });
    const edge = (by, more) => ({ ...line(moved(by), "band", { shape: "hv", width: 0 }), ...more });
    return [edge(-tolerance, {}), edge(tolerance, { fill: "tonexty", fillcolor: colour("band") }), line(course, "measured", { shape: "hv", width: 1.2 })];
  }

  watchLibrary() {
    if (this.isWatched) return;
    this.isWatched = true;
    this.chart.on("plotly_relayout", (change) => {
      const range = change["xaxis.range"] ?? [change["xaxis.range[0]"], change["xaxis.range[1]"]];
      const { from, to } = this.range();
      if (Number.isFinite(range[0]) && (range[0] !== from || range[1] !== to)) this.look(range[0], range[1]);
    });
  }

  /** The values at a time, of every signal and run. */
  showValues(time) {
    if (time === null || !this.courses) { fill(this.values); return; }
    const at = (course) => {
      let index = course.t.findIndex((one) => one !== null && one > time) - 1;
      if (index === -2) index = course.t.length - 1;
      return index < 0 ? null : course.y[index];
    };
    const row = ({ plant }, run) => element("tr", {}, element("th", { scope: "row" }, plant.role), this.courses.signals.map((signal) => element("td", {}, number(at(signal.runs[run]), 4))));
    fill(this.values, element("table", { class: "numbers" },
      element("thead", {}, element("tr", {}, element("th", {}, `at ${number(time, 5)} s`), this.courses.signals.map((signal) => element("th", {}, signal.name, element("span", { class: "unit" }, signal.unit))))),
      element("tbody", {}, this.result.runs.map(row))));
  }

  timeAt(event) {
    const box = this.chart.getBoundingClientRect();
    const share = (event.clientX - box.left - MARGIN.l) / (box.width - MARGIN.l - MARGIN.r);
    const { from, to } = this.range();
    return share >= 0 && share <= 1 ? { time: from + share * (to - from), share } : null;
  }

  listen() {
    const { chart } = this;
    this.ending = new AbortController();
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
      this.showValues(at?.time ?? null);
    });
    chart.addEventListener("pointerleave", () => { this.pointer.hidden = true; });
    chart.addEventListener("keydown", (event) => {
      const acts = {
        "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2), ArrowLeft: () => this.move(-0.1), ArrowRight: () => this.move(0.1), Home: () => this.look(null, null),
      };
      const act = Object.hasOwn(acts, event.key) && acts[event.key];
      if (!act || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      act();
    });
  }
}

/** A range around what is visible, with some air. */
function padded(courses, from, to) {
  let low = Infinity, high = -Infinity;
  for (const { t, y } of courses) {
    y.forEach((value, index) => {
      if (value === null || t[index] === null || t[index] < from || t[index] > to) return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    });
  }
  if (low > high) return [0, 1];
  const air = 0.06 * (high - low) || 0.05 * Math.abs(high) || 1;
  return [low - air, high + air];
}
