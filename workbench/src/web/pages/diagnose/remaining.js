// Unexplained residual after the named effects: missing flow, oscillations, jumps.

import { axis, clear, draw, label, layout } from "../../chart.js";
import { element } from "../../dom.js";
import { number, percent } from "../../format.js";
import { colour } from "../../theme.js";

const HEIGHT = 210;
const MARGIN = { l: 62, r: 12, t: 26, b: 42 };

export class Remaining {
  constructor(remaining) {
    this.plots = [...flowPlots(remaining.missing_flow), ...linePlots(remaining.spectral_lines), ...pulsePlots(remaining.lost_pulses)];
    for (const plot of this.plots) plot.place = element("div", { class: "chart small", role: "img", "aria-label": plot.title });
    this.element = element("section", { class: "card", id: "remaining" }, element("h2", {}, "Unexplained residual"),
      remaining.sentences.length === 0
        ? element("p", {}, "No significant residual is unexplained.")
        : element("ul", {}, remaining.sentences.map((sentence) => element("li", {}, sentence))),
      this.plots.length > 0 && element("div", { class: "small-plots" }, this.plots.map((plot) => element("div", {}, plot.place, element("p", { class: "quiet" }, plot.note)))));
  }

  redraw() {
    for (const plot of this.plots) {
      const [x, y] = plot.axes;
      draw(plot.place, plot.traces(), layout({
        height: HEIGHT, margin: MARGIN, title: { text: label(plot.title), font: { size: 12.5 }, x: 0, xanchor: "left", y: 0.98, yanchor: "top" },
        xaxis: axis({ title: { text: label(x), standoff: 4 }, nticks: 6, ...plot.x }), yaxis: axis({ title: { text: label(y), standoff: 4 }, nticks: 5, zeroline: true }),
      }));
    }
  }

  leave() {
    for (const plot of this.plots) clear(plot.place);
  }
}

/** Draws the missing flow over one quantity; bars are two standard errors. */
function flowPlots(curves) {
  return curves.map((curve) => ({
    title: `Missing flow, ${curve.condition}`, axes: [`${curve.against} [${curve.unit}]`, "bar/s"],
    note: `Explains ${percent(curve.explained_share)} of the missing flow. Positive: into the chamber.`,
    traces: () => [{
      x: curve.points.map((point) => point.at), y: curve.points.map((point) => point.bar_per_s),
      error_y: { type: "data", array: curve.points.map((point) => 2 * point.standard_error), color: colour("residual"), thickness: 1.2, width: 3 },
      mode: "lines+markers", type: "scatter", line: { color: colour("residual"), width: 1.4 }, marker: { color: colour("residual"), size: 5 },
      hovertemplate: "%{x:.3f}: %{y:.4f} bar/s<extra></extra>",
    }],
  }));
}

/** Returns vertical lines from the axis. */
const stems = (x, y, role) => [
  { x: x.flatMap((at) => [at, at, null]), y: y.flatMap((size) => [0, size, null]), mode: "lines", type: "scatter", hoverinfo: "skip", line: { color: colour(role), width: 2 } },
  { x, y, mode: "markers", type: "scatter", marker: { color: colour(role), size: 7 }, hovertemplate: "%{x:.3f}: %{y:.4g}<extra></extra>" },
];

function linePlots(lines) {
  const groups = Map.groupBy(lines, (line) => `${line.signal}, ${line.condition}, ${line.unit}`);
  return [...groups.values()].map((group) => {
    const [{ signal, condition, unit }] = group;
    const highest = Math.max(...group.map((line) => line.frequency_hz));
    return {
      title: `Oscillation: ${signal}, ${condition}`, axes: ["frequency [Hz]", unit], x: { range: [0, 1.25 * highest] },
      note: group.map((line) => `${number(line.frequency_hz, 3)} Hz, ${number(line.amplitude, 2)} ${line.unit} (p = ${number(line.p_value, 1)})`).join("; "),
      traces: () => stems(group.map((line) => line.frequency_hz), group.map((line) => line.amplitude), "model"),
    };
  });
}

function pulsePlots(pulses) {
  return [...Map.groupBy(pulses, (pulse) => pulse.log)].map(([log, group]) => ({
    title: `Jumps that the model lacks, ${log}`, axes: ["time in the log [s]", "bar"], x: { rangemode: "tozero" },
    note: group.map((pulse) => `${number(pulse.jump_bar, 2)} bar at ${number(pulse.time_s, 4)} s`).join("; "),
    traces: () => stems(group.map((pulse) => pulse.time_s), group.map((pulse) => pulse.jump_bar), "limit"),
  }));
}
