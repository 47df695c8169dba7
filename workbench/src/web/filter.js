// A field that leaves of a long list what has its words.

import { element } from "./dom.js";

/** So many entries are seen at a glance. */
const GLANCE = 12;

export class Filter {
  /** `what` says in words what the entries are. */
  constructor(what) {
    this.entries = [];
    this.field = element("input", { type: "search", class: "filter", placeholder: `filter ${what}`, "aria-label": `filter ${what}`, on: { input: () => this.show() } });
    this.found = element("span", { class: "quiet", role: "status" });
    this.element = element("span", { class: "row", hidden: true }, this.field, this.found);
  }

  /** The list: entries of `text`, in which words are looked for, and `line`, which is shown or hidden. */
  take(entries) {
    this.entries = entries;
    this.element.hidden = entries.length <= GLANCE;
    this.show();
  }

  /** Entries that have every word of the field. */
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
