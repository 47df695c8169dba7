// Page "Report": the whole session as one HTML file, with a preview.

import * as api from "../api.js";
import { button, element, fill, showProblems } from "../dom.js";
import { percent } from "../format.js";
import { nextLine } from "../next.js";
import * as view from "../view.js";

export const load = () => api.get("/report");

export const show = (place, state) => new Page(place, state);

class Page {
  constructor(place, state) {
    this.ending = new AbortController();
    this.contents = element("ul", { class: "signals" });
    this.status = element("div", { class: "verdict", role: "status", id: "report-status" });
    this.writing = button("Write the report", () => this.write(), { class: "primary", id: "write-report", disabled: true });
    this.file = element("a", { class: "button", id: "download-report", download: "report.html", href: api.address("/report/file"), hidden: true }, "Download report.html");
    this.frame = element("div", { class: "paper", hidden: true });
    fill(place,
      element("section", { class: "card", "aria-label": "Contents of the report" },
        element("h2", {}, "Report of this session"),
        element("p", { class: "quiet" }, "One HTML file with figures and tables, for screen, print or e-mail. It needs no other file. ",
          element("code", {}, "retarder report"), " writes the same report on the command line."),
        this.contents,
        element("div", { class: "row" }, this.writing, this.file, this.status)),
      this.frame, this.next = element("div", {}));
    this.take(state);
    if (state.has_report) this.preview();
  }

  leave() {
    this.ending.abort();
  }

  take(state) {
    this.writing.disabled = state.logs === 0;
    this.writing.title = state.logs === 0 ? "There is no log to report on; open one on the page Logs and plant" : "";
    fill(this.next, this.nextStep(state));
    const some = (count, one, many) => count === 1 ? `1 ${one}` : `${count} ${many}`;
    const line = (isThere, text) => element("li", {}, element("span", { class: `chip ${isThere ? "good" : "open"}` }, text));
    fill(this.contents,
      line(state.logs > 0, `${some(state.logs, "log", "logs")}${state.unreadable > 0 ? `, ${state.unreadable} of them unreadable` : ""}`),
      line(state.compared > 0, state.compared === state.logs - state.unreadable ? `${some(state.compared, "comparison", "comparisons")} with the plant` : `${state.compared} of ${some(state.logs - state.unreadable, "log", "logs")} compared; the others are compared during writing`),
      line(state.has_diagnosis, state.has_diagnosis ? "a diagnosis" : "no diagnosis yet"),
      line(state.steps > 0, state.steps > 0 ? some(state.steps, "refinement step", "refinement steps") : "no refinement yet"),
      line(state.runs > 0, state.runs > 0 ? `closed-loop run on ${some(state.runs, "plant", "plants")}` : "no closed-loop run with this plant yet (page Control)"));
  }

  /** Returns the line with the next step. */
  nextStep({ logs, has_report: hasReport }) {
    if (logs === 0) return nextLine("open a log.", "Logs and plant", () => view.go("logs"));
    if (hasReport) return nextLine("keep the report.", "Download report.html", () => this.file.click());
    return nextLine("write the report.", "Write the report", () => this.write());
  }

  async write() {
    this.writing.hidden = this.next.hidden = true;
    const bar = element("progress", { max: 1, value: 0, "aria-label": "writing" });
    const share = element("span", { class: "quiet" });
    const stop = new AbortController();
    this.ending.signal.addEventListener("abort", () => stop.abort());
    try {
      const begun = await api.post("/report");
      fill(this.status, bar, share, button("Stop", () => stop.abort()));
      await api.follow(begun.job, (done) => { bar.value = done; share.textContent = percent(done); }, stop.signal);
      fill(this.status, element("span", { class: "chip good" }, "written"));
      this.take(await api.get("/report"));
      this.preview();
    } catch (refusal) {
      if (this.ending.signal.aborted) return;
      fill(this.status, element("span", { class: "chip open" }, "not written"));
      if (refusal.name !== "AbortError") showProblems(refusal, "Report");
    } finally {
      this.writing.hidden = this.next.hidden = false;
    }
  }

  /** Shows the report in a sandboxed frame, without scripts. */
  preview() {
    this.file.hidden = false;
    this.frame.hidden = false;
    const frame = element("iframe", { src: api.address("/report/preview"), title: "The report", id: "preview" });
    frame.setAttribute("sandbox", "");
    frame.addEventListener("load", () => { frame.dataset.loaded = "yes"; });
    fill(this.frame, frame);
  }
}
