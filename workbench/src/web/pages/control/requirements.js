// Table of requirements: limits, and results on each plant.

import { button, element, scrolling } from "../../dom.js";
import { number } from "../../format.js";

const BOUND = { at_most: "≤", less_than: "<" };

/** Rows are checks, in the order of the verdict; columns are plants. */
export function requirements(result, goTo) {
  const { runs } = result;
  const ids = [...new Set(runs.flatMap(({ verdict }) => verdict.checks.map((check) => check.id)))];
  const rows = ids.map((id) => row(id, runs.map(({ verdict }) => verdict.checks.find((check) => check.id === id))));
  const heads = runs.flatMap(({ plant }) => [element("th", { scope: "col" }, plant.role === "plant" ? "result" : `result, ${plant.role}`), element("th", { scope: "col" }, "verdict")]);
  return [
    element("h2", {}, "Requirements"),
    element("p", { class: "quiet" },
      "Pass: every binding requirement is met, and at least one step is checked. ", result.controller, "."),
    scrolling("Requirements", element("table", { id: "requirements" },
      element("thead", {}, element("tr", {}, ["requirement", "limit"].map((cell) => element("th", { scope: "col" }, cell)), heads)),
      element("tbody", {}, rows))),
    ...runs.map((run) => notes(run, goTo)),
  ];
}

function row(id, checks) {
  const known = checks.find(Boolean);
  const cells = checks.flatMap((check) => check
    ? [element("td", { class: "number", title: check.evidence }, check.reached === null ? "never" : short(check.reached)), element("td", {}, chip(check))]
    : [element("td", { class: "quiet" }, "not checked"), element("td")]);
  return element("tr", { data: { check: id }, class: known.binding ? undefined : "quiet" },
    element("th", { scope: "row" }, known.requirement, !known.binding && element("span", { class: "unit" }, "not binding")),
    element("td", { class: "number" }, `${BOUND[known.bound]} ${short(known.limit)} `, element("span", { class: "unit" }, known.unit)), cells);
}

/** Counts have no decimals. */
const short = (value) => Number.isInteger(value) ? String(value) : number(value, 3);

function chip(check) {
  if (check.holds) return element("span", { class: "chip good" }, "pass");
  return element("span", { class: `chip ${check.binding ? "bad" : "open"}` }, "fail");
}

/** Returns the number of actuations, and the link to the step that settled last. */
function notes({ plant, verdict }, goTo) {
  const slow = (step) => [step.in_operating_range ? 1 : 0, step.settled_samples ?? Infinity];
  const last = verdict.steps.reduce((worst, step) => {
    const [a, b] = [slow(step), slow(worst)];
    return a[0] > b[0] || (a[0] === b[0] && a[1] > b[1]) ? step : worst;
  }, verdict.steps[0]);
  const moved = verdict.actuations;
  return element("p", { class: "quiet" },
    plant.role !== "plant" && element("b", {}, `${plant.role}: `),
    moved && `Actuations: fill valve ${moved.fill}, vent valve ${moved.vent}, ${number(moved.per_s, 3)} per second. `,
    last && [`Slowest of ${verdict.steps.length} steps: ${number(last.from_bar, 3)} → ${number(last.to_bar, 3)} bar, ${last.settled_samples === null ? "never settled" : `settled after ${last.settled_samples} samples`}. `,
      button("Show in plot", () => goTo(last.time_s), { class: "link" })]);
}
