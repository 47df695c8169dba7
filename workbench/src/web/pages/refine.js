// Page "Refine": effects are added, adjusted by hand or fitted, and every change can be undone.

import * as api from "../api.js";
import { button, element, fill, showProblems } from "../dom.js";
import { number } from "../format.js";
import { nextLine } from "../next.js";
import { showSketch, sketchCard } from "../sketch.js";
import { term } from "../terms.js";
import * as view from "../view.js";
import { errorSteps, rungsOf } from "./error-steps.js";
import { Effects } from "./refine/effects.js";
import { Plots } from "./refine/plots.js";
import { Refitted } from "./refine/refitted.js";
import { Roles } from "./roles.js";
import { isUndoKey, StepList } from "./steps.js";
import { Work } from "./work.js";

const FIT = "/refine/fit";

export const load = () => Promise.all([api.get("/project"), api.effects()]);

export function show(place, [project, effects]) {
  const logs = project.logs.filter((log) => !log.problem);
  if (logs.length === 0) {
    fill(place, element("p", {}, "There is no log to refine the plant with. ", button("Open one", () => view.go("logs"), { class: "primary" })));
    return {};
  }
  return new Page(place, project, logs, effects);
}

class Page {
  constructor(place, project, logs, effects) {
    Object.assign(this, { place, project, logs, state: null, queue: Promise.resolve(), moving: null, isMoving: false, asked: 0, drawn: 0 });
    this.library = new Map(effects.map((effect) => [effect.id, effect]));
    this.roles = new Roles(logs);
    this.log = logs.find((log) => log.number === view.numberOf("log")) ?? logs.find((log) => log.number === this.roles.chosen.logs[0]) ?? logs[0];
    view.set({ log: this.log.number });
    this.work = new Work("Fit", FIT);
    this.plots = new Plots(this.log, () => this.simulate());
    this.effects = new Effects(this.library, (change) => this.change(change), (moved) => this.move(moved));
    this.undo = button("Undo", () => this.change("undo"), { id: "undo", title: "Ctrl+Z" });
    this.redo = button("Redo", () => this.change("redo"), { id: "redo", title: "Ctrl+Shift+Z" });
    this.fitButton = button("Fit", () => this.fit(), { class: "primary", id: "fit", title: "Fit the effects that are on and the ordinary parameters, starting at the plant as opened, or as last stated or estimated" });
    this.plant = element("strong", { id: "plant-name" });
    this.sketch = sketchCard();
    this.cost = element("p", { class: "quiet", id: "cost", role: "status" });
    this.rungs = element("div", {});
    this.refitted = new Refitted((change) => this.change(change));
    this.fitted = element("section", { class: "card", hidden: true });
    this.steps = new StepList();
    this.ending = new AbortController();
    addEventListener("keydown", (event) => this.key(event), { signal: this.ending.signal });
  }

  async begin() {
    const choice = element("select", { id: "log", on: { change: () => view.go("refine", { log: Number(choice.value) }) } },
      this.logs.map((log) => element("option", { value: log.number, selected: log === this.log }, log.name)));
    fill(this.place,
      element("section", { class: "bar row" },
        element("label", {}, "Log ", choice), element("span", {}, "plant ", this.plant),
        element("span", { class: "space" }),
        this.undo, this.redo, this.fitButton,
        element("a", { class: "button", href: api.address("/refine/plant"), download: "refined.toml", id: "download-plant" }, "Download the plant"),
        button("Compare", () => view.go("compare", { log: this.log.number }), { id: "to-compare" })),
      element("div", { class: "columns plots" },
        element("div", { class: "stack" },
          element("section", { class: "card", id: "error-steps" },
            element("h2", {}, "How the error falls"),
            element("p", { class: "quiet" }, `Rms error on ${this.log.name}, divided by the `, term("noise floor"), ` (the line at 1). This is a free-run simulation, as on Compare: the errors of all pulses add up, so they can be larger than the one-step-ahead errors on Diagnose. Rows: the plant as opened, then with its ordinary parameters refitted, then with one more effect in each row. The refit is not credited to an effect.`),
            this.rungs, this.cost, this.refitted.element),
          this.sketch, this.plots.element, this.fitted),
        element("aside", { class: "stack" }, this.effects.element,
          element("section", { class: "card" }, element("h2", {}, "Training and validation logs"), this.roles.element),
          this.steps.element)),
      this.next = element("div", {}));
    try {
      const state = await api.get(`/refine?${new URLSearchParams({ log: this.log.number })}`);
      if (this.ending.signal.aborted) return false;
      this.take(state);
      const add = view.text("add");
      view.set({ add: null });
      if (add && !this.state.effects.some((effect) => effect.effect === add)) await this.change({ add: { effect: add } });
      else await this.simulate();
    } catch (refusal) {
      showProblems(refusal, "Refine");
      return false;
    }
    if (this.work.isRunning) this.follow(this.work.resume());
    return true;
  }

  leave() {
    this.ending.abort();
    this.work.leave();
    this.plots.leave();
  }

  redraw() {
    this.plots.redraw();
  }

  key(event) {
    if (!isUndoKey(event)) return;
    event.preventDefault();
    const act = event.shiftKey ? this.redo : this.undo;
    if (!act.disabled) act.click();
  }

  /** Changes the plant; changes are sent one after the other. */
  change(change) {
    this.moving = null;
    this.queue = this.queue.then(async () => {
      try {
        this.take(await api.post("/refine/change", { log: this.log.number, change }));
        this.plots.fadeToNext();
        await this.simulate();
      } catch (refusal) {
        showProblems(refusal, "Change");
        if (this.state) {
          this.effects.take(this.state.effects);
          this.refitted.take(this.state.refitted);
        }
      }
    });
    return this.queue;
  }

  take(state) {
    this.state = state;
    this.plant.textContent = state.plant;
    showSketch(this.sketch, state.sketch);
    this.undo.disabled = state.at === 0;
    this.redo.disabled = state.at + 1 === state.steps.length;
    this.fitButton.disabled = !state.effects.some((effect) => effect.is_on);
    this.effects.take(state.effects);
    this.refitted.take(state.refitted);
    this.steps.take(state);
    fill(this.next, state.at > 0 || state.effects.length > 0
      ? nextLine("compare the refined plant with the log.", "Compare", () => view.go("compare", { log: this.log.number }))
      : nextLine("find the physical effect that the model lacks.", "Diagnose", () => view.go("diagnose")));
    this.fitted.hidden = !state.fit;
    if (state.fit) {
      fill(this.fitted, element("h2", {}, "Last fit"),
        element("p", {}, `${state.fit.sentence[0].toUpperCase()}${state.fit.sentence.slice(1)}.`),
        element("p", { class: "quiet" }, `All parameters refitted for each row. Validation on ${state.fit.held_out}: one-step-ahead errors, as on Diagnose.`),
        errorSteps(rungsOf(state.fit.error_steps)));
    }
  }

  /** Simulates while a slider moves: the latest position as soon as the previous one is drawn. */
  async move(moved) {
    this.moving = moved;
    if (this.isMoving) return;
    this.isMoving = true;
    while (this.moving) {
      const now = this.moving;
      this.moving = null;
      await this.simulate(now);
    }
    this.isMoving = false;
  }

  async simulate(moved) {
    const begin = performance.now();
    const turn = ++this.asked;
    try {
      const query = new URLSearchParams({ log: this.log.number, ...this.plots.query(), ...moved });
      const run = await api.get(`/refine/simulation?${query}`, this.ending.signal);
      if (turn < this.drawn) return;
      this.drawn = turn;
      this.showErrorSteps(run.error_steps);
      await this.plots.take(run.signals);
      this.cost.textContent = `${number(run.log_s, 3)} s of log simulated in ${number(run.simulation_ms, 3)} ms, displayed after ${number(performance.now() - begin, 3)} ms.`;
      Object.assign(this.cost.dataset, { simulation: run.simulation_ms, screen: performance.now() - begin });
    } catch (refusal) {
      if (refusal.name !== "AbortError") showProblems(refusal, "Simulation");
    }
  }

  /** Moves the bars from their previous lengths; the bars of a new row start at the errors of the plant as opened. */
  showErrorSteps(rungs) {
    const before = [...this.rungs.querySelectorAll(".rung")].map(widths);
    fill(this.rungs, errorSteps(rungs));
    [...this.rungs.querySelectorAll(".rung")].forEach((rung, index) => {
      const from = before[index] ?? before[0] ?? [];
      rung.querySelectorAll(".fill").forEach((bar, signal) => {
        const to = bar.style.width;
        bar.style.width = from[signal] ?? to;
        requestAnimationFrame(() => { bar.style.width = to; });
      });
    });
  }

  fit() {
    return this.follow(this.work.run(FIT, { log: this.log.number, ...this.roles.chosen }));
  }

  async follow(work) {
    this.fitButton.hidden = true;
    const isDone = await work;
    this.fitButton.hidden = false;
    if (!isDone) return;
    try {
      this.take(await api.get(`/refine?${new URLSearchParams({ log: this.log.number })}`));
      this.plots.fadeToNext();
      await this.simulate();
    } catch (refusal) {
      showProblems(refusal, "Fit");
    }
  }
}

const widths = (rung) => [...rung.querySelectorAll(".fill")].map((bar) => bar.style.width);
