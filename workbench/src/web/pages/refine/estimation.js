// Estimated ordinary parameters: before, after, interval, and how well the logs determine each.

import { element } from "../../dom.js";
import { number, unitText } from "../../format.js";
import { errorSteps, rungsOf } from "../error-steps.js";

const WORDS = { determined: "determined", not_excited: "not excited", at_limit: "at the limit" };
const COLUMNS = ["parameter", "before", "after", "95 % interval", "unit", "identifiability"];

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

/** Returns the parts of the card of an estimation. */
export function estimated(estimation) {
  const beyond = estimation.parameters.some((parameter) => parameter.is_beyond_usual);
  return [
    element("h2", {}, "Last estimation"),
    element("p", {}, `${estimation.sentence[0].toUpperCase()}${estimation.sentence.slice(1)}.`),
    element("p", { class: "quiet" }, `Validation on ${estimation.held_out}: one-step-ahead errors, as on Diagnose.`),
    errorSteps(rungsOf(estimation.steps)),
    beyond && element("p", { class: "quiet" }, "Marked: outside the usual tolerance of the part; the plant file is wrong there."),
    element("div", { class: "scroll" }, element("table", { class: "numbers dense", id: "estimated" },
      element("thead", {}, element("tr", {}, COLUMNS.map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {}, estimation.parameters.flatMap(rows)))),
  ];
}
