// Opens the session, shows the page given in the address, and closes the session when the page closes.

import * as api from "./api.js";
import { element, fill, forgetProblems, showMessage } from "./dom.js";
import * as theme from "./theme.js";
import * as view from "./view.js";
import * as logs from "./pages/logs.js";
import * as compare from "./pages/compare.js";
import * as diagnose from "./pages/diagnose.js";
import * as refine from "./pages/refine.js";
import * as control from "./pages/control.js";
import * as report from "./pages/report.js";
import { showInterrupted } from "./pages/work.js";

/** Pages by name. A page has a title and `show(place)`, which returns its handlers `leave` and `redraw`. */
const PAGES = { logs, compare, diagnose, refine, control, report };
const KEY = "project";

const place = document.getElementById("page");
let shown = null;

function tabs() {
  fill(document.getElementById("tabs"), Object.entries(PAGES).map(([name, page]) => element("a", {
    href: `#/${name}?project=${view.text("project") ?? ""}`,
    "aria-current": name === view.page() ? "page" : undefined,
    on: { click: (event) => { event.preventDefault(); view.go(name); } },
  }, page.title)));
}

async function show() {
  try {
    await showPage();
  } catch (error) {
    showError(error);
  }
}

/** Shows an error in place of the page. */
function showError(error) {
  fill(place, element("p", { class: "message problem" }, String(error.message ?? error)));
}

async function showPage() {
  forgetProblems();
  const wanted = view.text("project");
  shown?.leave?.();
  if (wanted && wanted !== sessionStorage.getItem(KEY)) {
    api.close();
    await begin();
  }
  const page = Object.hasOwn(PAGES, view.page()) ? PAGES[view.page()] : logs;
  tabs();
  document.title = `${page.title} – Retarder workbench`;
  delete document.body.dataset.ready;
  fill(place);
  shown = await page.show(place);
}

async function begin() {
  const { session: project, is_copy: isCopy } = await api.open(view.text("project") ?? sessionStorage.getItem(KEY));
  sessionStorage.setItem(KEY, project);
  view.set({ project });
  if (isCopy) showMessage("This tab works on a copy of the project that was open last. Other tabs do not change.", "lasting");
}

document.getElementById("link").addEventListener("click", async () => {
  await navigator.clipboard.writeText(view.link());
  showMessage("Link copied. It works in a browser that has opened the address printed by `retarder serve`.");
});
theme.begin(document.getElementById("theme"), () => shown?.redraw?.());
addEventListener("pagehide", () => api.close());
addEventListener("pageshow", (event) => { if (event.persisted) location.reload(); });
view.begin(show);
try {
  await begin();
  showInterrupted();
  await showPage();
} catch (error) {
  showError(error);
}
