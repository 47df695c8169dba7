// Heights of the rows of plots: together they fill the window. A drag of the line between two rows moves it.

import { element } from "../../dom.js";

/** Least height (px) of a row, and its least share of the height that it has with enough space. */
const LEAST = { height: 24, share: 0.3 };
/** Step (px) of a key. */
const STEP = 10;

/** Weight of each resized row, by its title; it stays while other pages are shown. */
const weights = new Map();

const leastOf = (panel) => Math.max(LEAST.height, LEAST.share * panel.height);

/** Returns heights (px) that share `available` px by weight; with too little space, every row has its least height. */
export function fitted(panels, available) {
  const weight = (panel) => weights.get(panel.title) ?? panel.height;
  const heights = new Map();
  // A row that would be lower than its least height takes that from the others.
  for (;;) {
    const free = panels.filter((panel) => !heights.has(panel));
    const rest = available - [...heights.values()].reduce((sum, height) => sum + height, 0);
    const sum = free.reduce((total, panel) => total + weight(panel), 0);
    const low = free.filter((panel) => rest * weight(panel) / sum < leastOf(panel));
    if (low.length === 0) {
      for (const panel of free) heights.set(panel, rest * weight(panel) / sum);
      return panels.map((panel) => heights.get(panel));
    }
    for (const panel of low) heights.set(panel, leastOf(panel));
  }
}

/** Lines between the rows of a stack of plots. */
export class Dividers {
  /** `onMove` draws the rows with their new heights. */
  constructor(onMove) {
    Object.assign(this, { onMove, panels: [], heights: [], isWaiting: false });
    this.element = element("div", { class: "dividers" });
  }

  /** Places the lines below rows of these heights; the first begins at `top`. */
  take(panels, heights, top, gap) {
    Object.assign(this, { panels, heights });
    const places = heights.slice(0, -1).map((_, index) => top + heights.slice(0, index + 1).reduce((sum, height) => sum + height, index * gap));
    // A line that is dragged stays the same element.
    while (this.element.children.length > places.length) this.element.lastChild.remove();
    while (this.element.children.length < places.length) this.element.append(this.line(this.element.children.length));
    places.forEach((place, index) => {
      const line = this.element.children[index];
      line.style.top = `${place}px`;
      line.setAttribute("aria-label", `Height of ${panels[index].title}`);
      line.setAttribute("aria-valuenow", String(Math.round(heights[index])));
    });
  }

  line(index) {
    let from = null;
    const end = () => { from = null; };
    return element("div", {
      class: "divider", role: "separator", tabIndex: 0, title: "Drag to change the heights, double-click to reset them",
      on: {
        pointerdown: (event) => { from = event.clientY; event.target.setPointerCapture?.(event.pointerId); event.preventDefault(); },
        pointermove: (event) => { if (from !== null && this.move(index, event.clientY - from)) from = event.clientY; },
        pointerup: end, pointercancel: end,
        dblclick: () => { weights.clear(); this.onMove(); },
        keydown: (event) => {
          const by = { ArrowUp: -STEP, ArrowDown: STEP }[event.key];
          if (!by) return;
          event.preventDefault();
          this.move(index, by);
        },
      },
    });
  }

  /** Moves the line below a row by some pixels; returns whether it moved. */
  move(index, by) {
    const { panels, heights } = this;
    const allowed = Math.max(leastOf(panels[index]) - heights[index], Math.min(by, heights[index + 1] - leastOf(panels[index + 1])));
    if (Math.round(allowed) === 0) return false;
    const moved = heights.with(index, heights[index] + allowed).with(index + 1, heights[index + 1] - allowed);
    panels.forEach((panel, row) => weights.set(panel.title, moved[row]));
    this.heights = moved;
    if (!this.isWaiting) {
      this.isWaiting = true;
      requestAnimationFrame(() => { this.isWaiting = false; this.onMove(); });
    }
    return true;
  }
}
