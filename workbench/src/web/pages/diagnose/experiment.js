// Next experiment: duty cycles that distinguish effects, or detect one.

import * as api from "../../api.js";
import { axis, clear, draw, label, layout } from "../../chart.js";
import { button, element, fill, tellProblems } from "../../dom.js";
import { number } from "../../format.js";
import { colour } from "../../theme.js";
import { Work } from "../work.js";

const HEIGHT = 230;

/**
 * Returns the default question: the named effect and its nearest neighbour, or an effect below the detection limit of
 * the logs.
 */
function question(diagnosis) {
  const first = diagnosis.effects[0];
  if (first) {
    const nearest = Object.entries(diagnosis.distinguishability[first] ?? {}).sort((a, b) => a[1] - b[1])[0];
    return [first, nearest?.[0] ?? ""];
  }
  const unseen = diagnosis.candidates.find((candidate) => candidate.detection_limit.not_excited);
  return [(unseen ?? diagnosis.candidates[0]).effect, ""];
}

export class Experiment {
  constructor(diagnosis, effects) {
    Object.assign(this, { diagnosis, effects, next: null });
    this.work = new Work("Planning");
    this.answer = element("div", { class: "stack" });
    this.chart = element("div", { class: "chart", id: "next-plot", role: "img", "aria-label": "Duty cycles of the best manoeuvre" });
    const [one, other] = question(diagnosis);
    const list = (chosen, none) => element("select", {}, none && element("option", { value: "", selected: chosen === "" }, none),
      [...effects.values()].map((effect) => element("option", { value: effect.id, selected: effect.id === chosen }, effect.title)));
    this.first = list(one);
    this.second = list(other, "nothing: show it");
    const field = (value, more) => element("input", { type: "number", min: 0, step: "any", class: "short", value, ...more });
    this.duration = field(20);
    this.pressure = field("", { placeholder: "auto", title: "Without a wish, nine tenths of the supply pressure" });
    this.duty = field(100);
    this.element = element("section", { class: "card", id: "next" }, element("h2", {}, "The next experiment"),
      element("p", { class: "quiet" }, "Manoeuvres within the limits are simulated with each effect as the truth and seen by the other, which may refit all that it may move."),
      element("div", { class: "row" },
        element("label", {}, "Tell ", this.first), element("label", {}, "from ", this.second),
        element("label", {}, "within ", this.duration, " s"), element("label", {}, "below ", this.pressure, " bar"), element("label", {}, "up to ", this.duty, " %"),
        button("Plan", () => this.plan(), { class: "primary", id: "plan" }), this.work.element),
      this.answer);
    this.begin();
  }

  /** Shows the experiment that was planned before. */
  async begin() {
    try {
      const next = await api.get("/next-experiment");
      if (next) this.take(next);
    } catch (refusal) {
      tellProblems(refusal, "Next experiment");
    }
  }

  async plan() {
    const wish = {
      effects: [this.first.value, this.second.value].filter((id, index, all) => id && all.indexOf(id) === index),
      duration_s: Number(this.duration.value), max_bar: this.pressure.value === "" ? null : Number(this.pressure.value), max_duty_pct: Number(this.duty.value),
    };
    if (!await this.work.run("/next-experiment", wish)) return;
    try {
      this.take(await api.get("/next-experiment"));
    } catch (refusal) {
      tellProblems(refusal, "Next experiment");
    }
  }

  take(next) {
    this.next = next;
    const row = (cells) => element("tr", {}, cells.map((cell, index) => element(index === 0 ? "th" : "td", index === 0 ? { scope: "row" } : {}, cell)));
    const head = (cells) => element("thead", {}, element("tr", {}, cells.map((cell) => element("th", { scope: "col" }, cell))));
    fill(this.answer,
      element("p", {}, `${next.sentence[0].toUpperCase()}${next.sentence.slice(1)}.`),
      this.chart,
      element("p", { class: "row" }, element("a", { class: "button", href: api.address("/next-experiment/csv"), download: "next-experiment.csv", id: "next-csv" }, "Duty cycles as CSV"),
        element("span", { class: "quiet" }, "One row per ECU sample; a rig takes it, and so does retarder simulate.")),
      element("details", {}, element("summary", {}, `${next.ranking.length} manoeuvres${next.sensors.length > 0 ? ` and ${next.sensors.length} sensors` : ""}`),
        element("table", { class: "numbers" }, head(["manoeuvre", "apart [σ of the noise]", "highest [bar]", "length [s]"]),
          element("tbody", {}, next.ranking.map((one) => row([element("span", { title: one.about }, one.name), number(one.distance, 3), number(one.highest_bar, 3), number(one.duration_s, 3)])))),
        next.sensors.length > 0 && element("table", { class: "numbers" }, head(["sensor", "difference", "unit", "over its noise"]),
          element("tbody", {}, next.sensors.map((one) => row([one.quantity, number(one.difference_rms, 3), one.unit, number(one.in_noise, 3)]))))));
    this.redraw();
  }

  redraw() {
    if (!this.next) return;
    const { sequence, ranking } = this.next;
    const end = ranking[0]?.duration_s ?? 0;
    const times = [...sequence.map((phase) => phase.time_s), end];
    const course = (name, role, key, dash) => ({
      name, x: times, y: [...sequence.map((phase) => phase[key]), sequence.at(-1)?.[key] ?? 0], mode: "lines", type: "scatter",
      line: { color: colour(role), width: 2, shape: "hv", dash }, hovertemplate: `${name} %{y:.0f} % from %{x:.2f} s<extra></extra>`,
    });
    draw(this.chart, [course("fill valve", "fill", "duty_fill_pct", "solid"), course("vent valve", "vent", "duty_vent_pct", "dash")], layout({
      height: HEIGHT, showlegend: true, legend: { orientation: "h", x: 1, xanchor: "right", y: 1.12, yanchor: "bottom" },
      title: { text: label(ranking[0]?.name ?? ""), font: { size: 13 }, x: 0, xanchor: "left" },
      xaxis: axis({ title: { text: "time [s]", standoff: 4 }, range: [0, end] }), yaxis: axis({ title: { text: "duty cycle [%]", standoff: 4 }, range: [-4, 106] }),
    }));
  }

  leave() {
    this.work.leave();
    clear(this.chart);
  }
}
