// Steps of the plant's history, on the pages that change it, and the keys that undo them.

import { element, fill } from "../dom.js";
import { number } from "../format.js";

/** Card with the steps; each has its errors on the log of the current one. */
export class StepList {
  constructor() {
    this.list = element("ol", { class: "steps", id: "steps", tabIndex: 0, "aria-label": "Steps" });
    this.element = element("section", { class: "card" }, element("h2", {}, "Steps"), this.list);
  }

  take({ steps, at }) {
    const { log } = steps[at];
    const errors = (step) => step.errors.filter((error) => error.rms !== null && error.noise_floor)
      .map((error) => ` ${error.signal} ${number(error.rms / error.noise_floor, 3)}×`).join(",");
    fill(this.list, steps.map((step, index) => element("li", { class: index > at ? "undone" : undefined, "aria-current": index === at ? "step" : undefined },
      step.done,
      // Errors on different logs cannot be compared.
      element("span", { class: "quiet" }, step.log === log ? errors(step) : step.log && ` simulated on ${step.log}`))));
    this.show(this.list.querySelector("[aria-current]"));
  }

  /** Scrolls the list, and not the page, to a step. */
  show(step) {
    const [inner, outer] = [step, this.list].map((one) => one.getBoundingClientRect());
    this.list.scrollTop += Math.max(0, inner.bottom - outer.bottom) + Math.min(0, inner.top - outer.top);
  }
}

/** Returns whether a key undoes or redoes a step: not in a field of text, which has its own history. */
export function isUndoKey({ target, ctrlKey, metaKey, key }) {
  const isText = target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && target.type !== "range" && target.type !== "checkbox");
  return !isText && (ctrlKey || metaKey) && key.toLowerCase() === "z";
}
