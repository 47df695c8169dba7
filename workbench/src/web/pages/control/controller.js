// Settings of the controller: the keys of a controller file, one field each.

import * as api from "../../api.js";
import { button, element, showMessage } from "../../dom.js";

/** Headings of the tables of a controller file. */
const TABLES = new Map([
  ["sample", "Sample"], ["pid", "PID"], ["tolerance", "Deadband"], ["prediction", "Prediction"], ["boost", "Boost"], ["distributor", "Distribution to the valves"], ["duty_min", "Lower limits of the duty cycles"],
]);
/** Open tables: initially those that are tuned most, then those that the user opened. */
const open = new Set(["pid", "tolerance"]);

/** Creates a form that passes changed settings to `apply`, which refuses by throwing. */
export function controllerForm(controller, apply) {
  const wrong = element("div", { class: "problem", role: "status" });
  const fields = controller.settings.map((setting) => ({ setting, path: `${setting.table}.${setting.name}`, ...field(setting) }));
  const names = [...new Set(controller.settings.map((setting) => setting.table))];
  const tables = names.map((name) => element("details", { open: open.has(name), on: { toggle: (event) => { if (event.target.open) open.add(name); else open.delete(name); } } }, element("summary", {}, TABLES.get(name) ?? name),
    fields.filter(({ setting }) => setting.table === name).map(({ setting, path, input, words }) => element("label", { class: "setting", title: setting.about, data: { setting: path } },
      element("span", {}, setting.name), input, words))));
  const submit = async (settings) => {
    wrong.replaceChildren();
    for (const { input } of fields) input.classList.remove("wrong");
    try {
      await apply(settings);
    } catch (refusal) {
      const isNamed = (path, name) => (refusal.problems ?? []).some(({ message }) => message.includes(path) || message.startsWith(`\`${name}\` is missing`));
      for (const { setting, path, input } of fields) input.classList.toggle("wrong", isNamed(path, setting.name));
      wrong.append(...(refusal.problems ?? []).map((problem) => element("p", {}, problem.message)));
      for (const { input } of fields) if (input.classList.contains("wrong")) input.closest("details").open = true;
    }
  };
  const changed = () => fields.filter(({ setting, input }) => input.value.trim() !== (setting.value ?? "")).map(({ path, input }) => [path, input.value.trim() === "" ? null : input.value.trim()]);
  const file = element("input", { type: "file", id: "controller-file", accept: ".toml", on: { change: async () => {
    const [chosen] = file.files;
    if (!chosen) return;
    if (chosen.size > 1 << 20) { showMessage(`${chosen.name}: a controller file has at most 1 MiB`, "problem"); return; }
    await submit({ from: "file", name: chosen.name, toml: await chosen.text() });
  } } });
  return [
    element("h2", {}, "Controller"),
    element("p", { class: "quiet", id: "controller-name" }, controller.name),
    element("form", { class: "stack tight", id: "controller", on: { submit: (event) => { event.preventDefault(); submit({ from: "values", values: changed() }); } } },
      tables, wrong,
      element("div", { class: "row" },
        element("button", { type: "submit", class: "primary", id: "apply-controller" }, "Apply and run"),
        button("Recommended", () => submit({ from: "recommended" })), button("Thesis", () => submit({ from: "thesis" }), { id: "thesis-controller" }),
        element("label", { class: "button", for: "controller-file" }, "Open file …"), file,
        element("a", { class: "button", href: api.address("/control/controller"), download: "controller.toml" }, "Download"))),
  ];
}

/** Creates a field for a number or a word; the description of a key has its words in quotes. */
function field(setting) {
  const words = [...setting.about.matchAll(/"(\w+)"/g)].map((match) => match[1]);
  const id = `words-${setting.table}-${setting.name}`;
  const input = element("input", { value: setting.value ?? "", class: words.length > 1 ? "word" : "short", placeholder: "unset", autocomplete: "off", spellcheck: false, list: words.length > 0 ? id : undefined });
  return { input, words: words.length > 0 && element("datalist", { id }, words.map((word) => element("option", { value: word }))) };
}
