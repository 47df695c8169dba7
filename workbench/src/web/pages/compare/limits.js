// Acceptance limits of a signal: a multiple of its noise, an rms error, and a band for its samples.

import * as api from "../../api.js";
import { button, element, scrolling, showProblems } from "../../dom.js";
import { menu } from "../../menu.js";
import * as view from "../../view.js";

/** Fields of a band: heading, key, and factor from the field's unit to the project's. */
const BAND = [["± absolute", "absolute", 1], ["± % of the value", "relative", 0.01], ["± time [ms]", "time_s", 0.001], ["allowed outside [%]", "beyond_max", 0.01]];
/** Parts of the view that stay when its limits change. */
const KEPT = ["log", "from", "to", "a", "b", "select", "hide", "states", "with", "between"];

const field = (name, value, placeholder = "") => element("input", { type: "number", min: 0, step: "any", class: "short", "aria-label": name, value, placeholder });

/** Creates the menu for the signals of a log. */
export function limitsMenu(log, strictness) {
  const allow = field("multiples of the noise", strictness.allowed_noise_multiples);
  const rows = log.summary.signals.filter(({ name }) => !name.startsWith("duty_") && name !== "u_bat").map((signal) => row(signal, strictness));
  const apply = async () => {
    const requested = { allowed_noise_multiples: Number(allow.value), tolerances: { ...strictness.tolerances }, bands: { ...strictness.bands } };
    for (const one of rows) one.say(requested);
    try {
      await api.put("/strictness", requested);
      view.go("compare", Object.fromEntries(KEPT.map((key) => [key, view.texts(key)])));
    } catch (refusal) {
      showProblems(refusal, "Limits");
    }
  };
  const head = (cells) => element("tr", {}, cells.map((cell) => element("th", { scope: "col" }, cell)));
  return menu("Limits",
    element("div", { class: "popup stack" },
      element("label", {}, "within tolerance up to ", allow, " times the noise"),
      scrolling("Tolerances of the signals", element("table", { class: "form" },
        element("thead", {}, head(["signal", "or up to this rms", ...BAND.map(([heading]) => heading)])), element("tbody", {}, rows.map((one) => one.line)))),
      element("p", { class: "quiet" }, "The larger of both tolerances is the band. It applies to each sample of the visible range."),
      button("Apply and compare", apply, { class: "primary" })),
    { id: "limits" });
}

function row({ name, error_unit: unit }, { tolerances, bands }) {
  const rms = field(`rms of ${name}`, tolerances[name] ?? "", "from noise");
  const band = BAND.map(([heading, key, scale]) => [key, scale, field(`${name}: ${heading}`, bands[name]?.[key] ? String(+(bands[name][key] / scale).toPrecision(8)) : "")]);
  const say = (requested) => {
    if (rms.value === "") delete requested.tolerances[name];
    else requested.tolerances[name] = Number(rms.value);
    const said = band.filter(([, , input]) => input.value !== "").map(([key, scale, input]) => [key, scale * Number(input.value)]);
    if (said.length === 0) delete requested.bands[name];
    else requested.bands[name] = Object.fromEntries(said);
  };
  return { say, line: element("tr", {}, element("th", { scope: "row" }, `${name} [${unit}]`), [rms, ...band.map(([, , input]) => input)].map((input) => element("td", {}, input))) };
}
