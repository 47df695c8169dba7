// Page "Control": closed loop on the plant, its requirements, and its robustness (Monte Carlo).

import * as api from "../api.js";
import { button, element, fill, showProblems } from "../dom.js";
import { BatchCard } from "./control/batch.js";
import { nextLine } from "../next.js";
import * as view from "../view.js";
import { RunPlots } from "./control/charts.js";
import { controllerForm } from "./control/controller.js";
import { profileForm } from "./control/profile.js";
import { requirements } from "./control/requirements.js";

export const load = () => api.get("/control");

export const show = (place, query) => new Page(place, query);

class Page {
  constructor(place, query) {
    this.query = query;
    this.ending = new AbortController();
    this.verdict = element("div", { class: "verdict", role: "status", id: "control-verdict" });
    this.plants = element("span", { class: "row" });
    this.scenario = element("select", { id: "scenario", on: { change: () => this.choose({ scenario: this.scenario.value, profile: null }).catch(() => {}) } });
    this.plots = new RunPlots();
    this.table = element("section", { class: "card", hidden: true, "aria-label": "Requirements" });
    this.batch = new BatchCard(this.ending.signal, (changes, runs) => this.choose(changes, runs));
    this.profile = element("section", { class: "card", "aria-label": "Reference profile" });
    this.controller = element("section", { class: "card", "aria-label": "Controller" });
    fill(place,
      element("section", { class: "bar row" }, element("label", {}, "Profile ", this.scenario), this.plants, this.verdict, element("span", { class: "space" }),
        button("Run again", () => this.run(), { id: "run", class: "primary" })),
      element("div", { class: "columns plots" },
        element("div", { class: "stack wide" }, this.plots.element, this.table, this.batch.element),
        element("aside", { class: "stack" }, this.profile, this.controller)),
      nextLine("write the report of this session.", "Report", () => view.go("report")));
    this.showQuery();
  }

  leave() {
    this.ending.abort();
    this.plots.leave();
    this.batch.leave();
  }

  redraw() {
    this.plots.redraw();
    this.batch.redraw();
  }

  async begin() {
    if (this.query.problems.length > 0) {
      fill(this.verdict, this.query.problems.map((problem) => element("span", { class: "problem" }, problem.message)));
      return false;
    }
    const before = this.query.has_result ? await api.get("/control/result") : null;
    if (before?.is_current) await this.take(before);
    else if (!await this.run()) return false;
    if (this.query.has_batch) await this.batch.take();
    return true;
  }

  /** Changes profile, seed or size of the batch; other values stay unchanged. */
  async choose(changes, runs = true) {
    const { scenario, profile, is_edited, seed, rigs } = this.query;
    const query = { scenario, profile: is_edited ? profile : null, seed, rigs, ...changes };
    await this.change(() => api.put("/control", query), "Profile", runs);
  }

  /**
   * Makes a change and runs the loop with it. Throws a refusal, so that a form can mark the field; with `what`, also
   * shows it above the page.
   */
  async change(act, what, runs = true) {
    try {
      this.query = await act();
    } catch (refusal) {
      if (what) showProblems(refusal, what);
      throw refusal;
    }
    this.showQuery();
    if (runs) await this.run();
  }

  showQuery() {
    const { query } = this;
    fill(this.scenario, query.scenarios.map((one) => element("option", { value: one.name, selected: one.name === query.scenario, title: one.about }, one.name)));
    fill(this.plants, "on ", query.plants.map((plant) => element("span", { class: `key run-${plant.role === "plain" ? "plain" : "refined"}`, title: plant.effects.join(", ") }, plant.name)));
    fill(this.profile, profileForm(query, (profile) => this.choose({ profile }),
      (file) => this.change(() => api.put("/control/reference", file), file.name)));
    fill(this.controller, controllerForm(query.controller, (settings) => this.change(() => api.put("/control/controller", settings), null)));
    this.batch.showQuery(query);
  }

  /** Runs the loop; returns whether it did. */
  async run() {
    document.body.dataset.ready = "running";
    const bar = element("progress", { max: 1, value: 0, "aria-label": "running the loop" });
    const stop = new AbortController();
    this.ending.signal.addEventListener("abort", () => stop.abort());
    fill(this.verdict, bar, button("Stop", () => stop.abort()));
    try {
      const begun = await api.post("/control/run");
      await api.follow(begun.job, (share) => { bar.value = share; }, stop.signal);
      await this.take(await api.get("/control/result"));
      return true;
    } catch (refusal) {
      if (this.ending.signal.aborted) return false;
      fill(this.verdict, element("span", { class: "chip open" }, "not run"));
      if (refusal.name !== "AbortError") showProblems(refusal, "Closed loop");
      document.body.dataset.ready = "failed";
      return false;
    }
  }

  async take(result) {
    fill(this.verdict, result.runs.map(({ plant, verdict }) => element("span", { class: `chip ${verdict.holds ? "good" : "bad"}` },
      `${plant.role === "plant" ? "" : `${plant.role}: `}${verdict.holds ? "pass, every binding requirement is met" : "fail"}`)));
    this.table.hidden = false;
    fill(this.table, requirements(result, (time) => this.plots.goToStep(time)));
    await this.plots.take(result);
    if (!this.ending.signal.aborted) document.body.dataset.ready = "control";
  }
}
