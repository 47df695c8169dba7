// Panel with tabs; the selected one is a part of the view.

import { element } from "./dom.js";
import * as view from "./view.js";

export class SideTabs {
  /** Creates the panel; `parts` are `[key, title, content]`, and the first is shown if the view has none. */
  constructor(name, parts) {
    this.parts = parts.map(([key, text, content]) => ({
      key,
      tab: element("button", { type: "button", role: "tab", id: `tab-${key}`, "aria-controls": `panel-${key}`, on: { click: () => this.show(key), keydown: (event) => this.key(event) } }, text),
      panel: element("div", { class: "stack", role: "tabpanel", id: `panel-${key}`, "aria-labelledby": `tab-${key}` }, content),
    }));
    this.element = element("aside", { class: "card side" },
      element("div", { class: "side-tabs", role: "tablist", "aria-label": name }, this.parts.map((part) => part.tab)),
      this.parts.map((part) => part.panel));
    const [first] = this.parts;
    this.mark(this.parts.find((part) => part.key === view.text("side")) ?? first);
  }

  show(key) {
    view.set({ side: key });
    this.mark(this.parts.find((part) => part.key === key));
    // A chart that was hidden when it was drawn has no size yet.
    dispatchEvent(new Event("resize"));
  }

  mark(shown) {
    for (const part of this.parts) {
      const isShown = part === shown;
      part.panel.hidden = !isShown;
      part.tab.setAttribute("aria-selected", String(isShown));
      part.tab.tabIndex = isShown ? 0 : -1;
    }
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    const { length } = this.parts;
    const next = this.parts[(this.parts.findIndex((part) => part.tab === event.target) + step + length) % length];
    event.preventDefault();
    next.tab.focus();
    this.show(next.key);
  }
}
