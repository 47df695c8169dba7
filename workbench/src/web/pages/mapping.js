// Form that maps the columns of a log; the inspection of the log fills it.

import { button, element } from "../dom.js";
import { Filter } from "../filter.js";

/** Creates the form for a log, filled from its inspection; `apply` gets its content. */
export function mappingForm(log, preview, apply) {
  const { inspection } = preview;
  const dialect = inspection?.dialect;
  const isText = !inspection || Boolean(dialect);
  const columns = inspection?.columns ?? unknownColumns(preview.head.lines);
  const header = element("input", { type: "checkbox", checked: dialect?.header ?? true });
  const skip = element("input", { type: "number", min: 0, value: dialect?.skip_lines ?? 0, class: "short" });
  const rows = columns.map((column, index) => columnRow(isText ? index + 1 : column.key, column, preview, use(column, isText)));
  const names = element("datalist", { id: `names-${log.number}` }, preview.known.map((known) => element("option", { value: known.name })));
  const units = element("datalist", { id: `units-${log.number}` }, preview.units.map((unit) => element("option", { value: unit })));
  for (const row of rows) {
    row.name.setAttribute("list", names.id);
    row.unit.setAttribute("list", units.id);
  }
  const filter = new Filter(isText ? "columns" : "channels");
  filter.take(rows.map(({ line, heading, name }) => ({ line, get text() { return `${heading} ${name.value}`; } })));
  const toml = element("textarea", { rows: 8, spellcheck: false, value: preview.mapping ?? "", placeholder: "schema = 1" });
  const stated = () => ({
    header: header.checked, skip_lines: Number(skip.value) || 0, delimiter: dialect?.delimiter ?? preview.head.delimiter,
    decimal: dialect?.decimal, units_row: dialect?.units_row, missing: inspection?.missing_words,
  });
  const send = () => apply({ columns: rows.map((row) => row.value()).filter(Boolean), ...(isText ? stated() : {}) });
  return element("details", { class: "mapping", open: Boolean(log.problem) && !preview.mapping },
    element("summary", {}, "Map columns"),
    element("p", { class: "quiet" }, "A column set to “from header” needs a header with name and unit, such as p_ch_bar_gauge. The unit of a pressure states gauge or absolute."),
    isText && element("p", { class: "row" },
      element("label", {}, header, " the first line has the column names"),
      element("label", {}, "lines to skip before it ", skip)),
    filter.element,
    element("div", { class: "scroll" }, element("table", { class: "form" },
      element("thead", {}, element("tr", {}, ["column", "use", "signal", "unit", "factor", "offset"]
        .map((cell) => element("th", { scope: "col" }, cell)))),
      element("tbody", {}, rows.map((row) => row.line)))),
    names, units,
    element("p", { class: "row" },
      button("Apply mapping", send, { class: "primary apply-mapping" }),
      log.is_mapped && button("Remove mapping", () => apply({ toml: "" }))),
    element("details", {},
      element("summary", {}, "Mapping as TOML (all options)"),
      element("p", {}, toml),
      element("p", {}, button("Apply TOML", () => apply({ toml: toml.value })))));
}

/** Returns columns without a guess for a file that could not be inspected. */
function unknownColumns(lines) {
  const width = Math.max(...lines.map((line) => line.cells.length), 0);
  return Array.from({ length: width }, (_, index) => ({ key: `${index + 1}`, unit_in_file: "", reason: "", is_by_header: true }));
}

/** Returns the use of an inspected column; a channel needs no line that ignores it. */
function use(column, isText) {
  if (column.is_by_header) return "by_header";
  if (!column.signal) return isText ? "ignore" : "by_header";
  return column.signal === "time" ? "time" : "signal";
}

function columnRow(column, inspected, preview, used) {
  const role = element("select", { "aria-label": `use of column ${column}` },
    [["by_header", "from header"], ["time", "time"], ["signal", "signal"], ["ignore", "ignored"]].map(([value, text]) => element("option", { value, selected: value === used }, text)));
  const field = (label, properties) => element("input", { "aria-label": `${label} of column ${column}`, class: "short", ...properties });
  const name = field("signal", { value: used === "signal" ? inspected.signal : "", placeholder: "p_ch" });
  const unit = field("unit", { value: used === "by_header" ? "" : inspected.unit ?? "", placeholder: "bar_gauge", class: "unit" });
  const scale = field("factor", { type: "number", step: "any", placeholder: "1", value: inspected.scale ?? "" });
  const offset = field("offset", { type: "number", step: "any", placeholder: "0", value: inspected.offset ?? "" });
  const enable = () => {
    const isSignal = role.value === "signal";
    name.disabled = !isSignal;
    unit.disabled = !isSignal && role.value !== "time";
    scale.disabled = offset.disabled = unit.disabled;
  };
  role.addEventListener("change", enable);
  name.addEventListener("change", () => {
    const known = preview.known.find((one) => one.name === name.value);
    if (known && !unit.value) unit.value = known.unit;
  });
  enable();
  const value = () => role.value === "by_header" ? null : {
    column, role: role.value, name: name.value.trim(), unit: unit.value.trim(),
    scale: scale.value === "" ? null : Number(scale.value), offset: offset.value === "" ? null : Number(offset.value),
    thousands_separator: inspected.thousands_separator, plausible: inspected.plausible,
  };
  const heading = `${inspected.key}${inspected.unit_in_file ? ` [${inspected.unit_in_file}]` : ""}`;
  const line = element("tr", {}, element("th", { scope: "row", title: inspected.reason }, heading, inspected.reason && element("span", { class: "unit" }, inspected.reason)), [role, name, unit, scale, offset].map((control) => element("td", {}, control)));
  return { line, heading, name, unit, value };
}
