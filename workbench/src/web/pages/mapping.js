// Form that maps the columns of a log; the inspection of the log fills it.

import { button, element, fill, scrolling } from "../dom.js";
import { Filter } from "../filter.js";
import { titled } from "../format.js";

/** Codes of files that no mapping can repair. */
const BEYOND_MAPPING = /-(EMPTY|TRUNCATED)$/;

/** Returns whether a mapping can make a log readable. */
export const isMappable = (log) => !BEYOND_MAPPING.test(log.problem?.code ?? "");

/** Value of the choice of a signal that the model does not have. */
const OTHER = "other …";

/**
 * Creates the form for a log, filled from its inspection; false if there is nothing to map. `apply` gets its content and
 * returns the problems.
 */
export function mappingForm(log, preview, apply) {
  const { inspection } = preview;
  const dialect = inspection?.dialect;
  const isText = !inspection || Boolean(dialect);
  const columns = inspection?.columns ?? unknownColumns(preview.head.lines);
  if (columns.length === 0 || !isMappable(log)) return false;
  const header = element("input", { type: "checkbox", checked: dialect?.header ?? true });
  const skip = element("input", { type: "number", min: 0, value: dialect?.skip_lines ?? 0, class: "short" });
  const rows = columns.map((column) => new Row(isText ? column.number : column.key, column, preview, use(column, isText)));
  const units = element("datalist", { id: `units-${log.number}` }, preview.units.map((unit) => element("option", { value: unit })));
  for (const row of rows) row.unit.setAttribute("list", units.id);
  const { column, message } = log.problem ?? {};
  if (column) rows.find((row) => row.inspected.number === column)?.say(message);
  const filter = new Filter(isText ? "columns" : "channels");
  filter.take(rows.map((row) => ({ line: row.line, get text() { return `${row.heading} ${row.signal}`; } })));
  const toml = element("textarea", { rows: 8, spellcheck: false, value: preview.mapping ?? "", placeholder: "schema = 1" });
  const problems = element("span", { role: "alert" });
  const send = async (content) => { fill(problems, (await apply(content)).map((one) => element("p", { class: "problem" }, one.message))); };
  const stated = () => ({
    header: header.checked, skip_lines: Number(skip.value) || 0, delimiter: dialect?.delimiter ?? preview.head.delimiter,
    decimal: dialect?.decimal, units_row: dialect?.units_row, missing: inspection?.missing_words,
  });
  const sendRows = () => {
    const names = rows.map((row) => row.signal).filter(Boolean);
    const wrong = rows.filter((row) => !row.check(names));
    if (wrong.length > 0) wrong[0].role.focus();
    else send({ columns: rows.map((row) => row.value()).filter(Boolean), ...(isText ? stated() : {}) });
  };
  return element("details", { class: "mapping", open: Boolean(log.problem) },
    element("summary", {}, "Map columns"),
    element("p", { class: "quiet" }, "A column set to “from header” needs a header with name and unit, such as p_ch_bar_gauge. The unit of a pressure states gauge or absolute."),
    isText && element("p", { class: "row" },
      element("label", {}, header, " the first line has the column names"),
      element("label", {}, "lines to skip before it ", skip)),
    filter.element,
    scrolling("Columns of the log", element("table", { class: "form" },
      element("thead", {}, element("tr", {}, ["column", "use", "signal", "unit", "", "factor", "offset"]
        .map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {}, rows.map((row) => row.line)))),
    units,
    element("p", { class: "row" },
      button("Apply mapping", sendRows, { class: "primary apply-mapping" }),
      log.is_mapped && button("Remove mapping", () => send({ toml: "" })), problems),
    element("details", {},
      element("summary", {}, "Mapping as TOML (all options)"),
      element("p", {}, toml),
      element("p", {}, button("Apply TOML", () => send({ toml: toml.value })))));
}

/** Returns columns without a guess for a file that could not be inspected. */
function unknownColumns(lines) {
  const width = Math.max(...lines.map((line) => line.cells.length), 0);
  return Array.from({ length: width }, (_, index) => ({ number: index + 1, key: `${index + 1}`, unit_in_file: "", reason: "", is_by_header: true }));
}

/** Returns the use of an inspected column; a channel needs no line that ignores it. */
function use(column, isText) {
  if (column.is_by_header) return "by_header";
  if (!column.signal) return isText ? "ignore" : "by_header";
  return column.signal === "time" ? "time" : "signal";
}

/** Row of a column: its use, signal, unit, factor and offset, and what is wrong with them. */
class Row {
  constructor(column, inspected, preview, used) {
    Object.assign(this, { column, inspected, preview });
    const labelled = (label) => ({ "aria-label": `${label} of column ${column}` });
    const field = (label, properties) => element("input", { ...labelled(label), class: "short", ...properties });
    const option = (selected) => ([value, text]) => element("option", { value, selected: value === selected }, text);
    this.role = element("select", { ...labelled("use"), on: { change: () => this.enable() } },
      [["by_header", "from header"], ["time", "time"], ["signal", "signal"], ["ignore", "ignored"]].map(option(used)));
    const guess = used === "signal" ? inspected.signal : "";
    const known = preview.known.map(({ name }) => [name, name === titled(name) ? name : `${name}: ${titled(name).slice(0, -name.length - 1)}`]);
    const isKnown = guess === "" || known.some(([name]) => name === guess);
    this.choice = element("select", { ...labelled("signal"), class: "signal", on: { change: () => this.choose() } },
      [["", "choose …"], ...known, ...isKnown ? [] : [[guess, guess]], [OTHER, OTHER]].map(option(guess)));
    this.other = field("other name", { placeholder: "name" });
    this.unit = field("unit", { value: used === "by_header" ? "" : inspected.unit ?? this.unitInFile(), placeholder: "bar_gauge", class: "unit", on: { input: () => this.ask() } });
    this.scale = field("factor", { type: "number", step: "any", placeholder: "1", value: inspected.scale ?? "" });
    this.offset = field("offset", { type: "number", step: "any", placeholder: "0", value: inspected.offset ?? "" });
    this.note = element("span", { role: "alert" });
    this.heading = `${inspected.key}${inspected.unit_in_file ? ` [${inspected.unit_in_file}]` : ""}`;
    this.line = element("tr", {},
      element("th", { scope: "row", title: inspected.reason }, this.heading),
      [this.role, [this.choice, this.other], this.unit, this.note, this.scale, this.offset].map((control) => element("td", {}, control)));
    this.enable();
  }

  /** Returns the unit in the file if only its reference is missing. */
  unitInFile() {
    const unit = this.inspected.unit_in_file ?? "";
    return this.lacksReference(unit) ? unit : "";
  }

  /** Returns the name of the signal; empty if the column is none, or none is chosen. */
  get signal() {
    if (this.role.value !== "signal") return "";
    return this.choice.value === OTHER ? this.other.value.trim() : this.choice.value;
  }

  lacksReference(unit) {
    return ["gauge", "abs"].every((reference) => this.preview.units.includes(`${unit}_${reference}`));
  }

  enable() {
    const isSignal = this.role.value === "signal";
    this.choice.disabled = !isSignal;
    this.other.hidden = this.choice.value !== OTHER;
    this.unit.disabled = !isSignal && this.role.value !== "time";
    this.scale.disabled = this.offset.disabled = this.unit.disabled;
    this.ask();
  }

  choose() {
    const known = this.preview.known.find((one) => one.name === this.choice.value);
    if (known && !this.unit.value) this.unit.value = known.unit;
    this.enable();
  }

  /** Asks for the reference of a pressure that has none. */
  ask() {
    const unit = this.unit.value.trim();
    if (this.role.value !== "signal" || !this.lacksReference(unit)) { this.say(""); return; }
    const answer = (text, reference) => button(text, () => { this.unit.value = `${unit}_${reference}`; this.ask(); }, { class: "reference" });
    fill(this.note, answer("gauge", "gauge"), " ", answer("absolute", "abs"));
  }

  say(text) {
    fill(this.note, text && element("span", { class: "problem" }, text));
  }

  /** Checks the row among the `names` of all signals, and says what is wrong; returns whether nothing is. */
  check(names) {
    const role = this.role.value;
    const unit = this.unit.value.trim();
    if (role === "signal" && this.lacksReference(unit)) {
      this.ask();
      this.note.prepend(element("span", { class: "problem" }, "Gauge or absolute? "));
      return false;
    }
    const wrong = role === "signal" && this.signal === "" ? "Choose the signal."
      : role === "signal" && names.filter((name) => name === this.signal).length > 1 ? "Another column has this signal."
      : ["signal", "time"].includes(role) && unit === "" ? "Enter the unit."
      : "";
    this.say(wrong);
    return wrong === "";
  }

  /** Returns the content of the row; null if the header says everything. */
  value() {
    const { column, inspected } = this;
    const numberIn = (field) => field.value === "" ? null : Number(field.value);
    return this.role.value === "by_header" ? null : {
      column, role: this.role.value, name: this.signal, unit: this.unit.value.trim(),
      scale: numberIn(this.scale), offset: numberIn(this.offset),
      thousands_separator: inspected.thousands_separator, plausible: inspected.plausible, clip: inspected.clip,
    };
  }
}
