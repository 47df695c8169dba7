// Error steps, effect by effect: bars in multiples of the noise of each signal, on a logarithmic axis.

import { element } from "../dom.js";
import { number, titled, unitText } from "../format.js";

const multiple = (error) => error.rms !== null && error.noise_floor ? error.rms / error.noise_floor : null;

/** Ticks (multiples of the noise) of the logarithmic axis. */
const TICKS = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];

/** Returns the first and the last tick around all errors; the noise floor is always inside. */
function rangeOf(rungs) {
  const times = rungs.flatMap((rung) => rung.errors.map(multiple)).filter((one) => one !== null);
  const last = TICKS.findIndex((tick) => tick >= Math.max(2, ...times));
  return [TICKS[0], last < 0 ? TICKS.at(-1) : TICKS[last]];
}

/** Draws rows of `{ title, errors: [{ signal, unit, rms, noise_floor }] }`, the first at the top. */
export function errorSteps(rungs) {
  const [low, high] = rangeOf(rungs);
  const place = (times) => `${100 * Math.max(0, Math.min(1, Math.log(times / low) / Math.log(high / low)))}%`;
  return element("div", { class: "error-steps", role: "list" }, rungs.map((rung, index) => element("div", { class: "rung", role: "listitem", data: { rung: index } },
    element("h3", {}, rung.title),
    rung.errors.map((error) => bar(error, multiple(error), place, index === 0)))),
  axisRow(TICKS.filter((tick) => tick >= low && tick <= high), place));
}

/** Creates the logarithmic axis below the bars. */
function axisRow(ticks, place) {
  return element("div", { class: "bar-row scale", "aria-hidden": "true" }, element("span", {}),
    element("span", { class: "ticks" }, ticks.map((tick) => element("span", { style: { left: place(tick) } }, String(tick)))),
    element("span", { class: "unit" }, "× noise, logarithmic"));
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
