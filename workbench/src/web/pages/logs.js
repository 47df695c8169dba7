// Page "Logs and plant": opens files, maps columns, shows problems.

import * as api from "../api.js";
import { ask, button, element, fill, scrolling, showMessage, showProblems } from "../dom.js";
import { count, duration, number, ratesOf } from "../format.js";
import { nextLine } from "../next.js";
import { showSketch, sketchCard } from "../sketch.js";
import * as view from "../view.js";
import { CalculatedChannels } from "./calculated.js";
import { inspectionView } from "./inspection.js";
import { isMappable, mappingForm } from "./mapping.js";

export const load = () => Promise.all([api.get("/project"), api.examples()]);

export const show = (place, [project, examples]) => new Page(place, project, examples);

class Page {
  constructor(place, project, examples) {
    this.open = new Set();
    this.logs = element("div", { class: "stack" });
    this.sketch = sketchCard();
    this.plant = element("section", { class: "card", "aria-labelledby": "plant-title" });
    this.calculated = new CalculatedChannels((channels) => this.calculate(channels));
    this.examples = element("section", { class: "card", "aria-labelledby": "examples-title" });
    fill(place, element("div", { class: "columns" },
      element("div", { class: "stack wide" }, this.dropZone(), this.logs, this.sketch),
      element("div", { class: "stack" }, this.plant, this.calculated.element, this.examples)),
      this.next = element("div", {}));
    this.listExamples(examples);
    this.showProject(project);
  }

  showProject(project) {
    this.project = project;
    fill(this.logs,
      project.logs.length === 0 && element("p", { class: "quiet" }, "No log is open. Drop a log above, or open an example on the right."),
      project.logs.map((log) => this.logCard(log)));
    this.showPlant(project.plant);
    fill(this.next, this.nextStep(project.logs));
    this.calculated.take(project.calculated, project.logs.flatMap((log) => log.summary?.signals ?? []));
  }

  /** Returns the line with the next step. */
  nextStep(logs) {
    const log = logs.find((one) => !one.problem);
    if (log) return nextLine(`compare ${log.name} with the plant.`, "Compare", () => view.go("compare", { log: log.number }));
    if (logs.length === 0) return nextLine("open a log, or an example.", "Choose files …", () => document.getElementById("files").click());
    const unread = logs.find(isMappable);
    if (unread) return nextLine(`map the columns of ${unread.name}.`, "Show columns", () => document.querySelector(`[data-log="${unread.number}"]`).scrollIntoView());
    return nextLine("open a complete log.", "Choose files …", () => document.getElementById("files").click());
  }

  /** Adds these channels to every log; returns their problems. */
  async calculate(channels) {
    try {
      this.showProject(await api.put("/calculated", channels));
      return [];
    } catch (refusal) {
      return refusal.problems ?? [{ message: String(refusal) }];
    }
  }

  dropZone() {
    const input = element("input", { type: "file", multiple: true, id: "files", accept: ".csv,.tsv,.txt,.toml,.mf4,.dat,.parquet,.mat,.h5", on: { change: () => this.takeChosen(input) } });
    const zone = element("section", { class: "drop", id: "drop", "aria-label": "Open files" },
      element("p", {}, element("strong", {}, "Drop logs here"), " (one or several; CSV, MF4, Parquet or MATLAB) or a plant file (TOML)."),
      element("p", {}, element("label", { class: "button primary", for: "files" }, "Choose files …"), input),
      this.progress = element("p", { class: "quiet", role: "status" }));
    const over = (event) => { event.preventDefault(); zone.classList.add("over"); };
    zone.addEventListener("dragover", over);
    zone.addEventListener("dragenter", over);
    zone.addEventListener("dragleave", () => zone.classList.remove("over"));
    zone.addEventListener("drop", (event) => {
      event.preventDefault();
      zone.classList.remove("over");
      this.take([...event.dataTransfer.files]);
    });
    return zone;
  }

  /** A file that is selected again is read again, since it may have been corrected. */
  takeChosen(input) {
    const files = [...input.files];
    input.value = "";
    return this.take(files);
  }

  async take(files) {
    for (const file of files) {
      this.progress.textContent = `Reading ${file.name} …`;
      try {
        if (file.name.toLowerCase().endsWith(".toml")) {
          await this.takePlant(file);
        } else {
          const added = await api.upload(file);
          const log = added.project.logs.find((one) => one.number === added.log);
          if (log.problem) this.open.add(log.number);
          this.showProject(added.project);
        }
      } catch (refusal) {
        showProblems(refusal, file.name);
      }
    }
    this.progress.textContent = "";
  }

  async takePlant(file) {
    if (file.size > 1 << 20) {
      showMessage(`${file.name}: a plant file has at most 1 MiB. Check the file.`, "problem");
      return;
    }
    this.showProject(await api.put("/plant", { name: file.name, toml: await file.text() }));
    showMessage(`${file.name} is now the plant.`);
  }

  logCard(log) {
    const body = log.problem ? this.problem(log) : this.summary(log);
    const details = element("div", { class: "details", hidden: !this.open.has(log.number) });
    const toggle = button("Preview and columns", () => this.toggle(log, details, toggle), { "aria-expanded": String(!details.hidden) });
    const card = element("section", { class: `card log${log.problem ? " wrong" : ""}`, data: { log: log.number, name: log.name }, "aria-label": `Log ${log.name}` },
      element("header", { class: "row" },
        element("h2", {}, log.name),
        element("span", { class: "space" }),
        !log.problem && button("Compare with the plant", () => view.go("compare", { log: log.number }), { class: "primary compare" }),
        toggle,
        button("Remove", () => this.removeLog(log))),
      body, details);
    if (!details.hidden) this.fillDetails(log, details);
    return card;
  }

  problem(log) {
    const { code, message, line, column } = log.problem;
    const where = [line && `line ${line}`, column && `column ${column}`].filter(Boolean).join(", ");
    return element("div", { class: "problem" },
      element("p", {}, element("strong", {}, where ? `${where}: ` : ""), message),
      element("p", { class: "quiet" }, code, log.is_mapped && " – read with a mapping"),
      element("ul", { class: "plain others" }));
  }

  summary(log) {
    const { summary } = log;
    const rates = ratesOf(summary);
    const facts = [
      summary.start && `recorded ${summary.start}`, `${count(summary.samples)} samples`, duration(summary.duration_s),
      summary.sample_interval_s && `every ${duration(summary.sample_interval_s)}`,
      summary.gaps > 0 && `${summary.gaps} ${summary.gaps === 1 ? "gap" : "gaps"} in time`,
      summary.is_uneven && "uneven sampling", log.is_mapped && "with a mapping", log.is_compared && "compared",
    ];
    return element("div", {},
      element("p", { class: "facts" }, facts.filter(Boolean).join(" · ")),
      element("ul", { class: "signals" }, summary.signals.map((signal) => element("li", { class: "chip", title: `${signal.quantity}; ${number(signal.lowest)} to ${number(signal.highest)} ${signal.unit}` },
        element("b", {}, signal.name), ` ${signal.unit}`,
        rates.has(signal.name) && element("span", { class: "quiet" }, ` ${rates.get(signal.name)}`),
        signal.missing > 0 && element("em", {}, ` ${count(signal.missing)} missing`)))),
      summary.left_out.length > 0 && element("details", {}, element("summary", {}, `${summary.left_out.length} left out`),
        element("ul", { class: "plain" }, summary.left_out.map((one) => element("li", {}, element("b", {}, one.name), ` ${one.reason}`)))));
  }

  async toggle(log, details, toggle) {
    details.hidden = !details.hidden;
    toggle.setAttribute("aria-expanded", String(!details.hidden));
    if (details.hidden) this.open.delete(log.number);
    else {
      this.open.add(log.number);
      await this.fillDetails(log, details);
    }
  }

  /** Shows what is in the log; `reference` is that of pressures whose unit states none. */
  async fillDetails(log, details, reference) {
    try {
      const preview = await api.get(`/logs/${log.number}/preview${reference ? `?pressure=${reference}` : ""}`);
      const { inspection } = preview;
      if (reference && (inspection?.mapping_with_reference ?? inspection?.mapping)) {
        await this.adopt(log, { toml: inspection.mapping_with_reference ?? inspection.mapping });
        return;
      }
      const card = details.parentElement;
      if (log.problem && inspection && isUnderstood(inspection)) this.showUnderstood(card);
      if (inspection) showNeeded(card, log, inspection);
      fill(details,
        inspection && inspectionView(inspection, Boolean(log.problem), (answer) => this.fillDetails(log, details, answer), (toml) => this.adopt(log, { toml })),
        preview.around && [element("h3", {}, "Lines around the error"), rawTable(preview.around, log.problem)],
        preview.rows.length > 0 && [element("h3", {}, "First rows as signals"), valueTable(preview)],
        preview.head.lines.length > 0 && [element("h3", {}, "First lines (raw)"), rawTable(preview.head, log.problem)],
        mappingForm(log, preview, (form) => this.mapColumns(log, form)));
      if (log.summary?.sha256) details.append(element("p", { class: "quiet" }, `SHA-256 ${log.summary.sha256}`));
    } catch (refusal) {
      showProblems(refusal, log.name);
    }
  }

  /** Replaces the problem of a log whose columns are all recognised. */
  showUnderstood(card) {
    card.classList.remove("wrong");
    card.querySelector(":scope > .problem").replaceWith(element("p", { class: "understood" },
      "All columns are recognised. Check them, then use these signals."));
  }

  /** Applies a mapping that the inspection proposes. */
  async adopt(log, form) {
    for (const { message } of await this.mapColumns(log, form)) showMessage(`Mapping: ${message}`, "problem");
  }

  /** Applies a mapping; returns the problems of its content. */
  async mapColumns(log, form) {
    try {
      const project = await api.put(`/logs/${log.number}/mapping`, form);
      const after = project.logs.find((one) => one.number === log.number);
      if (!after.problem) { this.open.delete(log.number); showMessage(`Mapping applied to ${log.name}. It also applies to logs with the same header.`); }
      this.showProject(project);
      return [];
    } catch (refusal) {
      return refusal.problems ?? [{ message: String(refusal) }];
    }
  }

  async removeLog(log) {
    try {
      this.showProject(await api.remove(`/logs/${log.number}`));
    } catch (refusal) {
      showProblems(refusal, log.name);
    }
  }

  showPlant(plant) {
    const rows = plant.changed.map((parameter) => element("tr", { title: parameter.about },
      element("th", { scope: "row" }, parameter.name),
      element("td", {}, number(parameter.value)),
      element("td", {}, number(parameter.nominal)),
      element("td", {}, parameter.unit),
      element("td", { class: "known" }, parameter.known)));
    showSketch(this.sketch, plant.sketch);
    fill(this.plant,
      element("h2", { id: "plant-title" }, "Plant"),
      element("p", {}, element("strong", {}, plant.name), plant.is_nominal && " – the thesis model"),
      plant.problems.map((problem) => element("p", { class: "problem" }, problem.message)),
      rows.length > 0 && element("details", {},
        element("summary", {}, rows.length === 1 ? "1 parameter that differs from the thesis model or has a stated tolerance" : `${rows.length} parameters that differ from the thesis model or have a stated tolerance`),
        scrolling("Parameters of the plant", element("table", { class: "numbers" },
          element("thead", {}, element("tr", {}, ["parameter", "value", "thesis", "unit", "tolerance"].map((cell) => element("th", { scope: "col" }, cell)))), element("tbody", {}, rows)))),
      element("p", { class: "row" },
        element("a", { class: "button", href: api.address("/plant"), download: "plant.toml" }, "Download"),
        !plant.is_nominal && button("Reset to thesis model", async () => this.showProject(await api.put("/plant", { name: "" })))));
  }

  listExamples(examples) {
    const groups = Map.groupBy(examples, (example) => example.group);
    fill(this.examples,
      element("h2", { id: "examples-title" }, "Examples"),
      [...groups].map(([group, list]) => [
        element("h3", {}, group),
        element("ul", { class: group === "Practice rigs" ? "tiles" : "plain" }, list.map((example) => element("li", {},
          button(example.title, () => this.openExample(example), { class: "example", title: example.about, data: { example: example.id } }),
          group !== "Practice rigs" && element("span", { class: "quiet" }, ` ${example.about}`)))),
        group === "Practice rigs" && element("p", { class: "quiet" }, list[0].about),
      ]),
      element("p", { class: "row" }, button("Close everything", () => this.closeAll())));
  }

  async openExample(example) {
    const { length } = this.project.logs;
    const answer = length === 0 ? "replace" : await ask(`${length} ${length === 1 ? "log is" : "logs are"} open. Replace or keep?`, { replace: "Replace", keep: "Keep and add" });
    if (!answer) return;
    const keep = answer === "keep";
    try {
      this.showProject(await api.post(`/examples/${example.id}`, { keep }));
      showMessage(`${example.title} is open.`);
    } catch (refusal) {
      showProblems(refusal, example.title);
    }
  }

  async closeAll() {
    if (!await ask("Close all logs and the plant, and discard all results? This cannot be undone.", { close: "Close everything" })) return;
    this.open.clear();
    view.forget();
    this.showProject(await api.remove("/project"));
  }
}

/** Shows the needed signals on the card of a log, missing ones in red, and the problems that follow the first one. */
function showNeeded(card, log, { found, missing, problem, remarks, defects }) {
  card.querySelector(".needed")?.remove();
  const chip = (mark) => (name) => element("li", { class: `chip ${mark}`, title: mark === "bad" ? `${name}: required for a comparison of valves and chamber, not found` : undefined }, name);
  if (missing.length > 0) {
    card.querySelector(":scope > header").after(element("ul", { class: "needed", "aria-label": "Required signals" }, found.map(chip("good")), missing.map(chip("bad"))));
  }
  const others = card.querySelector(":scope > .problem .others");
  const more = [problem?.message, ...remarks, ...defects].filter((text) => text && !text.includes(log.problem?.message));
  if (others) fill(others, more.map((text) => element("li", {}, text)));
}

/** Returns whether an inspection proposes a mapping that reads the log, without a question to the user. */
const isUnderstood = ({ mapping, problem, open }) => Boolean(mapping) && !problem && open.length === 0;

function rawTable(text, problem) {
  return scrolling("First lines of the file", element("table", { class: "raw" }, element("tbody", {}, text.lines.map((line) => element("tr", { class: problem?.line === line.number ? "wrong" : undefined },
    element("th", { scope: "row" }, line.number),
    line.cells.map((cell, index) => element("td", { class: problem?.line === line.number && problem.column === index + 1 ? "wrong" : undefined }, cell)))))));
}

function valueTable(preview) {
  return scrolling("First rows as read", element("table", { class: "numbers" },
    element("thead", {}, element("tr", {}, preview.columns.map((column) => element("th", { scope: "col" }, column.name, element("span", { class: "unit" }, column.unit))))),
    element("tbody", {}, preview.rows.map((row) => element("tr", {}, row.map((value) => element("td", {}, value === null ? "" : String(value))))))));
}
