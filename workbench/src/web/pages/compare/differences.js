// This log minus each overlaid log, below the signals of both.

import * as api from "../../api.js";
import { element, fill } from "../../dom.js";
import { count, number, signed } from "../../format.js";
import * as view from "../../view.js";

const HEIGHT = 84;
/** Interpolation of the other log between its samples. */
const BETWEEN = [
  ["", "linear; duty cycles: sample and hold"], ["linear", "linear"], ["hold", "sample and hold"], ["none", "not shown"],
];

export class Differences {
  constructor(log, onChange) {
    Object.assign(this, { log, overlays: [] });
    const chosen = view.text("between") ?? "";
    const choice = element("select", { id: "between", on: { change: () => { view.set({ between: choice.value }); onChange(); } } },
      BETWEEN.map(([value, text]) => element("option", { value, selected: value === chosen }, text)));
    this.element = element("p", { class: "row", hidden: true }, element("label", {}, "Differences of the logs; interpolation of the other log: ", choice));
    this.metrics = element("section", { class: "card scroll", hidden: true, "aria-label": "Differences of the logs" });
  }

  /** Fetches the plots for an overlaid log, in the range of `query`. */
  async fetch(other, query, signal) {
    const between = view.text("between");
    if (between === "none") return [];
    query.set("other", other.number);
    if (between) query.set("between", between);
    return (await api.get(`/logs/${this.log.number}/difference?${query}`, signal)).signals;
  }

  /** Returns the plots of a signal. */
  panels(plots, name) {
    const drawn = (differences) => differences.filter((one) => one.name === name && one.metrics);
    return plots.overlays.flatMap(({ log, differences }, index) => drawn(differences).map(({ trace, unit, between }) => ({
      height: HEIGHT, title: `${name}: this − ${log.name} [${unit}]`, ink: "label",
      draw: (yaxis) => ({ traces: [plots.line(trace, yaxis, `overlay-${index % 2}`, { shape: between === "hold" ? "hv" : "linear" })], range: plots.rangeOf([trace], [0]) }),
    })));
  }

  /** Shows the differences as numbers. */
  show(overlays) {
    this.element.hidden = overlays.length === 0;
    const rows = overlays.flatMap(({ log, differences }) => differences.map(({ name, unit, metrics, between }) => element("tr", {}, element("th", { scope: "row" }, `${name} − ${log.name}`),
      (metrics ? [count(metrics.samples), number(metrics.rms), number(metrics.mean_absolute), signed(metrics.bias), number(metrics.standard_deviation), signed(metrics.lowest), signed(metrics.highest), unit] : ["no overlap", ...Array(6).fill("–"), unit]).map((cell) => element("td", {}, cell)),
      element("td", {}, between === "hold" ? "held" : "linear"))));
    this.metrics.hidden = rows.length === 0;
    fill(this.metrics, rows.length > 0 && element("table", { class: "numbers dense", id: "differences" },
      element("caption", {}, "Differences of the logs within the visible range"),
      element("thead", {}, element("tr", {}, ["signal", "samples", "rms", "mean |d|", "bias", "std", "lowest", "highest", "unit", "between samples"].map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {}, rows)));
  }
}
