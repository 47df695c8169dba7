// Robustness (Monte Carlo): distribution of the settling times over scattered rigs, and the limit.

import * as api from "../../api.js";
import { axis, clear, draw, layout } from "../../chart.js";
import { button, element, fill, scrolling, showProblems } from "../../dom.js";
import { count, percent } from "../../format.js";
import { colour } from "../../theme.js";
import { roleOf } from "./charts.js";

export class BatchCard {
  constructor(ending, choose) {
    Object.assign(this, { ending, choose });
    this.rigs = element("input", { type: "number", min: 1, max: 1000, class: "short", id: "rigs" });
    this.seed = element("input", { type: "number", min: 0, class: "short", id: "seed" });
    this.status = element("div", { class: "verdict", role: "status", id: "batch-status" });
    this.chart = element("div", { class: "chart", id: "settling", hidden: true, role: "img", "aria-label": "Cumulative distribution of the settling times of steps and rigs" });
    this.numbers = element("div", { class: "stack" });
    this.element = element("section", { class: "card", "aria-label": "Robustness (Monte Carlo)" },
      element("h2", {}, "Robustness (Monte Carlo)"),
      element("p", { class: "quiet" }, "Each rig is the plant with random deviations of: flows, preloads, coils, volume, spring, delay, supply."),
      element("div", { class: "row" }, element("label", {}, "rigs ", this.rigs), element("label", {}, "seed ", this.seed), button("Run the batch", () => this.run(), { class: "primary", id: "run-batch" }), this.status),
      this.chart, this.key = element("p", { class: "quiet", hidden: true }, "Solid: the slowest step of each rig. Dotted: all steps. Where a curve ends below 100 %, the rest never settled."), this.numbers);
  }

  showQuery(query) {
    Object.assign(this, { query });
    this.rigs.value = query.rigs;
    this.seed.value = query.seed;
    if (this.batch) this.note();
  }

  leave() {
    clear(this.chart);
  }

  redraw() {
    if (this.batch) this.paint();
  }

  async run() {
    const [rigs, seed] = [Number(this.rigs.value), Number(this.seed.value)];
    const bar = element("progress", { max: 1, value: 0, "aria-label": "running the batch" });
    const share = element("span", { class: "quiet" });
    const stop = new AbortController();
    this.ending.addEventListener("abort", () => stop.abort());
    try {
      if (rigs !== this.query.rigs || seed !== this.query.seed) await this.choose({ rigs, seed }, seed !== this.query.seed);
      const begun = await api.post("/control/batch");
      fill(this.status, bar, share, button("Stop", () => stop.abort(), { id: "stop-batch" }));
      await api.follow(begun.job, (done) => { bar.value = done; share.textContent = percent(done); }, stop.signal);
      await this.take();
    } catch (refusal) {
      if (this.ending.aborted) return;
      fill(this.status, element("span", { class: "chip open" }, refusal.name === "AbortError" ? "stopped" : "not run"));
      if (refusal.name !== "AbortError") showProblems(refusal, "Batch");
    }
  }

  async take() {
    this.batch = await api.get("/control/batch");
    this.note(this.batch.is_current);
    fill(this.numbers, this.table(), this.batch.plants.map((plant) => failing(plant)));
    await this.paint();
  }

  note(isCurrent = false) {
    fill(this.status, this.batch.plants.map(({ plant, rigs, hold }) => element("span", { class: `chip ${hold === rigs ? "good" : "bad"}` }, `${plant.role === "plant" ? "" : `${plant.role}: `}${hold} of ${rigs} rigs pass`)),
      !isCurrent && element("span", { class: "chip open" }, "outdated: settings changed"));
  }

  table() {
    const limit = this.batch.requirement.t_req_samples;
    const row = (plant, what, times) => element("tr", {}, element("th", { scope: "row" }, plant.role === "plant" ? what : `${plant.role}, ${what}`),
      [times.count, times.median_samples, times.within_95_samples].map((cell) => element("td", {}, cell === null ? "never" : count(cell))),
      element("td", {}, percent(times.share_within_limit)), element("td", {}, String(times.never)));
    return scrolling("Settling times", element("table", { class: "numbers", id: "settling-times" },
      element("thead", {}, element("tr", {}, ["settling times", "count", "median [samples]", "95 % [samples]", `within ${limit} samples`, "never settled"].map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {}, this.batch.plants.map(({ plant, steps, slowest }) => [
        row(plant, "all steps", steps), row(plant, "slowest step of each rig", slowest),
      ]))));
  }

  async paint() {
    this.chart.hidden = this.key.hidden = false;
    const limit = this.batch.requirement.t_req_samples;
    const last = Math.max(limit, ...this.batch.plants.flatMap(({ steps, slowest }) => [...steps.points, ...slowest.points].map(([samples]) => samples)));
    const end = Math.ceil(1.08 * last);
    const distribution = ({ points }, role, more) => ({
      x: [0, ...points.map(([samples]) => samples), end], y: [0, ...points.map(([, share]) => 100 * share), 100 * (points.at(-1)?.[1] ?? 0)],
      type: "scatter", mode: "lines", line: { shape: "hv", color: colour(role), ...more }, hovertemplate: "%{y:.0f} % within %{x} samples<extra></extra>",
    });
    const traces = this.batch.plants.flatMap(({ plant, steps, slowest }) => {
      const role = `run-${roleOf(plant)}`;
      return [distribution(steps, role, { width: 1.2, dash: "dot" }), distribution(slowest, role, { width: 2.2 })];
    });
    await draw(this.chart, traces, layout({
      height: 260, margin: { l: 64, r: 14, t: 26, b: 44 },
      xaxis: axis({ range: [0, end], title: { text: "settling time [samples]", standoff: 6 }, fixedrange: true }),
      yaxis: axis({ range: [0, 104], title: { text: "settled [%]", standoff: 6 }, fixedrange: true }),
      shapes: [{ type: "line", xref: "x", yref: "paper", x0: limit, x1: limit, y0: 0, y1: 1, line: { color: colour("limit"), width: 1.5, dash: "dot" } }],
      annotations: [{ xref: "x", yref: "paper", x: limit, y: 1, xanchor: "right", yanchor: "bottom", showarrow: false, text: `limit T_req: ${limit} samples`, font: { color: colour("limit") } }],
    }));
  }
}

/** Lists the failing rigs with their seeds, with which each can be run again. */
function failing({ plant, rigs, hold, failing: shown }) {
  if (shown.length === 0) return false;
  return element("details", { class: "tables" }, element("summary", {}, `${plant.role === "plant" ? "" : `${plant.role}: `}${rigs - hold} of ${rigs} rigs fail a binding requirement`),
    element("ul", { class: "plain" }, shown.map(({ rig, seed, requirements }) => element("li", {}, `rig ${rig}, seed ${seed}: ${requirements.join("; ")}`))));
}
