// Job of the server that a page waits for: a bar, the current stage, and a button that ends it.

import * as api from "../api.js";
import { button, element, fill, showMessage, showProblems } from "../dom.js";
import { percent } from "../format.js";

/** Key of the running job of this tab, for a page that is loaded again. */
const UNDER_WAY = "under-way";

/** Shows a message if the page was loaded again during a job, which ended with the page. */
export function showInterrupted() {
  const what = sessionStorage.getItem(UNDER_WAY);
  sessionStorage.removeItem(UNDER_WAY);
  if (what) showMessage(`${what} was cancelled because the page was reloaded. Start it again.`, "lasting");
}

export class Work {
  constructor(what) {
    this.what = what;
    this.element = element("div", { class: "row work", role: "status", hidden: true });
    this.ending = new AbortController();
  }

  /** Begins a job by a request, and follows it; returns whether it was completed. A cancelled job is not an error. */
  async run(path, request) {
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
      const begun = await api.post(path, request);
      await api.follow(begun.job, (share, stage) => {
        bar.value = share;
        const seconds = Math.round((performance.now() - begin) / 1000);
        words.textContent = `${stage ?? this.what}, ${percent(share)} – ${seconds} s elapsed`;
      }, AbortSignal.any([stop.signal, this.ending.signal]));
      return true;
    } catch (refusal) {
      // A closing page has the same status.
      isCutOff = refusal.status === 0;
      if (refusal.name !== "AbortError") showProblems(refusal, this.what);
      return false;
    } finally {
      if (!isCutOff && this.stop === stop) sessionStorage.removeItem(UNDER_WAY);
      if (this.stop === stop) this.element.hidden = true;
    }
  }

  /** Ends the job with the page. */
  leave() {
    if (!this.element.hidden) showMessage(`${this.what} was cancelled because its page was left.`, "lasting");
    this.ending.abort();
  }
}
