// Text field that filters a long list by words.

import { element } from "./dom.js";

/** Longest list that needs no filter. */
const GLANCE = 12;

export class Filter {
  /** Creates a field; `what` names the entries in words. */
  constructor(what) {
    this.entries = [];
    this.field = element("input", { type: "search", class: "filter", placeholder: `filter ${what}`, "aria-label": `filter ${what}`, on: { input: () => this.show() } });
    this.found = element("span", { class: "quiet", role: "status" });
    this.element = element("span", { class: "row", hidden: true }, this.field, this.found);
  }

  /** Sets the list: entries with `text`, which is searched, and `line`, which is shown or hidden. */
  take(entries) {
    this.entries = entries;
    this.element.hidden = entries.length <= GLANCE;
    this.show();
  }

  /** Returns the entries that contain every word of the field. */
  fitting() {
    const words = this.element.hidden ? [] : this.field.value.toLowerCase().split(/\s+/).filter(Boolean);
    return this.entries.filter(({ text }) => words.every((word) => text.toLowerCase().includes(word)));
  }

  show() {
    const fitting = new Set(this.fitting());
    for (const entry of this.entries) entry.line.hidden = !fitting.has(entry);
    this.found.textContent = fitting.size < this.entries.length ? `${fitting.size} of ${this.entries.length}` : "";
  }
}
