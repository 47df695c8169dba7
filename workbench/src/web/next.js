// Last line of a page: the next step, with its button.

import { button, element } from "./dom.js";

/** Creates the line; `words` say what the step does, `act` begins it. */
export function nextLine(words, label, act) {
  return element("p", { class: "bar row next" }, element("span", {}, element("strong", {}, "Next: "), words), button(label, act, { class: "primary", id: "next-step" }));
}
