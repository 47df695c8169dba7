// Page "Estimate": what is known about each value, the estimation of the ordinary parameters, and its result.

import * as api from "../api.js";
import { button, element, fill, showProblems } from "../dom.js";
import { nextLine } from "../next.js";
import * as view from "../view.js";
import { isUndoKey, StepList } from "./steps.js";
import { Estimated } from "./estimate/estimation.js";
import { Experiment } from "./estimate/experiment.js";
import { LiveError } from "./estimate/live-error.js";
import { Parameters } from "./estimate/parameters.js";
import { Tables } from "./estimate/tables.js";
import { Roles } from "./roles.js";
import { Work } from "./work.js";

const RUN = "/estimate/run";

export const load = () => api.get("/project");

export function show(place, project) {
  const logs = project.logs.filter((log) => !log.problem);
  if (logs.length === 0) {
    fill(place, element("p", {}, "There is no log to estimate from. ", button("Open one", () => view.go("logs"), { class: "primary" })));
    return {};
  }
  return new Page(place, logs);
}

class Page {
  constructor(place, logs) {
    Object.assign(this, { place, logs, queue: Promise.resolve() });
    this.roles = new Roles(logs);
    this.work = new Work("Estimation", RUN);
    this.undo = button("Undo", () => this.change("undo"), { id: "undo", title: "Ctrl+Z" });
    this.redo = button("Redo", () => this.change("redo"), { id: "redo", title: "Ctrl+Shift+Z" });
    const about = "Estimate the parameters that are not fixed, and the effects that are on, from the training logs";
    this.start = button("Estimate", () => this.estimate(), { class: "primary", id: "estimate", title: about });
    this.plant = element("strong", { id: "plant-name" });
    this.live = new LiveError();
    this.parameters = new Parameters((change) => this.send(change));
    this.estimated = new Estimated();
    this.experiment = new Experiment(() => ({ log: this.log, ...this.roles.chosen }));
    this.tables = new Tables((change) => this.send(change));
    this.steps = new StepList();
    this.next = element("div", {});
    this.ending = new AbortController();
    addEventListener("keydown", (event) => this.key(event), { signal: this.ending.signal });
  }

  /** Returns the log whose errors are stored with a step: the first training log, if there is one. */
  get log() {
    return this.roles.chosen.logs[0] ?? this.logs[0].number;
  }

  async begin() {
    fill(this.place,
      element("section", { class: "bar row" },
        this.roles.element, element("span", {}, "plant ", this.plant), element("span", { class: "space" }),
        this.undo, this.redo,
        element("a", { class: "button", href: api.address("/refine/plant"), download: "refined.toml", id: "download-plant" }, "Download the plant"),
        this.start),
      this.live.element, this.parameters.element, this.estimated.element, this.experiment.element,
      element("div", { class: "columns" }, this.tables.element, this.steps.element),
      this.next);
    fill(this.next, nextLine("find the physical effect that the model lacks.", "Diagnose", () => view.go("diagnose")));
    try {
      const state = await this.state();
      if (this.ending.signal.aborted) return false;
      this.take(state);
    } catch (refusal) {
      showProblems(refusal, "Estimate");
      return false;
    }
    if (this.work.isRunning) this.follow(this.work.resume());
    this.experiment.resume();
    return true;
  }

  state() {
    return api.get(`/estimate?${new URLSearchParams({ log: this.log })}`);
  }

  leave() {
    this.ending.abort();
    for (const part of [this.work, this.live, this.estimated, this.experiment]) part.leave();
  }

  redraw() {
    for (const part of [this.live, this.estimated, this.experiment]) part.redraw();
  }

  key(event) {
    if (!isUndoKey(event)) return;
    event.preventDefault();
    const act = event.shiftKey ? this.redo : this.undo;
    if (!act.disabled) act.click();
  }

  /** Sends a change; changes are sent one after the other. Throws the refusal. */
  send(change) {
    const sent = this.queue.then(async () => this.take(await api.post("/estimate/change", { log: this.log, change })));
    this.queue = sent.catch(() => {});
    return sent;
  }

  change(change) {
    return this.send(change).catch((refusal) => showProblems(refusal, "Change"));
  }

  take(state) {
    this.plant.textContent = state.plant;
    this.undo.disabled = state.at === 0;
    this.redo.disabled = state.at + 1 === state.steps.length;
    this.parameters.take(state.parameters);
    this.tables.take(state.tables);
    this.steps.take(state);
    this.estimated.take(state.estimation);
    this.experiment.take(Boolean(state.estimation));
  }

  estimate() {
    return this.follow(this.work.run(RUN, { log: this.log, ...this.roles.chosen }));
  }

  async follow(work) {
    this.start.hidden = true;
    this.live.watch(this.work.job);
    const isDone = await work;
    this.live.watch(null);
    this.start.hidden = false;
    if (!isDone) return;
    try {
      this.take(await this.state());
      this.estimated.element.scrollIntoView({ block: "start" });
    } catch (refusal) {
      showProblems(refusal, "Estimation");
    }
  }
}
