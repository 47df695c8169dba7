// Time offsets of the other logs relative to this one.

import * as api from "../../api.js";
import { button, element, showMessage, showProblems } from "../../dom.js";
import { number, signed } from "../../format.js";

/** Time offset of each other log: by number, by slider, by cross-correlation. */
export class Shifts {
  constructor(log, others, onShift) {
    Object.assign(this, { log, onShift, fields: new Map() });
    this.element = element("section", { class: "card" }, element("h2", {}, "Time offset of other logs"),
      element("p", { class: "quiet" }, "Select a log above the plots to overlay it. The offset applies to all its signals. Dragging in the plots with Ctrl changes it too."),
      element("div", { class: "scroll" }, element("table", {}, element("thead", {}, element("tr", {}, ["log", "offset", "drag", "by cross-correlation"].map((cell) => element("th", { scope: "col" }, cell)))), element("tbody", {}, others.map((other) => this.row(other))))));
  }

  row(other) {
    const reach = Math.max(1, 0.1 * this.log.summary.duration_s);
    const field = element("input", { type: "number", step: "any", class: "time", "aria-label": `offset of ${other.name}`, on: { change: () => this.apply(other, Number(field.value)) } });
    const slider = element("input", { type: "range", min: other.offset_s - reach, max: other.offset_s + reach, step: reach / 1000, "aria-label": `drag the offset of ${other.name}`, on: { input: () => this.apply(other, Number(slider.value)) } });
    this.fields.set(other, [field, slider]);
    this.show(other);
    const names = this.log.summary.signals.map((one) => one.name).filter((name) => other.summary.signals.some((one) => one.name === name));
    const signal = element("select", { "aria-label": "signal to align by" }, names.map((name) => element("option", { value: name, selected: name === "p_ch" }, name)));
    const note = element("span", { class: "quiet" });
    return element("tr", {}, element("th", { scope: "row" }, other.name), element("td", {}, field, " s"), element("td", {}, slider),
      element("td", {}, names.length > 0 && ["by ", signal, " ", button("Align", () => this.align(other, signal.value, note))], " ", note));
  }

  /** Shows the offset of a log. */
  show(other) {
    for (const field of this.fields.get(other) ?? []) field.value = String(+other.offset_s.toPrecision(8));
  }

  async apply(other, offset) {
    try {
      await api.put(`/logs/${other.number}/offset`, { offset_s: offset });
      other.offset_s = offset;
      this.show(other);
      this.onShift();
    } catch (refusal) {
      showProblems(refusal, other.name);
    }
  }

  async align(other, signal, note) {
    try {
      const found = await api.get(`/logs/${other.number}/alignment?${new URLSearchParams({ with: this.log.number, signal })}`);
      await this.apply(other, found.offset_s + this.log.offset_s);
      note.textContent = `${signed(found.offset_s, 4)} s, correlation ${number(found.correlation, 3)}`;
      if (found.correlation < 0.8) showMessage(`${other.name}: weak correlation of the two logs (${number(found.correlation, 3)}); check the offset.`);
    } catch (refusal) {
      showProblems(refusal, other.name);
    }
  }
}
