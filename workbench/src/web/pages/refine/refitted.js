// Ordinary parameters that a refit changed: a switch for each, with its values before and after.

import { element, fill, scrolling } from "../../dom.js";
import { number, unitText } from "../../format.js";

export class Refitted {
  /** `onChange` gets the change of a switch. */
  constructor(onChange) {
    this.onChange = onChange;
    this.element = element("div", { id: "refitted", hidden: true });
  }

  take(parameters) {
    this.element.hidden = parameters.length === 0;
    fill(this.element, element("h3", {}, "Refitted ordinary parameters"),
      element("p", { class: "quiet" }, "A parameter that is switched off has its value as opened."),
      scrolling("Refitted ordinary parameters", element("table", { class: "numbers dense" },
        element("thead", {}, element("tr", {}, ["parameter", "as opened", "refitted", "unit"].map((cell) => element("th", { scope: "col" }, cell)))),
        element("tbody", {}, parameters.map((parameter) => this.row(parameter))))));
  }

  row({ name, unit, about, before, after, is_refitted: isRefitted }) {
    const toggle = element("input", {
      type: "checkbox", role: "switch", checked: isRefitted, data: { refitted: name },
      on: { change: () => this.onChange({ ordinary: { name, is_refitted: toggle.checked } }) },
    });
    return element("tr", { title: about },
      element("th", { scope: "row" }, element("label", { class: "switch" }, toggle, ` ${name}`)),
      element("td", { class: isRefitted ? "unused" : undefined }, number(before)),
      element("td", { class: isRefitted ? undefined : "unused" }, number(after)),
      element("td", {}, unitText(unit)));
  }
}
