// Long jobs of the server: a diagnosis, a fit, a planned experiment. One runs at a time, also while other pages are
// shown and after the page was loaded again, until this tab closes. The bar below the header shows its progress on every
// page.

import * as api from "./api.js";
import { button, element, fill, showMessage, showProblems } from "./dom.js";
import { percent } from "./format.js";
import * as view from "./view.js";

/** Key of the running job of this tab, for a page that is loaded again. */
const UNDER_WAY = "under-way";

const bar = () => document.getElementById("jobs");

let running = null;
/** Whether the page is being closed. Its requests end before its event `pagehide`. */
let isLeft = false;
addEventListener("beforeunload", () => {
  isLeft = true;
  // A download begins with the same event.
  setTimeout(() => { isLeft = false; }, 1000);
});

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
  const job = {
    what, path, page: view.page(), since: Date.now(), number: async () => (await api.post(path, request)).job,
    watchers: 0, errors: [], onError: null,
  };
  running = job;
  job.ended = follow(job);
  return job;
}

/** Follows the job again that ran when this page was left to be loaded again. */
export function takeUp() {
  const kept = JSON.parse(sessionStorage.getItem(UNDER_WAY));
  // A copied tab has a project of its own, and no job.
  if (kept?.project !== view.text("project")) return;
  const job = { ...kept, number: async () => kept.number, isTakenUp: true, watchers: 0, errors: [], onError: null };
  running = job;
  job.ended = follow(job);
}

async function follow(job) {
  const stop = new AbortController();
  const progress = element("progress", { max: 1, value: 0, "aria-label": job.what });
  const words = element("span", {}, job.what);
  show(progress, words, button("Stop", () => stop.abort(), { class: "cancel" }));
  try {
    const { what, path, page, since } = job;
    const number = await job.number();
    sessionStorage.setItem(UNDER_WAY, JSON.stringify({ project: view.text("project"), what, path, page, since, number }));
    await api.follow(number, (share, stage, error) => {
      progress.value = share;
      const seconds = (Date.now() - since) / 1000;
      words.textContent = `${job.what}${stage ? `: ${stage}` : ""}, ${percent(share)}, ${Math.round(seconds)} s`;
      if (!error) return;
      job.errors.push({ seconds, ...error });
      job.onError?.();
    }, stop.signal);
    hide();
    if (job.watchers === 0) showEnd(job);
    return true;
  } catch (refusal) {
    hide();
    // A job that is gone has no events, as a server that is gone.
    if (refusal.status === 0 && job.isTakenUp && !isLeft) showMessage(`${job.what} was cancelled while the page was away. Start it again.`, "lasting");
    else if (refusal.name !== "AbortError") showProblems(refusal, job.what);
    return false;
  } finally {
    running = null;
    if (!isLeft) sessionStorage.removeItem(UNDER_WAY);
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
