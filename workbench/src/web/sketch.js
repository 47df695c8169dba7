// Sketch of the plant, drawn by the server.

import { element, fill } from "./dom.js";

/** Returns a card for the sketch. */
export const sketchCard = () => element("section", { class: "card sketch", hidden: true });

/** Shows the sketch in its card, in the colours of the theme; hides the card without one. */
export function showSketch(card, sketch) {
  card.hidden = !sketch;
  if (!sketch) return;
  fill(card, ["light", "dark"].map((theme) =>
    element("img", { class: `in-${theme}`, alt: sketch.text, src: `data:image/svg+xml,${encodeURIComponent(sketch[theme])}` })));
}
