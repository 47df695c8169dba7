// Traces of the runs on one time axis: pressure with reference, duty cycles, coil currents, armature positions.

import * as api from "../../api.js";
import { label, saveImage } from "../../chart.js";
import { button, element, fill, save, scrolling, showProblems } from "../../dom.js";
import { fileName, number } from "../../format.js";
import { colour } from "../../theme.js";
import { TimeView } from "../../time-view.js";
import * as view from "../../view.js";

/** Plots from top to bottom: signal, height (px) and title. */
const PANELS = [
  ["p_ch", 230, "chamber pressure"], ["duty_fill", 64, "duty cycle of the fill valve"], ["duty_vent", 64, "duty cycle of the vent valve"],
  ["i_fill", 64, "current of the fill coil"], ["i_vent", 64, "current of the vent coil"],
  ["x_fill", 64, "armature position of the fill valve"], ["x_vent", 64, "armature position of the vent valve"],
  ["x_plunger", 64, "position of the regulating valve's plunger"], ["torque_proxy", 64, "torque proxy: position over stroke"],
];
/** Time shown before and after the beginning of a step (s). */
const AROUND = [0.2, 1.2];

const runName = (plant) => plant.role === "plant" ? plant.name : `${plant.role}: ${plant.name}`;

export const roleOf = (plant) => plant.role === "plain" ? "plain" : "refined";

export class RunPlots extends TimeView {
  constructor() {
    super("run-plots");
    this.legend = element("span", { class: "row legend" });
    this.values = scrolling("Values at the cursors");
    this.exports = element("div", { class: "popup stack" });
    this.element = element("section", { class: "card", "aria-label": "Traces" },
      this.tools("Closed loop", "Whole run", this.exports), this.legend, this.over, this.values);
  }

  /** Shows the runs of a result. */
  async take(result) {
    this.result = result;
    const key = (role, text) => element("span", { class: `key ${role}` }, text);
    fill(this.legend, key("measured", "reference"), key("noise", `±${number(result.requirement.p_tol_bar, 2)} bar`),
      result.runs.map(({ plant }) => key(`run-${roleOf(plant)}`, runName(plant))));
    const plants = result.runs.map(({ plant }) => plant.name).join(" ");
    const image = (format) => saveImage(this.chart, format, fileName(result.scenario, plants), `${result.scenario}, plant ${plants}`).catch((error) => showProblems(error, format));
    fill(this.exports, button("PNG", () => image("png")), button("SVG", () => image("svg")),
      result.runs.map(({ plant }, index) => button(`CSV of the ${plant.role === "plant" ? "run" : plant.role + " plant"}`, () => save(`${fileName(result.scenario, plant.name, plant.role)}.csv`, api.address(`/control/csv?run=${index}`)))));
    await this.refresh();
  }

  async refresh() {
    const signal = this.fetchAnew();
    const query = new URLSearchParams({ points: this.points() });
    const [from, to] = [view.numberOf("from"), view.numberOf("to")];
    if (from !== null && to !== null) {
      query.set("from_s", from);
      query.set("to_s", to);
    }
    try {
      this.traces = await api.get(`/control/traces?${query}`, signal);
    } catch (error) {
      if (error.name === "AbortError") return;
      throw error;
    }
    await this.paint();
  }

  /** Shows a step from shortly before to shortly after it. */
  goToStep(time) {
    this.goTo(time - AROUND[0], time + AROUND[1]);
  }

  signal(name) {
    return this.traces.signals.find((one) => one.name === name);
  }

  async paint() {
    const shown = PANELS.filter(([name]) => this.signal(name));
    await this.drawStack(shown.map(([name, height, words]) => ({ height, title: `${words} [${this.signal(name).unit}]`, draw: (yaxis) => this.drawSignal(name, yaxis) })), { title: "time [s]" });
  }

  drawSignal(name, yaxis) {
    const { runs } = this.signal(name);
    const isDuty = name.startsWith("duty_");
    const isPressure = name === "p_ch";
    // The plain run is dashed, so that both runs are visible where they coincide.
    const dash = (role) => role === "plain" && runs.length > 1 ? "dash" : "solid";
    const lines = this.result.runs.map(({ plant }, run) => this.line(runs[run], yaxis, `run-${roleOf(plant)}`, { shape: isDuty ? "hv" : "linear", dash: dash(roleOf(plant)) })).map((line, run) => ({ ...line, name: label(runName(this.result.runs[run].plant)) }));
    return {
      traces: [...isPressure ? this.reference(yaxis) : [], ...lines],
      range: isDuty ? [-6, 106] : this.rangeOf([...runs, ...isPressure ? this.signal("p_ref").runs : []]), ticks: isPressure ? 8 : 3,
    };
  }

  /** Returns the reference with its tolerance, below all other traces. */
  reference(yaxis) {
    const trace = this.signal("p_ref").runs[0];
    const tolerance = this.result.requirement.p_tol_bar;
    const moved = (by) => ({ t: trace.t, y: trace.y.map((value) => value === null ? null : value + by) });
    const edge = (by, more) => ({ ...this.line(moved(by), yaxis, "band", { shape: "hv", width: 0 }), ...more });
    return [edge(-tolerance, { name: undefined }), edge(tolerance, { fill: "tonexty", fillcolor: colour("band"), name: `±${number(tolerance, 2)} bar` }), { ...this.line(trace, yaxis, "measured", { shape: "hv", width: 1.2 }), name: "reference" }];
  }

  /** Shows the values under the pointer, of every signal and run. */
  hover(time) {
    if (time === null || !this.traces) { fill(this.values); return; }
    const at = (trace) => {
      let index = trace.t.findIndex((one) => one !== null && one > time) - 1;
      if (index === -2) index = trace.t.length - 1;
      return index < 0 ? null : trace.y[index];
    };
    const row = ({ plant }, run) => element("tr", {}, element("th", { scope: "row" }, plant.role), this.traces.signals.map((signal) => element("td", {}, number(at(signal.runs[run]), 4))));
    fill(this.values, element("table", { class: "numbers" },
      element("thead", {}, element("tr", {}, element("th", {}, `at ${number(time, 5)} s`), this.traces.signals.map((signal) => element("th", {}, signal.name, element("span", { class: "unit" }, signal.unit))))),
      element("tbody", {}, this.result.runs.map(row))));
  }
}
