// Inspection of a log: its columns, the guess of each with its reason, open questions.

import { button, element, scrolling } from "../dom.js";
import { count, duration, number } from "../format.js";

/**
 * Creates the view of an inspection, without the problems if the card of the log lists them; `answer` gets `gauge` or `absolute`, `apply` the text of
 * a mapping.
 */
export function inspectionView(inspection, hasProblems, answer, apply) {
  const length = inspection.duration_s === null ? "" : `, ${duration(inspection.duration_s)}`;
  return element("section", { class: "inspection", "aria-label": "Inspection" },
    element("h3", {}, "Columns"),
    element("p", { class: "facts" }, `${inspection.layout} · ${count(inspection.rows)} rows${length}`),
    scrolling("Columns of the log", element("table", { class: "numbers" },
      element("thead", {}, element("tr", {}, ["column", "rate", "missing", "least", "greatest", "signal", "unit", "reason"]
        .map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {}, inspection.columns.map(columnLine)))),
    inspection.open.length > 0 && element("div", { class: "open-questions" },
      element("h4", {}, "Open"),
      element("ul", { class: "plain" }, inspection.open.map((one) => element("li", {}, one.question,
        !one.answer.startsWith("--") && element("span", { class: "quiet" }, ` Answer: ${one.answer}`)))),
      inspection.asks_reference && element("p", { class: "row" },
        ["gauge", "absolute"].map((reference) => button(`Pressures are ${reference}`, () => answer(reference),
          { class: inspection.suggested === reference ? "primary" : undefined, data: { reference } })))),
    list("Assumed, to be checked", inspection.assumed),
    !hasProblems && [
      list("Not read", inspection.remarks),
      list("Gaps and missing cells", inspection.defects),
      inspection.problem && element("p", { class: "problem" }, inspection.problem.message),
    ],
    inspection.mapping && !inspection.asks_reference && element("p", { class: "row" },
      button("Use these signals", () => apply(inspection.mapping), { class: "primary use-inspection" })));
}

function columnLine(column) {
  const unit = column.unit_in_file && element("span", { class: "unit" }, column.unit_in_file);
  return element("tr", {},
    element("th", { scope: "row" }, column.key, unit),
    [column.rate_hz === null ? "–" : `${number(column.rate_hz, 3)} Hz`, column.is_slower ? "slower" : count(column.empty),
      number(column.least, 5), number(column.greatest, 5), column.signal ?? "–", column.unit ?? "", column.reason]
      .map((cell) => element("td", {}, cell)));
}

function list(title, lines) {
  return lines.length > 0 && [element("h4", {}, title), element("ul", { class: "plain" }, lines.map((line) => element("li", {}, line)))];
}
