// Last estimation: error before and after, intervals and correlations as pictures, and how well the logs determine each
// parameter.

import { clear } from "../../chart.js";
import { element, fill, scrolling, showProblems } from "../../dom.js";
import { number, unitText } from "../../format.js";
import { errorSteps, rungsOf } from "../error-steps.js";
import { drawCorrelations, drawIntervals, strongest } from "./charts.js";

const WORDS = { determined: "determined", not_excited: "not excited", at_limit: "at the limit" };
const COLUMNS = ["parameter", "before", "after", "95 % interval", "unit", "identifiability"];

/** Returns the meaning of the colours of the correlations. */
const scale = () => element("span", { class: "row legend" }, element("span", { class: "key model" }, "+1"), element("span", { class: "key fill" }, "−1"));

/** Returns the advice below a parameter's row: logs that would determine it. */
function advice({ determination: { only_together_with: together }, determined_by: by }) {
  const words = [together && `Only a combination with ${together.parameters.join(", ")} is determined.`, by && `To determine it, ${by}.`];
  const text = words.filter(Boolean).join(" ");
  return text !== "" && element("tr", {}, element("td", { class: "known quiet", colspan: COLUMNS.length }, text));
}

function rows(parameter) {
  const { determination } = parameter;
  return [
    element("tr", { class: parameter.is_beyond_usual ? "picked" : undefined },
      element("th", { scope: "row" }, parameter.name),
      element("td", {}, number(parameter.before)), element("td", {}, number(parameter.after)),
      element("td", {}, `${number(parameter.low, 3)} to ${number(parameter.high, 3)}`), element("td", {}, unitText(parameter.unit)),
      element("td", {}, determination.only_together_with ? "only with others" : WORDS[determination])),
    advice(parameter),
  ];
}

/** Returns the table of all parameters. */
function tableOf({ parameters }) {
  const beyond = parameters.some((parameter) => parameter.is_beyond_usual);
  return [
    beyond && element("p", { class: "quiet" }, "Marked: outside the usual tolerance of the part; the plant file is wrong there."),
    scrolling("Estimated parameters",
      element("table", { class: "numbers dense", id: "estimated" },
        element("thead", {}, element("tr", {}, COLUMNS.map((cell) => element("th", { scope: "col" }, cell)))),
        element("tbody", {}, parameters.flatMap(rows)))),
  ];
}

export class Estimated {
  constructor() {
    const chart = (id, about) => element("div", { class: "chart", id, role: "img", "aria-label": about });
    this.intervals = chart("interval-plot", "95 % interval of each parameter within the range that the estimation may use");
    this.correlations = chart("correlation-plot", "Correlation of each pair of parameters");
    this.element = element("section", { class: "card", id: "estimation", hidden: true });
  }

  /** Shows an estimation; nothing without one. */
  take(estimation) {
    this.estimation = estimation;
    this.element.hidden = !estimation;
    if (!estimation) {
      this.leave();
      return;
    }
    const hasPictures = estimation.parameters.length > 0;
    const picture = (heading, words, chart) => element("section", { class: "stack tight" },
      element("h3", {}, heading), element("p", { class: "quiet" }, words), chart);
    fill(this.element,
      element("h2", {}, "Last estimation"),
      element("p", {}, `${estimation.sentence[0].toUpperCase()}${estimation.sentence.slice(1)}.`),
      element("p", { class: "quiet" }, `Validation on ${estimation.held_out}: one-step-ahead errors, as on Diagnose.`),
      errorSteps(rungsOf(estimation.steps)),
      hasPictures && element("div", { class: "columns even" },
        picture("Intervals", "A whisker is the 95 % interval; the bar behind it is the range that the estimation may use.", this.intervals),
        estimation.correlations.length > 0 && picture("Correlations", [strongest(estimation), " ", scale()], this.correlations)),
      hasPictures && tableOf(estimation));
    this.redraw();
  }

  redraw() {
    const { estimation } = this;
    if (!estimation || estimation.parameters.length === 0) return;
    const drawn = [drawIntervals(this.intervals, estimation)];
    if (estimation.correlations.length > 0) drawn.push(drawCorrelations(this.correlations, estimation));
    Promise.all(drawn).catch((error) => showProblems(error, "Plot"));
  }

  leave() {
    clear(this.intervals);
    clear(this.correlations);
  }
}
