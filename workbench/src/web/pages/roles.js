// Choice of training and validation logs, shared by pages and stored in the address.

import { element } from "../dom.js";
import * as view from "../view.js";

const numbers = (name) => (view.text(name) ?? "").split(",").filter(Boolean).map(Number);

/** Returns the default: logs with `check` in their name validate, if another log is left for training. */
function usual(logs) {
  const says = (log) => /check/i.test(log.name);
  const check = logs.some((log) => !says(log)) ? logs.filter(says) : [];
  return { logs: logs.filter((log) => !check.includes(log)).map((log) => log.number), check: check.map((log) => log.number) };
}

export class Roles {
  /** Creates the choice; `previous` is the last one, if any. */
  constructor(logs, previous) {
    const there = new Set(logs.map((log) => log.number));
    const known = (list) => list.filter((number) => there.has(number));
    const address = { logs: known(numbers("fit")), check: known(numbers("check")) };
    const before = { logs: known(previous?.logs ?? []), check: known(previous?.check ?? []) };
    this.chosen = [address, before, usual(logs)].find((one) => one.logs.length > 0) ?? usual(logs);
    this.element = element("div", { class: "row choices", role: "group", "aria-label": "Use of the logs" }, logs.map((log) => this.row(log)));
  }

  row(log) {
    const role = () => this.chosen.logs.includes(log.number) ? "logs" : this.chosen.check.includes(log.number) ? "check" : "none";
    const choice = element("select", { data: { role: log.number }, on: { change: () => this.choose(log.number, choice.value) } },
      [["logs", "training"], ["check", "validation"], ["none", "excluded"]].map(([value, text]) => element("option", { value, selected: value === role() }, text)));
    return element("label", { class: "choice" }, element("b", {}, log.name), " ", choice);
  }

  choose(number, role) {
    for (const list of ["logs", "check"]) this.chosen[list] = this.chosen[list].filter((one) => one !== number);
    if (role !== "none") this.chosen[role] = [...this.chosen[role], number].sort((a, b) => a - b);
    view.set({ fit: this.chosen.logs.join(","), check: this.chosen.check.join(",") });
  }

  /** Returns a note about the validation data; empty if there is a validation log. */
  words() {
    if (this.chosen.check.length > 0) return "";
    return "No validation log: every third of twelve blocks of each training log is held out for validation.";
  }
}
