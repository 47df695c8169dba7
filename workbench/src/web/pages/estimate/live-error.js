// Error of the model while it is estimated: the worst signal after each step, in multiples of its noise floor.

import { axis, clear, draw, layout } from "../../chart.js";
import { element } from "../../dom.js";
import { number, titled } from "../../format.js";
import { colour } from "../../theme.js";

const HEIGHT = 190;

export class LiveError {
  constructor() {
    this.job = null;
    this.words = element("p", { id: "live-error", role: "status" });
    const about = "Error of the worst signal over the time of the estimation";
    this.chart = element("div", { class: "chart", id: "live-error-plot", role: "img", "aria-label": about });
    this.element = element("section", { class: "card", hidden: true }, element("h2", {}, "Error while estimating"), this.words, this.chart);
  }

  /** Follows a job; null ends the view. */
  watch(job) {
    if (this.job) this.job.onError = null;
    this.job = job;
    this.element.hidden = !job;
    if (!job) return;
    job.onError = () => this.redraw();
    this.redraw();
  }

  leave() {
    this.watch(null);
    clear(this.chart);
  }

  redraw() {
    if (!this.job) return;
    const { errors } = this.job;
    const last = errors.at(-1);
    this.words.textContent = last
      ? `${titled(last.signal)}: ${number(last.floors, 3)} × noise floor, the worst signal of the training logs after step ${errors.length}.`
      : "The first step is being computed.";
    if (errors.length === 0) return;
    const floors = errors.map((error) => error.floors);
    const most = Math.max(2, ...floors) * 1.5;
    draw(this.chart, [{
      type: "scatter", mode: "lines+markers", x: errors.map((error) => error.seconds), y: floors,
      line: { color: colour("model"), width: 2 }, marker: { size: 5 },
      hovertemplate: "%{y:.2f} × noise after %{x:.0f} s<extra></extra>",
    }], layout({
      height: HEIGHT, margin: { l: 64, r: 14, t: 10, b: 42 }, dragmode: false,
      xaxis: axis({ title: { text: "time [s]", standoff: 4 }, rangemode: "tozero", fixedrange: true }),
      yaxis: axis({
        title: { text: "× noise floor", standoff: 4 }, type: "log", range: [Math.log10(0.7), Math.log10(most)], dtick: most > 20 ? 1 : "D2", fixedrange: true,
      }),
      shapes: [{ type: "line", xref: "paper", x0: 0, x1: 1, y0: 1, y1: 1, line: { color: colour("limit"), width: 1.5 } }],
    }));
  }
}
