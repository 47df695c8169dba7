// Experiment that determines the ordinary parameters that the logs do not determine.

import * as api from "../../api.js";
import { button, element, fill, scrolling, showProblems, table } from "../../dom.js";
import { number, unitText } from "../../format.js";
import { DutyChart, LimitFields, dutiesLink } from "../planned.js";
import { Work } from "../work.js";

const PATH = "/estimate/experiment";
const interval = ([low, high]) => `${number(low, 3)} to ${number(high, 3)}`;

const COLUMNS = ["parameter", "value", "interval now", "interval after", "unit"];

/** Returns the rows of one parameter; where it stays open, the second one says what would determine it. */
function rows(one) {
  const cells = [number(one.value), interval(one.now), interval(one.after), unitText(one.unit)];
  const advice = `To determine it, ${one.determined_by}.`;
  return [
    element("tr", {}, element("th", { scope: "row" }, one.name), cells.map((cell) => element("td", {}, cell))),
    one.determined_by && element("tr", {}, element("td", { class: "known quiet", colspan: COLUMNS.length }, advice)),
  ];
}

function parameterTable(parameters) {
  return element("table", { class: "numbers dense" },
    element("thead", {}, element("tr", {}, COLUMNS.map((cell) => element("th", { scope: "col" }, cell)))),
    element("tbody", {}, parameters.flatMap(rows)));
}

export class Experiment {
  /** `selection` returns the log and the chosen logs of the page. */
  constructor(selection) {
    Object.assign(this, { selection, next: null });
    this.work = new Work("Experiment plan", PATH);
    this.limits = new LimitFields();
    this.chart = new DutyChart("determining-plot");
    this.answer = element("div", { class: "stack" });
    this.element = element("section", { class: "card", id: "determining", hidden: true },
      element("h2", {}, "Experiment to determine the parameters"),
      element("p", { class: "quiet" }, "Test signals within the limits are simulated with the estimated plant. The best one narrows the intervals most."),
      element("div", { class: "row" }, this.limits.elements,
        button("Plan", () => this.plan(), { id: "plan-determining" })),
      this.answer);
  }

  /** Shows the card after an estimation, and the experiment that was planned for the current plant. */
  async take(hasEstimation) {
    this.element.hidden = !hasEstimation;
    if (!hasEstimation) return;
    try {
      this.show(await api.get(PATH));
    } catch (refusal) {
      showProblems(refusal, "Experiment");
    }
  }

  async plan() {
    await this.follow(this.work.run(PATH, { ...this.selection(), limits: this.limits.requested() }));
  }

  /** Follows the plan that was begun when the page was shown before. */
  async resume() {
    if (this.work.isRunning) await this.follow(this.work.resume());
  }

  async follow(work) {
    if (await work) await this.take(true);
  }

  show(next) {
    this.next = next;
    if (!next) {
      fill(this.answer);
      return;
    }
    const signals = next.ranking.map((one) => [
      element("span", { title: one.about }, one.name), String(one.determines.length), number(one.width_after, 2),
      number(one.highest_bar, 3), number(one.duration_s, 3),
    ]);
    fill(this.answer,
      element("p", {}, `${next.sentence[0].toUpperCase()}${next.sentence.slice(1)}.`),
      !next.is_adequate && element("p", { class: "quiet" }, "The error on these logs exceeds the noise. The intervals assume a plant whose error is the noise."),
      this.chart.element,
      dutiesLink(`${PATH}/csv`, "determining-experiment.csv", "determining-csv"),
      scrolling("Intervals before and after the experiment", parameterTable(next.parameters)),
      element("details", {}, element("summary", {}, `${signals.length} test signals`),
        table(["test signal", "determines", "width after/now", "maximum [bar]", "duration [s]"], signals, "numbers")));
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
