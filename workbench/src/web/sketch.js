// Sketch of the plant, drawn by the server.

import { element, fill } from "./dom.js";

/** Returns a card for the sketch. */
export const sketchCard = () => element("section", { class: "card sketch", hidden: true });

/** Shows the sketch `svg` in its card; hides the card without one. */
export function showSketch(card, svg) {
  card.hidden = !svg;
  if (svg) fill(card, new DOMParser().parseFromString(svg, "text/html").querySelector("svg"));
}
