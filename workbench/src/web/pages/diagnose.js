// Page "Diagnose": the missing physical effect, its size, and other explanations.

import * as api from "../api.js";
import { button, element, fill, scrolling, showProblems } from "../dom.js";
import { duration, number, unitText } from "../format.js";
import { nextLine } from "../next.js";
import { term } from "../terms.js";
import * as view from "../view.js";
import { Candidates } from "./diagnose/candidates.js";
import { Experiment } from "./diagnose/experiment.js";
import { Remaining } from "./diagnose/remaining.js";
import { errorSteps, rungsOf } from "./error-steps.js";
import { Roles } from "./roles.js";
import { Work } from "./work.js";

export const load = () => Promise.all([api.get("/project"), api.effects()]);

export function show(place, [project, effects]) {
  const logs = project.logs.filter((log) => !log.problem);
  if (logs.length === 0) {
    fill(place, element("p", {}, "There is no log to diagnose. ", button("Open one", () => view.go("logs"), { class: "primary" })));
    return {};
  }
  return new Page(place, project, logs, new Map(effects.map((effect) => [effect.id, effect])));
}

/** Short texts of the verdicts, and their marks. */
const VERDICTS = {
  adequate: ["good", "No effect missing"], found: ["good", "Effect found"],
  plant_file_wrong: ["open", "Plant file wrong"], form_wrong: ["open", "Partly explained"], not_in_library: ["bad", "Not in library"],
};

const PAGE_TITLES = { compare: "Compare", control: "Control", refine: "Refine", estimate: "Estimate" };

class Page {
  constructor(place, project, logs, effects) {
    Object.assign(this, { place, project, logs, effects, parts: [] });
    this.work = new Work("Diagnosis", "/diagnose");
    this.answer = element("div", { class: "stack" });
  }

  async begin() {
    delete document.body.dataset.diagnosed;
    const found = await api.get("/diagnosis");
    this.roles = new Roles(this.logs, found?.chosen);
    this.start = button("Diagnose", () => this.diagnose(), { class: "primary", id: "diagnose" });
    fill(this.place,
      element("section", { class: "bar row" },
        this.roles.element, element("span", {}, "compared with ", element("strong", {}, this.project.plant.name)),
        element("span", { class: "space" }), this.start),
      this.answer, this.next = element("div", {}));
    fill(this.next, nextLine("diagnose these logs.", "Diagnose", () => this.diagnose()));
    if (found) this.take(found);
    else fill(this.answer, element("section", { class: "card" },
      element("p", {}, "Adds each effect of the library, in each of its forms, to the plant and fits it with the ordinary parameters. Names the effects that explain the error on the validation data. Takes about 30 s per minute of log."),
      element("p", { class: "quiet" }, this.roles.words())));
    if (this.work.isRunning) this.follow(this.work.resume());
  }

  diagnose() {
    return this.follow(this.work.run("/diagnose", this.roles.chosen));
  }

  async follow(work) {
    this.start.hidden = this.next.hidden = true;
    const isDone = await work;
    this.start.hidden = this.next.hidden = false;
    if (!isDone) return;
    try {
      this.take(await api.get("/diagnosis"));
    } catch (refusal) {
      showProblems(refusal, "Diagnosis");
    }
  }

  leave() {
    this.work.leave();
    for (const part of this.parts) part.leave?.();
  }

  redraw() {
    for (const part of this.parts) part.redraw?.();
  }

  take(found) {
    for (const part of this.parts) part.leave?.();
    const { diagnosis } = found;
    const remaining = new Remaining(diagnosis.remaining);
    const experiment = new Experiment(diagnosis, this.effects);
    this.parts = [remaining, experiment];
    fill(this.answer,
      this.verdict(found),
      element("div", { class: "columns" },
        new Candidates(diagnosis, this.effects, (effect) => this.add(effect)).element,
        element("div", { class: "stack" },
          element("section", { class: "card" }, element("h2", {}, "How the error falls"),
            element("p", { class: "quiet" }, `Rms on ${diagnosis.held_out}, divided by the `, term("noise floor"), " (the line at 1)."),
            errorSteps(rungsOf(diagnosis.error_steps)), this.freeRun(diagnosis)),
          this.alternatives(found.alternatives), this.location(diagnosis))),
      remaining.element, experiment.element, this.nuisance(diagnosis));
    fill(this.next, this.nextStep(found));
    remaining.redraw();
    document.body.dataset.diagnosed = diagnosis.verdict;
  }

  /** Returns the line with the next step after a diagnosis. */
  nextStep({ diagnosis: { verdict, effects }, is_of_plant: isOfPlant, explains_plant: explainsPlant }) {
    const to = (words, page) => nextLine(words, PAGE_TITLES[page], () => view.go(page));
    if (!isOfPlant) return explainsPlant ? to("compare the refined plant with the logs.", "compare") : nextLine("diagnose the changed plant.", "Diagnose again", () => this.diagnose());
    if (effects.length > 0) return nextLine("add the effect to the plant.", `Add ${(this.effects.get(effects[0])?.title ?? effects[0]).toLowerCase()}`, () => this.add(effects[0]));
    if (verdict === "adequate") return to("close the loop on this plant.", "control");
    if (verdict === "plant_file_wrong") return to("estimate the ordinary parameters.", "estimate");
    return to("see where the error is.", "compare");
  }

  verdict({ diagnosis, plant, is_of_plant }) {
    const [mark, words] = VERDICTS[diagnosis.verdict];
    const { sentence, cost } = diagnosis;
    return element("section", { class: "card", id: "verdict", "aria-label": "Verdict" },
      element("div", { class: "row" }, element("span", { class: `chip ${mark}` }, words), element("span", { class: "space" }),
        element("a", { class: "button", href: api.address("/diagnosis/json"), download: "diagnosis.json", id: "diagnosis-json" }, "Diagnosis as JSON")),
      element("div", { class: "row" },
        element("p", { class: "sentence" }, `${sentence[0].toUpperCase()}${sentence.slice(1)}.`),
        is_of_plant && diagnosis.effects.map((id) => button(`Add ${(this.effects.get(id)?.title ?? id).toLowerCase()}`, () => this.add(id), { class: "primary add-named" }))),
      !is_of_plant && element("p", { class: "stale" }, element("span", { class: "chip open" }, "outdated"), ` This diagnosis is of ${plant}. The plant has changed since; diagnose again.`),
      Object.entries(diagnosis.not_compared).flatMap(([log, signals]) => signals.map((one) =>
        element("p", { class: "stale" }, element("span", { class: "chip open" }, "excluded from the fit"),
          ` ${one.name} of ${log}: ${one.reason}.`))),
      Object.entries(diagnosis.defects ?? {}).flatMap(([log, { sentences }]) => sentences.map((sentence) =>
        element("p", { class: "stale" }, element("span", { class: "chip open" }, "log"), ` ${log}: ${sentence}.`))),
      element("p", { class: "quiet" }, `Training: ${diagnosis.logs.join(", ")}. `
        + `Validation: ${diagnosis.check.length > 0 ? diagnosis.check.join(", ") : diagnosis.held_out}. ${cost.simulations} simulations of ${duration(cost.log_s)} in ${duration(cost.elapsed_s)}.`));
  }

  /** Returns the free-run errors, which Compare and Refine show, and the reason why they are larger. */
  freeRun({ error_steps: steps, horizon }) {
    const last = steps.at(-1);
    const times = Object.entries(last.free_run_check_rms).filter(([signal]) => last.noise_floor[signal])
      .map(([signal, rms]) => `${signal} ${number(rms / last.noise_floor[signal], 3)} × noise`);
    return element("p", { class: "quiet" }, horizon === "free_run"
      ? "These are free-run errors, as on Compare and Refine: the commands alone drive the model, and the errors of all pulses add up. One step ahead they are within the noise."
      : `These are one-step-ahead errors: the measured pressure corrects the model after each sample. In a free-run simulation, as on Compare and Refine, the errors of all pulses add up: ${times.join(", ")}.`);
  }

  alternatives(texts) {
    return texts.length > 0 && element("section", { class: "card" },
      element("h2", {}, "Alternative explanations"), texts.map((text) => element("p", {}, text)));
  }

  location(diagnosis) {
    const list = (regimes) => element("ul", { class: "plain" }, regimes.map((regime) => element("li", {},
      element("b", {}, regime.log), ` ${regime.signal}: ${regime.sentence}. `, this.toCompare(regime))));
    return element("section", { class: "card" }, element("h2", {}, "Where the ", term("excess error"), " is"),
      diagnosis.where.of_compare.map((sentence) => element("p", {}, `${sentence}.`)),
      element("h3", {}, "With the ordinary parameters refitted"), list(diagnosis.where.before),
      diagnosis.unexplained && diagnosis.effects.length > 0 && [element("h3", {}, "With the named effects"), list(diagnosis.where.after)]);
  }

  toCompare(regime) {
    const log = this.logs.find((one) => one.name === regime.log);
    if (!log || !regime.regime) return null;
    return button("Show in Compare", () => view.go("compare", { log: log.number }), { class: "link" });
  }

  nuisance({ nuisance }) {
    const alarms = nuisance.filter((value) => value.alarm);
    const rows = nuisance.map((value) => element("tr", { class: value.alarm ? "picked" : undefined },
      element("th", { scope: "row" }, value.name),
      [value.datasheet, value.tolerance, value.plain, value.fitted].map((one, index) => element("td", {}, `${index === 1 ? "± " : ""}${number(one)}`)),
      element("td", {}, `${number(value.low)} to ${number(value.high)}`), element("td", {}, unitText(value.unit))));
    return element("section", { class: "card" }, element("h2", {}, "Ordinary parameters"),
      element("p", { class: "quiet" }, "Refitted within the tolerance of the plant file, with every candidate. A value at its limit: wrong plant file or missing effect."),
      alarms.map((value) => element("p", {}, element("span", { class: "chip bad" }, value.name), ` ${value.alarm}`)),
      element("details", { open: alarms.length > 0 }, element("summary", {}, `${nuisance.length} parameters`),
        scrolling("Ordinary parameters", element("table", { class: "numbers" },
          element("thead", {}, element("tr", {}, [
            "parameter", "plant file", "tolerance", "without effects", "with effects", "95 % interval", "unit",
          ].map((cell) => element("th", { scope: "col" }, cell)))),
          element("tbody", {}, rows)))));
  }

  add(effect) {
    const { logs, check } = this.roles.chosen;
    view.go("refine", { add: effect, fit: logs.join(","), check: check.join(",") });
  }
}
