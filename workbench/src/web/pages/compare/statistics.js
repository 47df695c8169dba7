// Statistics of a trace: histogram and power spectral density.

import * as api from "../../api.js";
import { axis, draw, label, layout } from "../../chart.js";
import { element, fill } from "../../dom.js";
import { count, number, signed, unitText } from "../../format.js";
import { colour } from "../../theme.js";
import * as view from "../../view.js";
import { Look, chooser, rangeQuery } from "./look.js";

/** Points of the normal curve. */
const CURVE = 160;
/** Standard deviations that the curve covers. */
const CURVE_SIGMAS = 5;
/** Name of the noise in a legend. */
const NOISE = "measured noise";
const INK = { measured: "measured", modelled: "model", residual: "residual" };

/** Chart of one trace: the residual, the measured or the modelled values of a signal. */
class Statistics extends Look {
  constructor(title, id, log, compared, names) {
    super(title, id);
    Object.assign(this, { log, id });
    const traces = [
      ...compared.map((name) => [`residual/${name}`, `residual of ${name}`]), ...names.map((name) => [`measured/${name}`, name]),
      ...compared.map((name) => [`modelled/${name}`, `${name}, modelled`]),
    ];
    this.trace = traces.some(([key]) => key === view.text(id)) ? view.text(id) : traces[0][0];
    fill(this.tools, element("label", {}, "Of ", chooser(`${id}-of`, traces, this.trace, (trace) => { this.trace = trace; view.set({ [id]: trace }); this.again(); })),
      element("span", { class: "space" }), this.exports());
  }

  get side() { return this.trace.slice(0, this.trace.indexOf("/")); }

  get signal() { return this.trace.slice(this.side.length + 1); }

  get content() { return this.words; }

  get words() { return this.side === "residual" ? `${this.signal}: measured − modelled` : this.side === "modelled" ? `${this.signal}, modelled` : this.signal; }

  async fetch() {
    const query = rangeQuery(new URLSearchParams({ signal: this.signal, of: this.side }));
    this.data = await api.get(`/logs/${this.log.number}/${this.id}?${query}`);
    await this.paint();
  }

  /**
   * Draws a chart with logarithmic axes where requested. Powers of ten are `1e−3`, since the library's own format needs
   * styles that the content policy refuses.
   */
  show(traces, xaxis, yaxis) {
    const hover = traces.map((trace) => ({ hoverinfo: "skip", ...trace }));
    return draw(this.chart, hover, layout({ height: 320, bargap: 0, xaxis: axis(xaxis), yaxis: axis({ tickformat: ".1~e", ...yaxis }) }));
  }
}

export class Distribution extends Statistics {
  constructor(...of) { super("Distribution", "distribution", ...of); }

  async paint() {
    if (!this.data) return;
    const { histogram, noise, unit } = this.data;
    if (!histogram) {
      this.note.textContent = "No sample of this trace is in the visible range.";
      await this.show([], {}, {});
      return;
    }
    const { from, bin_width: width, density, samples, mean, standard_deviation: deviation } = histogram;
    const x = density.map((_, bin) => from + (bin + 0.5) * width);
    const bars = { name: label(this.words), type: "bar", x, y: density.map((value) => value || null), width, marker: { color: colour(INK[this.side]), opacity: 0.6, line: { width: 0 } }, hoverinfo: "all", hovertemplate: "%{x:.5g}: %{y:.3g}<extra></extra>" };
    // The residual of a perfect model is its noise alone, around zero.
    const curve = noise ? normal(this.side === "residual" ? 0 : mean, noise) : { x: [], y: [] };
    // A logarithmic axis shows the tails; one sample is the smallest possible content of a bin.
    const least = 0.5 / (samples * width);
    const most = 1.6 * Math.max(...density, ...curve.y);
    const seen = curve.x.filter((_, index) => curve.y[index] > least);
    const ends = [from, from + density.length * width, ...seen];
    await this.show([bars, { name: noise ? NOISE : undefined, type: "scatter", mode: "lines", ...curve, line: { color: colour("limit"), width: 2 } }],
      { title: { text: label(`${this.words} [${unit}]`) }, range: [Math.min(...ends), Math.max(...ends)] },
      { title: { text: label(`share per ${unit}`) }, type: "log", range: [Math.log10(least), Math.log10(most)] });
    this.note.textContent = `${count(samples)} samples in the visible range, mean ${signed(mean)} ${unit}, standard deviation ${number(deviation)} ${unit}. `
      + (noise ? `Red: the measured noise, σ = ${number(noise)} ${unit}.` : "Its noise is unknown.");
  }
}

export class Spectrum extends Statistics {
  constructor(...of) { super("Spectrum", "spectrum", ...of); }

  async paint() {
    if (!this.data) return;
    const { spectrum, noise_level: level, unit } = this.data;
    if (!spectrum) {
      this.note.textContent = "A spectrum needs 128 samples without a gap in the visible range. Zoom out.";
      await this.show([], {}, {});
      return;
    }
    const { frequency_hz: x, density: y, segments, resolution_hz: resolution } = spectrum;
    const line = { name: label(this.words), type: "scatter", mode: "lines", x, y: y.map((value) => value || null), line: { color: colour(INK[this.side]), width: 1.4 }, hoverinfo: "all", hovertemplate: "%{x:.4g} Hz: %{y:.3g}<extra></extra>" };
    const noise = { name: level ? NOISE : undefined, type: "scatter", mode: "lines", x: level ? [x[0], x.at(-1)] : [], y: level ? [level, level] : [], line: { color: colour("limit"), width: 2, dash: "dot" } };
    const squared = /^[A-Za-zΩ%°]+$/.test(unitText(unit)) ? `${unitText(unit)}²` : `(${unitText(unit)})²`;
    await this.show([line, noise],
      { title: { text: "frequency [Hz]" }, type: "log", range: [x[0], x.at(-1)].map(Math.log10) },
      { title: { text: label(`power density [${squared}/Hz]`) }, type: "log", nticks: 8 });
    this.note.textContent = `Welch's method: ${count(segments)} Hann-windowed ${segments === 1 ? "segment" : "segments"}, a value every ${number(resolution, 3)} Hz; the area below is the variance. `
      + (level ? "Dotted: the measured noise, if it is white." : "Its noise is unknown.");
  }
}

/** Returns the visible part of the normal distribution. */
function normal(mean, deviation) {
  const x = Array.from({ length: CURVE + 1 }, (_, point) => mean + CURVE_SIGMAS * deviation * (2 * point / CURVE - 1));
  const scale = 1 / (deviation * Math.sqrt(2 * Math.PI));
  return { x, y: x.map((value) => scale * Math.exp(-0.5 * ((value - mean) / deviation) ** 2)) };
}
