// Error by regime: map over duty cycle and pressure, and tables of shares. A click marks the samples in the plots
// above.

import { axis, clear, draw, label, layout } from "../../chart.js";
import { button, element, fill } from "../../dom.js";
import { count, number, percent, signed, titled } from "../../format.js";
import { colour } from "../../theme.js";
import { term } from "../../terms.js";
import * as view from "../../view.js";

/** Values that a cell can show. */
const SHOWN = {
  excess_share: { text: "share of the excess error [%]", of: (error) => error.excess_share, format: (value) => Math.abs(value) < 0.0005 ? "0" : percent(value).replace(" %", "") },
  bias: { text: "mean error", of: (error) => error.bias, format: (value) => signed(value, 2) },
  rms: { text: "rms error", of: (error) => error.rms, format: (value) => number(value, 2) },
};

export class Regimes {
  constructor(onSelect) {
    this.onSelect = onSelect;
    this.chart = element("div", { class: "chart", id: "error-map", role: "img", "aria-label": "Error map: error of the signal for each duty cycle and chamber pressure" });
    this.tables = element("div", { class: "tables" });
    this.picked = element("p", { class: "row", id: "picked", role: "status" });
    this.head = element("div", { class: "row" });
    this.element = element("section", { class: "stack tight", hidden: true, "aria-labelledby": "regimes-title" },
      element("h2", { id: "regimes-title" }, "Error by regime"), this.head, this.picked, this.chart, this.tables);
  }

  leave() { clear(this.chart); }

  redraw() { if (this.comparison) this.show(); }

  take(log, comparison) {
    Object.assign(this, { log, comparison });
    this.element.hidden = false;
    this.show();
  }

  signal() {
    const { signals } = this.comparison;
    return signals.find((one) => one.name === view.text("map"))
      ?? signals.reduce((worst, one) => overLimit(one) > overLimit(worst) ? one : worst, signals[0]);
  }

  show() {
    const signal = this.signal();
    const requested = view.text("cell");
    const shown = Object.hasOwn(SHOWN, requested ?? "") ? SHOWN[requested] : (signal.error_map.cells.some((cell) => cell.error.excess_share !== null) ? SHOWN.excess_share : SHOWN.bias);
    const choose = (name, entries, value) => element("select", { "aria-label": name, on: { change: (event) => { view.set({ [name]: event.target.value }); this.show(); } } },
      entries.map(([key, text]) => element("option", { value: key, selected: key === value }, text)));
    fill(this.head,
      element("label", {}, "Signal ", choose("map", this.comparison.signals.map((one) => [one.name, titled(one.name)]), signal.name)),
      element("label", {}, "Cells show ", choose("cell", Object.entries(SHOWN).map(([key, one]) => [key, one.text]), Object.keys(SHOWN).find((key) => SHOWN[key] === shown))),
      element("span", { class: "quiet" }, signal.error_map.horizon === "one_step_ahead" ? "One-step-ahead error. Click a cell or regime to mark its samples in the plots." : "Free-run error. Click a cell or regime to mark its samples in the plots."));
    this.showPicked();
    this.drawMap(signal, shown);
    fill(this.tables, signal.regimes.map((regime) => this.table(signal, regime)));
  }

  pick(selected) {
    view.set({ select: view.text("select") === selected ? null : selected });
    this.show();
    this.onSelect();
  }

  showPicked() {
    const select = view.text("select");
    if (!select) { fill(this.picked); return; }
    const [signal, dimension, ...words] = select.split("/");
    const title = dimension === "error_map" ? "cell" : this.comparison.signals.find((one) => one.name === signal)?.regimes.find((one) => one.dimension === dimension)?.title ?? dimension;
    fill(this.picked, element("span", { class: "chip selection" }, `Marked: ${title}: ${words.join("/")}`), button("Clear", () => this.pick(select)));
  }

  drawMap(signal, shown) {
    const { duty_bands: rows, pressure_bands: columns, cells } = signal.error_map;
    const grid = () => rows.map(() => columns.map(() => null));
    const [z, hover] = [grid(), grid()];
    const text = rows.map(() => columns.map(() => ""));
    for (const cell of cells) {
      const value = shown.of(cell.error);
      const [row, column] = [cell.duty_band, cell.pressure_band];
      z[row][column] = value;
      text[row][column] = shown.format(value);
      hover[row][column] = label(`${count(cell.samples)} samples; bias ${signed(cell.error.bias, 3)}, rms ${number(cell.error.rms, 3)} ${signal.unit}; share of the excess ${percent(cell.error.excess_share)}`);
    }
    const largest = Math.max(1e-12, ...cells.map((cell) => Math.abs(shown.of(cell.error) ?? 0)));
    const isWide = shown !== SHOWN.excess_share;
    const isSigned = shown === SHOWN.bias;
    const ground = colour("card");
    const scale = isSigned ? [[0, colour("fill")], [0.5, ground], [1, colour("model")]] : [[0, ground], [1, colour("model")]];
    const plotLayout = layout({
      height: 54 + 26 * rows.length, margin: { l: 92, r: 4, t: 6, b: 44 }, dragmode: false, hovermode: "closest",
      xaxis: axis({ title: { text: "modelled pressure [bar gauge]" }, fixedrange: true, showgrid: false, type: "category" }),
      yaxis: axis({ fixedrange: true, showgrid: false, type: "category", autorange: "reversed" }),
    });
    draw(this.chart, [{
      type: "heatmap", x: columns.map((band) => short(band).replace(" bar", "")), y: rows.map(short), z, text, customdata: hover, texttemplate: "%{text}", hovertemplate: "%{y}, %{x}<br>%{customdata}<extra></extra>",
      colorscale: scale, zmin: isSigned ? -largest : 0, zmax: largest, showscale: false, xgap: 2, ygap: 2, textfont: { size: isWide ? 9 : 10 },
    }], plotLayout).then(() => {
      this.chart.removeAllListeners?.("plotly_click");
      this.chart.on("plotly_click", ({ points: [point] }) => {
        const [row, column] = point.pointIndex ?? point.pointNumber;
        if (z[row][column] !== null) this.pick(`${signal.name}/error_map/${rows[row]}, ${columns[column]}`);
      });
    });
  }

  table(signal, regime) {
    const rows = regime.bins.map((bin) => {
      const error = bin.one_step_ahead ?? bin.free_run;
      const selected = `${signal.name}/${regime.dimension}/${bin.label}`;
      const share = Math.max(0, Math.min(1, error.excess_share ?? 0));
      return element("tr", { class: view.text("select") === selected ? "picked" : undefined },
        element("th", { scope: "row" }, button(bin.label, () => this.pick(selected), { class: "link regime", data: { select: selected }, "aria-pressed": String(view.text("select") === selected) })),
        element("td", {}, percent(bin.sample_share)),
        element("td", { class: "share" }, element("meter", { min: 0, max: 1, value: share, "aria-label": "share of the excess" }), element("span", { class: "figure" }, percent(error.excess_share))),
        element("td", {}, signed(error.bias, 3)));
    });
    return element("details", { open: ["valve_state", "duty_band"].includes(regime.dimension) }, element("summary", {}, regime.title),
      element("table", { class: "numbers" }, element("thead", {}, element("tr", {}, ["", "samples", term("excess error", "of the excess"), `bias [${signal.unit}]`].map((cell) => element("th", { scope: "col" }, cell)))), element("tbody", {}, rows)));
  }
}

/** Shortens the name of a band for the map: `70–90` for `70 to 90`, `< 30` for `below 30`. */
const short = (band) => label(band.replace(" to ", "–").replace("below ", "< ").replace(/(\S+( %)?) and more/, "≥ $1"));

const overLimit = (signal) => signal.limit ? signal.free_run.rms / signal.limit : 0;
