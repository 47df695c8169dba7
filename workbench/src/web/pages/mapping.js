// Mapping of the columns of a log whose header does not describe them.

import { button, element } from "../dom.js";
import { Filter } from "../filter.js";

/** Creates the form for a log; `apply` gets its content. */
export function mappingForm(log, preview, apply) {
  const isText = preview.channels.length === 0;
  const width = Math.max(...preview.head.lines.map((line) => line.cells.length), 0);
  const first = preview.head.lines[0]?.cells ?? [];
  const hasHeader = first.some((cell) => /[a-z]/i.test(cell));
  const header = element("input", { type: "checkbox", checked: hasHeader });
  const skip = element("input", { type: "number", min: 0, value: 0, class: "short" });
  const rows = isText
    ? Array.from({ length: width }, (_, index) => columnRow(index + 1, `${index + 1}${hasHeader ? ` ${first[index] ?? ""}` : ""}`, hasHeader ? guess(first[index] ?? "") : OPEN, preview))
    : preview.channels.map((channel) => columnRow(channel.key, `${channel.key} [${channel.unit}]`, OPEN, preview, channel.obstacle));
  const names = element("datalist", { id: `names-${log.number}` }, preview.known.map((known) => element("option", { value: known.name })));
  const units = element("datalist", { id: `units-${log.number}` }, preview.units.map((unit) => element("option", { value: unit })));
  for (const row of rows) {
    row.name.setAttribute("list", names.id);
    row.unit.setAttribute("list", units.id);
  }
  const filter = new Filter(isText ? "columns" : "channels");
  filter.take(rows.map(({ line, heading, name }) => ({ line, get text() { return `${heading} ${name.value}`; } })));
  const toml = element("textarea", { rows: 8, spellcheck: false, value: preview.mapping ?? "", placeholder: "schema = 1" });
  const dialect = () => ({ header: header.checked, skip_lines: Number(skip.value) || 0, delimiter: preview.head.delimiter });
  const send = () => apply({ columns: rows.map((row) => row.value()).filter(Boolean), ...(isText ? dialect() : {}) });
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

const OPEN = { role: "by_header", unit: "" };

/** Guesses a mapping from a header; the user sees each guess before it is applied. */
function guess(text) {
  const plain = text.toLowerCase();
  if (/^(time|zeit|t)\b|^time_|^t_s$|timestamp/.test(plain)) return { role: "time", unit: /us|µs/.test(plain) ? "us" : /ms/.test(plain) ? "ms" : "s" };
  return OPEN;
}

function columnRow(column, heading, guessed, preview, obstacle) {
  const role = element("select", { "aria-label": `use of column ${column}` },
    [["by_header", "from header"], ["time", "time"], ["signal", "signal"], ["ignore", "ignored"]].map(([value, text]) => element("option", { value, selected: value === guessed.role }, text)));
  const field = (label, properties) => element("input", { "aria-label": `${label} of column ${column}`, class: "short", ...properties });
  const name = field("signal", { placeholder: "p_ch" });
  const unit = field("unit", { value: guessed.unit, placeholder: "bar_gauge", class: "unit" });
  const scale = field("factor", { type: "number", step: "any", placeholder: "1" });
  const offset = field("offset", { type: "number", step: "any", placeholder: "0" });
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
  };
  const line = element("tr", {}, element("th", { scope: "row", title: obstacle }, heading, obstacle && element("span", { class: "unit" }, obstacle)), [role, name, unit, scale, offset].map((control) => element("td", {}, control)));
  return { line, heading, name, unit, value };
}
