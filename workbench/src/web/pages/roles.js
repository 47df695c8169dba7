// Training and validation logs: a choice that pages share, and that is part of the address.

import { element } from "../dom.js";
import * as view from "../view.js";

const numbers = (name) => (view.text(name) ?? "").split(",").filter(Boolean).map(Number);

/** A log with a name for validation is a validation log, if there is another one for training. */
function usual(logs) {
  const says = (log) => /check/i.test(log.name);
  const check = logs.some((log) => !says(log)) ? logs.filter(says) : [];
  return { logs: logs.filter((log) => !check.includes(log)).map((log) => log.number), check: check.map((log) => log.number) };
}

export class Roles {
  /** Creates the choice; `wish` is the previous one, if any. */
  constructor(logs, wish) {
    const there = new Set(logs.map((log) => log.number));
    const known = (list) => list.filter((number) => there.has(number));
    const address = { logs: known(numbers("fit")), check: known(numbers("check")) };
    const before = { logs: known(wish?.logs ?? []), check: known(wish?.check ?? []) };
    this.chosen = [address, before, usual(logs)].find((one) => one.logs.length > 0) ?? usual(logs);
    this.element = element("div", { class: "row choices", role: "group", "aria-label": "What the logs are for" }, logs.map((log) => this.row(log)));
  }

  row(log) {
    const role = () => this.chosen.logs.includes(log.number) ? "logs" : this.chosen.check.includes(log.number) ? "check" : "none";
    const choice = element("select", { data: { role: log.number }, on: { change: () => this.choose(log.number, choice.value) } },
      [["logs", "is fitted"], ["check", "judges"], ["none", "is left out"]].map(([value, text]) => element("option", { value, selected: value === role() }, text)));
    return element("label", { class: "choice" }, element("b", {}, log.name), " ", choice);
  }

  choose(number, role) {
    for (const list of ["logs", "check"]) this.chosen[list] = this.chosen[list].filter((one) => one !== number);
    if (role !== "none") this.chosen[role] = [...this.chosen[role], number].sort((a, b) => a - b);
    view.set({ fit: this.chosen.logs.join(","), check: this.chosen.check.join(",") });
  }

  /** Returns the validation data in words. */
  words() {
    return this.chosen.check.length > 0 ? "" : "No log judges: every third of twelve blocks of each log is held out for that.";
  }
}
