// Time offsets of the other logs relative to this one.

import * as api from "../../api.js";
import { button, element, fill, scrolling, showProblems } from "../../dom.js";
import { number, signed } from "../../format.js";

/** Least correlation at which an alignment is applied; below it, the user decides. */
const CORRELATION_MIN = 0.8;

/** Time offset of each other log: by number, by slider, by cross-correlation. */
export class Shifts {
  constructor(log, others, onShift) {
    Object.assign(this, { log, onShift, fields: new Map(), wanted: new Map(), isSending: false });
    this.element = element("section", { class: "card" }, element("h2", {}, "Time offset of other logs"),
      element("p", { class: "quiet" }, "Select a log above the plots to overlay it. The offset applies to all its signals. Dragging in the plots with Ctrl changes it too."),
      scrolling("Time offsets", element("table", {}, element("thead", {}, element("tr", {}, ["log", "offset", "drag", "by cross-correlation"].map((cell) => element("th", { scope: "col" }, cell)))), element("tbody", {}, others.map((other) => this.row(other))))));
  }

  row(other) {
    const reach = Math.max(1, 0.1 * this.log.summary.duration_s);
    const note = element("span", { class: "quiet alignment", role: "status" });
    const apply = (offset) => { fill(note); this.apply(other, offset); };
    const field = element("input", { type: "number", step: "any", class: "time", "aria-label": `offset of ${other.name}`, on: { change: () => apply(Number(field.value)) } });
    const slider = element("input", { type: "range", step: "any", "aria-label": `drag the offset of ${other.name}`, on: { input: () => apply(Number(slider.value)) } });
    this.fields.set(other, { field, slider, reach });
    this.show(other);
    const names = this.log.summary.signals.map((one) => one.name).filter((name) => other.summary.signals.some((one) => one.name === name));
    const signal = element("select", { "aria-label": "signal to align by" }, names.map((name) => element("option", { value: name, selected: name === "p_ch" }, name)));
    return element("tr", {}, element("th", { scope: "row" }, other.name), element("td", {}, field, " s"), element("td", {}, slider),
      element("td", {}, names.length > 0 && ["by ", signal, " ", button("Align", () => this.align(other, signal.value, note))], " ", note));
  }

  /** Shows the offset of a log; a slider whose range ends before the offset is centred on it. */
  show(other) {
    const shown = this.fields.get(other);
    if (!shown) return;
    const { field, slider, reach } = shown;
    const offset = String(+other.offset_s.toPrecision(8));
    if (slider.min === "" || other.offset_s < Number(slider.min) || other.offset_s > Number(slider.max)) {
      Object.assign(slider, { min: other.offset_s - reach, max: other.offset_s + reach });
    }
    field.value = offset;
    slider.value = offset;
  }

  /** Applies an offset. While one is sent, only the latest of the others waits, so that a drag ends at its last one. */
  async apply(other, offset) {
    const before = other.offset_s;
    other.offset_s = offset;
    this.show(other);
    this.wanted.set(other, offset);
    if (this.isSending) return;
    this.isSending = true;
    while (this.wanted.size > 0) {
      const [[log, wanted]] = this.wanted;
      this.wanted.delete(log);
      try {
        await api.put(`/logs/${log.number}/offset`, { offset_s: wanted });
        this.onShift();
      } catch (refusal) {
        if (log === other && !this.wanted.has(log)) { log.offset_s = before; this.show(log); }
        showProblems(refusal, log.name);
      }
    }
    this.isSending = false;
  }

  /** Applies the best alignment, or proposes it if the correlation is weak: the logs may have nothing in common. */
  async align(other, signal, note) {
    try {
      const found = await api.get(`/logs/${other.number}/alignment?${new URLSearchParams({ with: this.log.number, signal })}`);
      const [offset, correlation] = [`${signed(found.offset_s, 4)} s`, number(found.correlation, 3)];
      const apply = () => this.apply(other, found.offset_s + this.log.offset_s);
      if (found.correlation >= CORRELATION_MIN) {
        fill(note, `${offset}, correlation ${correlation}`);
        await apply();
        return;
      }
      fill(note, `not applied: correlation ${correlation} (at least ${CORRELATION_MIN}). The logs may be unrelated. `,
        button(`Apply ${offset}`, () => { fill(note, `${offset}, correlation ${correlation}`); apply(); }, { class: "apply-weak" }));
    } catch (refusal) {
      showProblems(refusal, other.name);
    }
  }
}
