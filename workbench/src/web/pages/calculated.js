// Calculated channels of a log: name, unit, formula.

import { button, element, fill, scrolling } from "../dom.js";

export class CalculatedChannels {
  /** Creates the form. `apply` sends all channels and returns their problems. */
  constructor(apply) {
    Object.assign(this, { apply, rows: [] });
    this.units = element("datalist", { id: "units-of-channels" });
    this.body = element("tbody", {});
    this.problem = element("p", { class: "problem", role: "alert", id: "channel-problem" });
    this.table = scrolling("Calculated channels", element("table", { class: "form" },
      element("thead", {}, element("tr", {}, ["name", "unit", "formula", ""].map((cell) => element("th", { scope: "col" }, cell)))), this.body));
    this.element = element("section", { class: "card", "aria-labelledby": "calculated-title" },
      element("h2", { id: "calculated-title" }, "Calculated channels"),
      element("p", { class: "quiet" }, "A channel is added to each log that has the signals of its formula, in the units of the log. "
        + "A formula has numbers, names, + − * / ^ ( ), abs, sqrt, exp, ln, sin, cos, tanh, min and max. Put a name with spaces or signs in double quotes."),
      this.table, this.units, this.problem,
      element("p", { class: "row" },
        button("Add a channel", () => this.add({ name: "", unit: "", formula: "" }).name.focus(), { id: "add-channel" }),
        button("Calculate", () => this.send(), { class: "primary", id: "calculate" })));
  }

  /** Shows the channels of a project; the units of `signals` are proposed. */
  take(channels, signals) {
    fill(this.units, [...new Set(signals.map((signal) => signal.token))].map((unit) => element("option", { value: unit })));
    fill(this.body);
    fill(this.problem);
    this.rows = [];
    for (const channel of channels) this.add(channel);
    this.table.hidden = this.rows.length === 0;
  }

  add(channel) {
    const field = (key, properties) => element("input", { "aria-label": `${key} of a calculated channel`, data: { channel: key }, value: channel[key], spellcheck: false, ...properties });
    const row = { name: field("name", { class: "short", placeholder: "dp" }), unit: field("unit", { class: "short", placeholder: "bar_diff" }), formula: field("formula", { class: "formula", maxLength: 500, placeholder: "p_a - p_b" }) };
    row.unit.setAttribute("list", this.units.id);
    row.line = element("tr", {}, ["name", "unit", "formula"].map((key) => element("td", {}, row[key])),
      element("td", {}, button("×", () => this.remove(row), { "aria-label": "Remove the channel" })));
    this.rows.push(row);
    this.body.append(row.line);
    this.table.hidden = false;
    return row;
  }

  remove(row) {
    this.rows = this.rows.filter((one) => one !== row);
    row.line.remove();
    this.table.hidden = this.rows.length === 0;
  }

  async send() {
    const problems = await this.apply(this.rows.map(({ name, unit, formula }) => ({ name: name.value.trim(), unit: unit.value.trim(), formula: formula.value })));
    if (problems.length === 0) return;
    this.problem.textContent = problems.map((problem) => problem.message).join("\n");
    this.show(problems[0]);
  }

  /** Puts the caret at the error of a formula. */
  show({ line, column }) {
    const row = this.rows[line - 1];
    if (!row) return;
    const field = column ? row.formula : row.name;
    field.focus();
    if (column) field.setSelectionRange(column - 1, column);
  }
}
