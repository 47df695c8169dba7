// Error steps, effect by effect: bars in multiples of the noise of each signal.

import { element, table } from "../dom.js";
import { number, titled, unitText } from "../format.js";

const multiple = (error) => error.rms !== null && error.noise_floor ? error.rms / error.noise_floor : null;

/**
 * Draws rows of `{ title, errors: [{ signal, unit, rms, noise_floor }], changed: [{ name, unit, before, after }] }`, the
 * first at the top.
 */
export function errorSteps(rungs) {
  const most = Math.max(1.5, ...rungs.flatMap((rung) => rung.errors.map(multiple)).filter((times) => times !== null));
  const place = (times) => `${100 * Math.min(1, times / most)}%`;
  return element("div", { class: "error-steps", role: "list" }, rungs.map((rung, index) => element("div", { class: "rung", role: "listitem", data: { rung: index } },
    element("h3", {}, rung.title),
    rung.errors.map((error) => bar(error, multiple(error), place, index === 0)),
    rung.changed?.length > 0 && changedValues(rung.changed))));
}

/** Returns the values that a row changes. */
function changedValues(changed) {
  const rows = changed.map(({ name, before, after, unit }) => [name, number(before), number(after), unitText(unit)]);
  return element("details", { class: "changed" }, element("summary", {}, rows.length === 1 ? "1 value" : `${rows.length} values`),
    element("div", { class: "scroll" }, table(["parameter", "as opened", "now", "unit"], rows, "numbers dense")));
}

function bar(error, times, place, isFirst) {
  const figures = times === null ? "no noise floor" : `${number(times, 3)} × noise`;
  const track = element("span", { class: "track", "aria-hidden": "true" });
  if (times !== null) {
    track.append(
      element("span", { class: `fill${isFirst ? " first" : ""}`, style: { width: place(times) } }),
      element("span", { class: "floor", style: { left: place(1) }, title: "noise floor" }));
  }
  return element("div", { class: "bar-row", data: { signal: error.signal, times: times === null ? "" : String(times) } },
    element("span", { class: "name", title: titled(error.signal) }, error.signal), track,
    element("span", { class: "figures" }, figures, element("span", { class: "unit" }, ` ${number(error.rms, 3)} ${error.unit}`)));
}

/** Steps that add no effect. */
const STEPS = {
  plant_as_given: "plant as given", parameters_refitted: "ordinary parameters refitted",
  ranges_widened: "ordinary parameters refitted beyond their tolerances",
};

/** Returns the rows of a diagnosis or a fit. */
export function rungsOf(steps) {
  return steps.map((step) => ({
    title: step.added ? `+ ${step.added.replaceAll("_", " ")} (${step.variant.replaceAll("_", " ")})` : STEPS[step.kind],
    errors: Object.keys(step.check_rms).sort((a, b) => (b === "p_ch") - (a === "p_ch")).map((signal) => ({
      signal, unit: signal.startsWith("i_") ? "mA" : "bar", rms: step.check_rms[signal], noise_floor: step.noise_floor[signal],
    })),
  }));
}
