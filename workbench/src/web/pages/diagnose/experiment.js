// Next experiment: duty cycles that distinguish effects, or detect one.

import * as api from "../../api.js";
import { button, element, fill, showProblems, table } from "../../dom.js";
import { number } from "../../format.js";
import { DutyChart, LimitFields, dutiesLink } from "../planned.js";
import { Work } from "../work.js";

const PATH = "/next-experiment";

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
    this.work = new Work("Experiment plan", PATH);
    this.answer = element("div", { class: "stack" });
    this.chart = new DutyChart("next-plot");
    const [one, other] = question(diagnosis);
    const list = (chosen, none) => element("select", {}, none && element("option", { value: "", selected: chosen === "" }, none),
      [...effects.values()].map((effect) => element("option", { value: effect.id, selected: effect.id === chosen }, effect.title)));
    this.first = list(one);
    this.second = list(other, "nothing (detect it)");
    this.limits = new LimitFields();
    this.element = element("section", { class: "card", id: "next" }, element("h2", {}, "Next experiment"),
      element("p", { class: "quiet" }, "Each test signal within the limits is simulated with one effect as the truth. The other effect is then fitted to the result."),
      element("div", { class: "row" },
        element("label", {}, "Distinguish ", this.first), element("label", {}, "from ", this.second),
        this.limits.elements,
        button("Plan", () => this.plan(), { class: "primary", id: "plan" })),
      this.answer);
    this.begin();
  }

  /** Shows the experiment that was planned before. */
  async begin() {
    try {
      const next = await api.get(PATH);
      if (next) this.take(next);
      if (this.work.isRunning) await this.follow(this.work.resume());
    } catch (refusal) {
      showProblems(refusal, "Next experiment");
    }
  }

  async plan() {
    const request = {
      effects: [this.first.value, this.second.value].filter((id, index, all) => id && all.indexOf(id) === index),
      limits: this.limits.requested(),
    };
    await this.follow(this.work.run(PATH, request));
  }

  async follow(work) {
    if (!await work) return;
    try {
      this.take(await api.get(PATH));
    } catch (refusal) {
      showProblems(refusal, "Next experiment");
    }
  }

  take(next) {
    this.next = next;
    const signals = next.ranking.map((one) => [
      element("span", { title: one.about }, one.name), number(one.distance, 3), number(one.highest_bar, 3), number(one.duration_s, 3),
    ]);
    const sensors = next.sensors.map((one) => [one.quantity, number(one.difference_rms, 3), one.unit, number(one.in_noise, 3)]);
    fill(this.answer,
      element("p", {}, `${next.sentence[0].toUpperCase()}${next.sentence.slice(1)}.`),
      this.chart.element,
      dutiesLink("/next-experiment/csv", "next-experiment.csv", "next-csv"),
      element("details", {}, element("summary", {}, `${signals.length} test signals${sensors.length > 0 ? ` and ${sensors.length} sensors` : ""}`),
        table(["test signal", "distance [σ of the noise]", "maximum [bar]", "duration [s]"], signals, "numbers"),
        sensors.length > 0 && table(["sensor", "difference", "unit", "difference/noise"], sensors, "numbers")));
    this.redraw();
  }

  redraw() {
    if (this.next) this.chart.draw(this.next);
  }

  leave() {
    this.work.leave();
    this.chart.clear();
  }
}
