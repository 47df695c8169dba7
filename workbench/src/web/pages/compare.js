// Page "Compare": a log and the model driven by its commands, on the same axes, and their differences.

import * as api from "../api.js";
import { button, element, fill, showProblems } from "../dom.js";
import { number, percent, signed, titled } from "../format.js";
import { nextLine } from "../next.js";
import { SideTabs } from "../side-tabs.js";
import { term } from "../terms.js";
import * as view from "../view.js";
import { closerLooks } from "./compare/closer.js";
import { Cursors } from "./compare/cursors.js";
import { limitsMenu } from "./compare/limits.js";
import { Regimes } from "./compare/regimes.js";
import { TimePlots } from "./compare/charts.js";

export const load = () => api.get("/project");

export function show(place, project) {
  const logs = project.logs.filter((log) => !log.problem);
  if (logs.length === 0) {
    fill(place, element("p", {}, "There is no log to compare yet. ", button("Open one", () => view.go("logs"), { class: "primary" })));
    return {};
  }
  const log = logs.find((one) => one.number === view.numberOf("log")) ?? logs[0];
  return new Page(place, project, logs, log);
}

/** Returns mark and words of the state of the model; `found` is the diagnosis, if there is one. */
function stateOf(verdict, found) {
  if (verdict.holds) return ["good", "within tolerance"];
  const lacking = found?.is_of_plant ? found.diagnosis.effects : [];
  if (found?.explains_plant && lacking.length > 0) return ["open", `explained by ${lacking.map((id) => id.replaceAll("_", " ")).join(" and ")}, which the plant lacks`];
  if (found?.explains_plant) return ["open", "explained, above the sensor's noise"];
  return verdict.failing.length > 0 ? ["bad", "unexplained"] : ["open", "undecided"];
}

class Page {
  constructor(place, project, logs, log) {
    Object.assign(this, { place, project, logs, log, comparison: null });
    view.set({ log: log.number });
    this.ending = new AbortController();
    this.verdict = element("div", { class: "verdict", role: "status", id: "verdict" });
    this.cursors = new Cursors(log, () => this.plots.mark());
    this.plots = new TimePlots(log, logs, project.plant, this.cursors, limitsMenu(log, project.strictness), {
      onView: () => this.looks?.refresh(), onShift: (moved) => this.looks?.showShift(moved), onCursor: () => this.side.show("values"),
    });
    this.regimes = new Regimes(() => this.plots.refresh());
    this.closer = element("div", { class: "stack" });
    const choice = element("select", { id: "log", on: { change: () => view.go("compare", { log: Number(choice.value) }) } },
      logs.map((one) => element("option", { value: one.number, selected: one === log }, one.name)));
    this.findings = element("section", { class: "findings" });
    this.side = new SideTabs("Figures of the comparison", [
      ["where", "Where the error is", [this.regimes.element, this.findings]],
      ["values", "Values", [this.cursors.element, this.plots.hint]],
      ["statistics", "Statistics", [element("h2", {}, "Residual within the visible range"), this.plots.metrics]],
    ]);
    fill(place,
      element("div", { class: "screen" },
        element("section", { class: "bar row" },
          element("label", {}, "Log ", choice),
          element("span", {}, "compared with ", element("strong", {}, project.plant.name)),
          this.verdict),
        element("div", { class: "workspace" }, this.plots.element, this.side.element)),
      this.plots.differences.metrics, this.closer, this.next = element("div", {}));
  }

  leave() {
    this.ending.abort();
    this.plots.leave();
    this.looks?.leave();
    this.regimes.leave();
  }

  redraw() {
    this.plots.redraw();
    this.regimes.redraw();
    this.looks?.redraw();
  }

  async begin() {
    try {
      await this.plots.refresh();
      if (!this.log.is_compared) await this.compare();
      await this.take();
      return true;
    } catch (refusal) {
      if (this.ending.signal.aborted) return false;
      fill(this.verdict, element("span", { class: "chip bad" }, "not compared"), button("Compare", () => this.begin(), { id: "compare-again" }));
      if (refusal.name !== "AbortError") showProblems(refusal, this.log.name);
      return false;
    }
  }

  async compare() {
    const bar = element("progress", { max: 1, value: 0, "aria-label": "comparing" });
    const share = element("span", { class: "quiet" }, "comparing …");
    const begun = await api.post(`/logs/${this.log.number}/compare`);
    const stop = new AbortController();
    fill(this.verdict, bar, share, button("Stop", () => stop.abort()));
    await api.follow(begun.job, (done) => { bar.value = done; share.textContent = `comparing, ${percent(done)}`; }, AbortSignal.any([stop.signal, this.ending.signal]));
    this.log.is_compared = true;
  }

  async take() {
    this.comparison = await api.get(`/logs/${this.log.number}/comparison`);
    const { verdict, signals } = this.comparison;
    const found = await api.get("/diagnosis");
    const isExplained = Boolean(found?.explains_plant);
    const word = stateOf(verdict, found);
    const failed = isExplained ? "open" : "bad";
    fill(this.verdict, element("span", { class: `chip ${word[0]}`, title: verdict.rule }, `Model: ${word[1]}`),
      signals.map((signal) => element("span", { class: `chip ${signal.holds === null ? "open" : signal.holds ? "good" : failed}`, title: signal.noise_floor.statement },
        `${signal.name} ${signal.free_run.rms_in_noise === null ? `${number(signal.free_run.rms, 3)} ${signal.unit}` : `${number(signal.free_run.rms_in_noise, 3)} × noise`}`)));
    this.showFindings(signals);
    fill(this.next, this.nextStep(verdict, found));
    this.regimes.take(this.log, this.comparison);
    this.looks = closerLooks(this.closer, this.log, this.logs, this.comparison, this.project, () => this.plots.refresh());
    await this.plots.refresh();
  }

  /** Returns the line with the next step. */
  nextStep(verdict, found) {
    if (!verdict.holds && !found?.explains_plant) return nextLine("find the physical effect that the model lacks.", "Diagnose", () => view.go("diagnose"));
    const [missing] = found?.is_of_plant ? found.diagnosis.effects : [];
    if (verdict.holds || !missing) return nextLine("close the loop on this plant.", "Control", () => view.go("control"));
    return nextLine("add the effect that explains the error.", `Add ${missing.replaceAll("_", " ")}`, () => view.go("refine", { add: missing }));
  }

  showFindings(signals) {
    fill(this.findings, element("h2", {}, "Signals"),
      signals.map((signal) => element("div", {},
        element("h3", {}, titled(signal.name)),
        element("p", {}, signal.finding.sentence),
        element("p", { class: "quiet" }, `rms ${number(signal.free_run.rms, 3)} ${signal.unit}, `, term("noise floor"), ` ${number(signal.noise_floor.value, 3)} ${signal.unit}, bias ${signed(signal.free_run.bias, 3)} ${signal.unit}, peak ${signed(signal.free_run.worst, 3)} ${signal.unit} at ${number(signal.free_run.worst_time_s, 5)} s. `,
          button("Show in plot", () => this.plots.goToMoment(signal.free_run.worst_time_s), { class: "link" })),
        signal.time_offset && element("p", { class: "quiet" }, signal.time_offset.statement))),
      [this.comparison.clock, this.comparison.start_gas].filter(Boolean).map(({ statement }) =>
        element("p", { class: "quiet" }, element("span", { class: "chip" }, "log"), ` ${statement}.`)),
      (this.comparison.defects?.sentences ?? []).map((sentence) => element("p", { class: "stale" }, element("span", { class: "chip open" }, "log"), ` ${sentence}.`)),
      this.comparison.not_compared.map((one) => element("p", { class: "quiet" }, element("b", {}, one.name), ` is not compared: ${one.reason}`)));
  }
}
