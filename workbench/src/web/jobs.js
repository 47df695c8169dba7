// Long jobs of the server: a diagnosis, a fit, a planned experiment. One runs at a time, also while other pages are
// shown, until this tab closes. The bar below the header shows its progress on every page.

import * as api from "./api.js";
import { button, element, fill, showMessage, showProblems } from "./dom.js";
import { percent } from "./format.js";
import * as view from "./view.js";

/** Key of the running job of this tab, for a page that is loaded again. */
const UNDER_WAY = "under-way";

const bar = () => document.getElementById("jobs");

let running = null;

/** Returns the running job if it was begun at one of the `paths`. */
export const runningAt = (paths) => running && paths.includes(running.path) ? running : null;

/**
 * Begins a job by a request; null if another one runs. `ended` of the job resolves to whether it was completed, and
 * `watchers` is the number of pages that show its result by themselves. `errors` lists the reported errors of the model,
 * each with its time since the begin (s); `onError` is called after each.
 */
export function begin(what, path, request) {
  if (running) {
    showMessage(`${running.what} is running. Wait for its end, or stop it.`);
    return null;
  }
  const job = { what, path, page: view.page(), watchers: 0, errors: [], onError: null };
  running = job;
  job.ended = follow(job, request);
  return job;
}

async function follow(job, request) {
  const stop = new AbortController();
  const progress = element("progress", { max: 1, value: 0, "aria-label": job.what });
  const words = element("span", {}, job.what);
  show(progress, words, button("Stop", () => stop.abort(), { class: "cancel" }));
  sessionStorage.setItem(UNDER_WAY, job.what);
  const begin = performance.now();
  let isCutOff = false;
  try {
    const begun = await api.post(job.path, request);
    await api.follow(begun.job, (share, stage, error) => {
      progress.value = share;
      const seconds = (performance.now() - begin) / 1000;
      words.textContent = `${job.what}${stage ? `: ${stage}` : ""}, ${percent(share)}, ${Math.round(seconds)} s`;
      if (!error) return;
      job.errors.push({ seconds, ...error });
      job.onError?.();
    }, stop.signal);
    hide();
    if (job.watchers === 0) showEnd(job);
    return true;
  } catch (refusal) {
    // A closing page has the same status.
    isCutOff = refusal.status === 0;
    hide();
    if (refusal.name !== "AbortError") showProblems(refusal, job.what);
    return false;
  } finally {
    running = null;
    if (!isCutOff) sessionStorage.removeItem(UNDER_WAY);
  }
}

function show(...parts) {
  fill(bar(), parts);
  bar().hidden = false;
}

function hide() {
  bar().hidden = true;
}

/** Says that a job has ended whose page is not shown. */
function showEnd({ what, page }) {
  show(element("span", {}, `${what}: complete.`),
    button("Show", () => { hide(); view.go(page); }, { class: "primary", id: "show-result" }),
    button("×", hide, { class: "close", "aria-label": "Close" }));
}

/** Shows a message if the tab was loaded again during a job, which ended with it. */
export function showInterrupted() {
  const what = sessionStorage.getItem(UNDER_WAY);
  sessionStorage.removeItem(UNDER_WAY);
  if (what) showMessage(`${what} was cancelled because the page was reloaded. Start it again.`, "lasting");
}
