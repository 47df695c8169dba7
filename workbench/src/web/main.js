// Opens the session, shows the page given in the address, and leaves the session when the page closes.

import * as api from "./api.js";
import * as connection from "./connection.js";
import { element, fill, forgetProblems, showMessage } from "./dom.js";
import { takeUp } from "./jobs.js";
import * as theme from "./theme.js";
import * as view from "./view.js";

/** Titles of the pages by name, in the order of the work. */
const PAGES = {
  logs: "Logs and plant", compare: "Compare", estimate: "Estimate", diagnose: "Diagnose", refine: "Refine", control: "Control", report: "Report",
};
const KEY = "project";

const place = document.getElementById("page");
let shown = null;
/** Number of pages shown so far: what an earlier one has requested is not shown any more. */
let turns = 0;

function tabs() {
  fill(document.getElementById("tabs"), Object.entries(PAGES).map(([name, title]) => element("a", {
    href: `#/${name}?project=${view.text("project") ?? ""}`,
    "aria-current": name === view.page() ? "page" : undefined,
    on: { click: (event) => { event.preventDefault(); view.go(name); } },
  }, title)));
}

/** Number of failed loads of each page: a browser never requests a module that failed again, except by another address. */
const failures = new Map();

/**
 * Loads the module of a page when it is first shown, so that the first page comes sooner. A page has `load`, which
 * requests its data, and `show(place, data)`, which returns its handlers `begin`, `leave` and `redraw`. `begin` does the
 * rest; it returns false if it failed.
 */
async function moduleOf(name) {
  const failed = failures.get(name) ?? 0;
  try {
    return await import(`./pages/${name}.js${failed > 0 ? `?try=${failed}` : ""}`);
  } catch (error) {
    failures.set(name, failed + 1);
    // A browser says no more about a module that it did not get.
    throw await api.presence() === "there" ? error : api.noAnswer();
  }
}

async function show() {
  const turn = ++turns;
  try {
    await showPage(() => turn === turns);
  } catch (error) {
    if (turn === turns) showError(error);
  }
}

/** Shows an error in place of the page. */
function showError(error) {
  fill(place, element("p", { class: "message problem" }, String(error.message ?? error)));
}

async function showPage(isCurrent) {
  forgetProblems();
  const wanted = view.text("project");
  shown?.leave?.();
  shown = null;
  delete document.body.dataset.ready;
  if (wanted && wanted !== sessionStorage.getItem(KEY)) {
    api.close();
    await begin();
  }
  const name = Object.hasOwn(PAGES, view.page()) ? view.page() : "logs";
  tabs();
  document.title = `${PAGES[name]} – Retarder workbench`;
  // Each has a place of its own: what a page that was left still fills is not seen.
  const own = element("div", { class: "page" });
  fill(place, own);
  const page = await moduleOf(name);
  const data = await page.load();
  if (!isCurrent()) return;
  shown = page.show(own, data);
  const isReady = await shown.begin?.();
  if (isCurrent()) document.body.dataset.ready = isReady === false ? "failed" : name;
}

async function begin() {
  view.forget();
  const { session: project, is_copy: isCopy } = await api.open(view.text("project") ?? sessionStorage.getItem(KEY));
  sessionStorage.setItem(KEY, project);
  view.set({ project });
  if (isCopy) showMessage("This tab works on a copy of the project that was open last. Other tabs do not change.", "lasting");
}

/** Opens the project again, and shows the same view, after the server was started again. */
async function restore() {
  try {
    await begin();
  } catch (error) {
    showError(error);
    return;
  }
  await show();
}

document.getElementById("link").addEventListener("click", async () => {
  await navigator.clipboard.writeText(view.link());
  showMessage("Link copied. It works in a browser that has opened the address printed by `retarder serve`.");
});
// Pages that fill the window need the height of the header, which grows by a notice.
const header = document.querySelector(".top");
new ResizeObserver(() => document.documentElement.style.setProperty("--header", `${header.offsetHeight}px`)).observe(header);
theme.begin(document.getElementById("theme"), () => shown?.redraw?.());
addEventListener("pagehide", () => api.leave());
addEventListener("pageshow", (event) => { if (event.persisted) location.reload(); });
view.begin(show);
try {
  await begin();
  connection.watch(restore);
  takeUp();
  await show();
} catch (error) {
  showError(error);
}
