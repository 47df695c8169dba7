// Button with a pop-up, which stays within the window.

import { element } from "./dom.js";

/** Least distance (px) of a pop-up from the edges of the window and from the header. */
const EDGE = 8;

/** Places a pop-up below its button, or above it if there is more room; shifts it sideways into the window. */
function place(button, popup) {
  const { clientWidth, clientHeight } = document.documentElement;
  const at = button.getBoundingClientRect();
  const header = document.querySelector(".top").getBoundingClientRect();
  const [above, below] = [at.top - header.bottom - EDGE, clientHeight - at.bottom - EDGE];
  Object.assign(popup.style, { maxHeight: "", maxWidth: `${clientWidth - 2 * EDGE}px` });
  const isBelow = popup.scrollHeight <= below || below >= above;
  const left = Math.max(EDGE, Math.min(at.right, clientWidth - EDGE) - popup.offsetWidth);
  Object.assign(popup.style, {
    left: `${left - at.left}px`, top: isBelow ? "100%" : "auto", bottom: isBelow ? "auto" : "100%", maxHeight: `${Math.max(0, isBelow ? below : above)}px`,
  });
}

/** Creates a button that opens `popup`. */
export function menu(text, popup, properties = {}) {
  const click = (event) => {
    // A pop-up has its place as soon as it is visible; the event `toggle` comes later.
    event.preventDefault();
    made.open = !made.open;
    if (made.open) fit();
  };
  const button = element("summary", { on: { click } }, text);
  const fit = () => { if (popup.isConnected) place(button, popup); else sizes.disconnect(); };
  const sizes = new ResizeObserver(fit);
  const toggle = () => {
    sizes.disconnect();
    // The observer reports at once, and again whenever the window or the content changes.
    if (made.open) for (const one of [document.documentElement, popup]) sizes.observe(one);
  };
  const made = element("details", { class: "menu", on: { toggle }, ...properties }, button, popup);
  return made;
}
