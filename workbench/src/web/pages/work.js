// Work of the server that a page waits for: a bar, what is done just now, and a button that ends it.

import * as api from "../api.js";
import { button, element, fill, tell, tellProblems } from "../dom.js";
import { percent } from "../format.js";

/** What is under way in this tab, as a page that is loaded again finds it. */
const UNDER_WAY = "under-way";

/** Says so if a page that was loaded again had work under way, which ended with it. */
export function tellInterrupted() {
  const what = sessionStorage.getItem(UNDER_WAY);
  sessionStorage.removeItem(UNDER_WAY);
  if (what) tell(`${what} ended when the page was loaded again. Begin it anew.`, "lasting");
}

export class Work {
  constructor(what) {
    this.what = what;
    this.element = element("div", { class: "row work", role: "status", hidden: true });
    this.ending = new AbortController();
  }

  /** Begins work by a request, and follows it; whether it came to its end. A cancelled one is no error. */
  async run(path, wish) {
    this.stop?.abort();
    const stop = this.stop = new AbortController();
    const bar = element("progress", { max: 1, value: 0, "aria-label": this.what });
    const words = element("span", { class: "quiet" }, `${this.what} …`);
    const begin = performance.now();
    fill(this.element, bar, words, button("Cancel", () => stop.abort(), { class: "cancel" }));
    this.element.hidden = false;
    sessionStorage.setItem(UNDER_WAY, this.what);
    let isCutOff = false;
    try {
      const begun = await api.post(path, wish);
      await api.follow(begun.job, (share, stage) => {
        bar.value = share;
        const seconds = Math.round((performance.now() - begin) / 1000);
        words.textContent = `${stage ?? this.what}, ${percent(share)} – ${seconds} s so far`;
      }, AbortSignal.any([stop.signal, this.ending.signal]));
      return true;
    } catch (refusal) {
      // So it is for a page that goes, too.
      isCutOff = refusal.status === 0;
      if (refusal.name !== "AbortError") tellProblems(refusal, this.what);
      return false;
    } finally {
      if (!isCutOff && this.stop === stop) sessionStorage.removeItem(UNDER_WAY);
      if (this.stop === stop) this.element.hidden = true;
    }
  }

  /** The page goes: so does the work. */
  leave() {
    if (!this.element.hidden) tell(`${this.what} ended when its page was left.`, "lasting");
    this.ending.abort();
  }
}
