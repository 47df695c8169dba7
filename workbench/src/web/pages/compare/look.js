// Common parts of the detail charts.

import { saveImage } from "../../chart.js";
import { button, element, showProblems } from "../../dom.js";
import { fileName } from "../../format.js";
import * as view from "../../view.js";

/** Adds the visible range to a request. */
export function rangeQuery(query) {
  for (const [name, key] of [["from", "from_s"], ["to", "to_s"]]) {
    const value = view.numberOf(name);
    if (value !== null) query.set(key, value);
  }
  return query;
}

/** Creates a choice of `[key, text]`. */
export const chooser = (name, entries, value, act) => element("select", { "aria-label": name, id: name, on: { change: (event) => act(event.target.value) } },
  entries.map(([key, text]) => element("option", { value: key, selected: key === value }, text)));

/** Card with a chart, its choices above and a text below. A subclass has `fetch` and `paint`. */
export class Look {
  constructor(title, id) {
    this.title = title;
    this.chart = element("div", { class: "chart", id, role: "img", "aria-label": `${title}: chart` });
    this.tools = element("div", { class: "row" });
    this.note = element("p", { class: "quiet" });
    this.element = element("section", { class: "card", "aria-label": title }, element("h2", {}, title), this.tools, this.chart, this.note);
  }

  /** Fetches the data for a new choice. */
  again() {
    this.fetch().catch((error) => showProblems(error, this.title));
  }

  /** Creates the buttons that save the chart. A subclass has `log`, `plant` and the shown `content`. */
  exports() {
    const name = () => fileName(this.log.name, this.plant.name, this.title, this.content);
    const title = () => `${this.title} of ${this.log.name}, plant ${this.plant.name}: ${this.content}`;
    return ["png", "svg"].map((format) => button(format.toUpperCase(), () => saveImage(this.chart, format, name(), title()).catch((error) => showProblems(error, format))));
  }
}
