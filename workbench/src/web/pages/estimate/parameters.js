// Table of the parameters: value, unit, and what is known about each.

import { element, fill, scrolling } from "../../dom.js";
import { number, unitText } from "../../format.js";

const CHOICES = {
  opened: "as in the plant file", fixed: "fixed", tolerance: "within a tolerance", range: "within a range", unknown: "unknown",
};
const COLUMNS = ["parameter", "value", "unit", "known", "range of the estimation"];

/** Returns the words for a parameter: its meaning without equation and remarks, or its effect and key. */
function words(name, about) {
  const [section, ...path] = name.split(".");
  const key = path.pop();
  return section === "effects" ? `${path.join(" ").replaceAll("_", " ")}: ${key}` : about.split(/ \(|;/)[0];
}
/** Formats a number for a field, which is narrow: small numbers with an exponent. */
function text(value) {
  const short = +value.toPrecision(5);
  return short !== 0 && Math.abs(short) < 1e-3 ? short.toExponential() : String(short);
}

export class Parameters {
  /** `send` sends a change, and throws its refusal. */
  constructor(send) {
    Object.assign(this, { send, rows: new Map() });
    this.body = element("tbody", {});
    this.element = element("section", { class: "card", id: "parameters" },
      element("h2", {}, "What is known about each value"),
      element("p", { class: "quiet" },
        "State how well you know each value: a fit stays within these limits, here and on the command line. ",
        "The plant file carries the statements. A value without one may be as wrong as in a first plant file."),
      scrolling("Parameters",
        element("table", { class: "known-values" },
          element("thead", {}, element("tr", {}, COLUMNS.map((cell) => element("th", { scope: "col" }, cell)))), this.body)));
  }

  take(parameters) {
    const names = parameters.map((parameter) => parameter.name);
    // Rows that stay keep their focus.
    if (names.join() !== [...this.rows.keys()].join()) {
      this.rows = new Map(parameters.map((parameter) => [parameter.name, new Row(parameter, this.send)]));
      fill(this.body, [...this.rows.values()].map((row) => row.element));
    }
    for (const parameter of parameters) this.rows.get(parameter.name).take(parameter);
  }
}

class Row {
  constructor({ name, about, unit }, send) {
    Object.assign(this, { name, send });
    const title = words(name, about);
    const field = (label, data, act) => element("input", {
      type: "number", step: "any", class: "short", "aria-label": `${label} of ${title}`, data, on: { change: act },
    });
    this.value = field("Value", { value: name }, () => this.sendValue());
    this.choice = element("select", { "aria-label": `What is known of ${title}`, data: { known: name }, on: { change: () => this.choose() } },
      Object.entries(CHOICES).map(([value, label]) => element("option", { value }, label)));
    this.tolerance = field("Tolerance in percent", { tolerance: name }, () => this.state({ tolerance_pct: this.tolerance.valueAsNumber }));
    this.tolerance.min = 0;
    const sendRange = () => this.state({ range: [this.end(this.low, 0), this.end(this.high, 1)] });
    this.low = field("Least value", { low: name }, sendRange);
    this.high = field("Largest value", { high: name }, sendRange);
    this.percent = element("span", { class: "row" }, "±", this.tolerance, "%");
    this.range = element("span", { class: "row" }, this.low, "to", this.high);
    this.problem = element("p", { class: "problem", role: "alert", hidden: true });
    this.within = element("td", {});
    this.element = element("tr", { data: { parameter: name } },
      element("th", { scope: "row" }, element("abbr", { title: `${name}: ${about}`, tabIndex: 0 }, title)),
      element("td", {}, this.value), element("td", { class: "unit" }, unitText(unit)),
      element("td", {}, element("div", { class: "row" }, this.choice, this.percent, this.range), this.problem), this.within);
  }

  take(parameter) {
    this.parameter = parameter;
    const [low, high] = parameter.within;
    this.value.value = text(parameter.value);
    this.choice.value = parameter.known;
    this.tolerance.value = text(parameter.tolerance_pct ?? this.usualPercent());
    this.low.value = text(low);
    this.high.value = text(high);
    this.percent.hidden = parameter.known !== "tolerance";
    this.range.hidden = parameter.known !== "range";
    this.problem.hidden = true;
    this.within.textContent = low < high ? `${number(low, 3)} to ${number(high, 3)}` : "does not move";
  }

  /** Returns an end of the range: with all its digits unless it was typed. */
  end(field, index) {
    const known = this.parameter.within[index];
    return field.value === text(known) ? known : field.valueAsNumber;
  }

  /** Returns the tolerance (%) that the present range has, in few digits. */
  usualPercent() {
    const { value, within: [low, high] } = this.parameter;
    const percent = Math.max(high - value, value - low) / Math.abs(value) * 100;
    return Number.isFinite(percent) && percent > 0 && percent <= 100 ? +percent.toPrecision(2) : 10;
  }

  choose() {
    const { within: [low, high], value } = this.parameter;
    switch (this.choice.value) {
      case "tolerance": return this.state({ tolerance_pct: this.tolerance.valueAsNumber });
      case "range": return this.state({ range: low < high ? [low, high] : [0.9 * value, 1.1 * value].sort((a, b) => a - b) });
      default: return this.state(this.choice.value);
    }
  }

  state(known) {
    return this.try({ state: { name: this.name, known } });
  }

  sendValue() {
    return this.try({ value: { name: this.name, value: this.value.valueAsNumber } });
  }

  /** Sends a change; a refusal is shown beside the entry, which stays as typed. */
  async try(change) {
    try {
      await this.send(change);
    } catch (refusal) {
      this.problem.textContent = refusal.message;
      this.problem.hidden = refusal.isLost;
    }
  }
}
