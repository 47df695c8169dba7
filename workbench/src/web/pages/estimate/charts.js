// Pictures of an estimation: intervals within the stated ranges, and correlations.

import { axis, draw, label, layout } from "../../chart.js";
import { number, unitText } from "../../format.js";
import { colour } from "../../theme.js";

const ROW = 26;
/** Correlation from which on two parameters are named below the picture. */
const STRONG = 0.5;
/** Largest number of pairs that are named. */
const NAMED_MAX = 3;
/** Number of parameters up to which a cell has room for its value. */
const WITH_VALUES_MAX = 18;

/** Returns a short name for each parameter: its key, with its table where the key alone is not unique. */
export function shortNames(parameters) {
  const keys = parameters.map(({ name }) => name.split(".").at(-1));
  return parameters.map(({ name }, index) => {
    const isEffect = name.startsWith("effects.");
    const isShared = keys.indexOf(keys[index]) !== keys.lastIndexOf(keys[index]);
    return isEffect || isShared ? name.replace("effects.", "") : keys[index];
  });
}

/** Returns an axis with the names of parameters. */
const names = (properties) => axis({
  type: "category", fixedrange: true, showgrid: false, automargin: true, ticks: "", ...properties,
});

/** Returns the place of a value in the range of its parameter (%). */
const share = ({ within: [least, most] }, value) => 100 * (value - least) / (most - least);

const isAtLimit = (parameter) => parameter.determination === "at_limit";

/** Returns the text that appears over a parameter. */
function hover({ name, unit, before, after, low, high, within: [least, most] }) {
  const interval = `95 %: ${number(low, 3)} to ${number(high, 3)}`;
  return label(`${name}: ${number(after)} ${unitText(unit)}, ${interval}; range ${number(least, 3)} to ${number(most, 3)}; before ${number(before)}`);
}

/** Returns the dots and whiskers of some parameters. */
function dots(title, role, symbol, of) {
  const at = of.map(({ parameter }) => share(parameter, parameter.after));
  return {
    type: "scatter", mode: "markers", name: title, x: at, y: of.map((one) => one.short), marker: { color: colour(role), size: 9, symbol },
    text: of.map(({ parameter }) => hover(parameter)), hovertemplate: "%{text}<extra></extra>",
    error_x: {
      type: "data", symmetric: false, color: colour(role), thickness: 2.5, width: 5,
      array: of.map(({ parameter }, index) => share(parameter, parameter.high) - at[index]),
      arrayminus: of.map(({ parameter }, index) => at[index] - share(parameter, parameter.low)),
    },
  };
}

/** Draws each interval as a whisker on the range of its parameter, which is the same width for all. */
export function drawIntervals(place, estimation) {
  const parameters = estimation.parameters.filter(({ within }) => within && within[0] < within[1]);
  const short = shortNames(parameters).map(label);
  const shown = parameters.map((parameter, index) => ({ parameter, short: short[index] }));
  const before = {
    type: "scatter", mode: "markers", name: "before", x: parameters.map((parameter) => share(parameter, parameter.before)), y: short,
    marker: { color: colour("card"), size: 8, symbol: "circle", line: { color: colour("label"), width: 1.5 } }, hoverinfo: "skip",
  };
  const inside = dots("estimate, 95 % interval", "residual", "circle", shown.filter(({ parameter }) => !isAtLimit(parameter)));
  const outside = dots("at its limit", "limit", "diamond", shown.filter(({ parameter }) => isAtLimit(parameter)));
  const bar = (_, index) => ({
    type: "rect", xref: "x", yref: "y", x0: 0, x1: 100, y0: index - 0.3, y1: index + 0.3, fillcolor: colour("band"), line: { width: 0 }, layer: "below",
  });
  return draw(place, [before, inside, outside], layout({
    height: 96 + ROW * shown.length, margin: { l: 20, r: 14, t: 30, b: 42 }, dragmode: false,
    showlegend: true, legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom", font: { size: 11 } },
    xaxis: axis({ title: { text: "place in the range that the estimation may use [%]", standoff: 4 }, range: [-4, 104], fixedrange: true, showgrid: false }),
    yaxis: names({ categoryorder: "array", categoryarray: short.toReversed(), range: [-0.7, shown.length - 0.3] }),
    shapes: shown.map(bar),
  }));
}

/** Draws the correlation matrix as a map. */
export function drawCorrelations(place, { parameters, correlations }) {
  const short = shortNames(parameters).map(label);
  const hasValues = parameters.length <= WITH_VALUES_MAX;
  return draw(place, [{
    type: "heatmap", x: short, y: short, z: correlations, zmin: -1, zmax: 1, xgap: 1, ygap: 1,
    colorscale: [[0, colour("fill")], [0.5, colour("card")], [1, colour("model")]],
    text: correlations.map((row) => row.map((value) => Math.abs(value) < 0.1 ? "" : value.toFixed(1).replace("-", "−"))),
    texttemplate: hasValues ? "%{text}" : undefined, textfont: { size: 10 },
    hovertemplate: "%{y} and %{x}: %{z:.3f}<extra></extra>", showscale: false,
  }], layout({
    height: 150 + ROW * parameters.length, margin: { l: 20, r: 8, t: 10, b: 20 }, dragmode: false,
    xaxis: names({ tickangle: -50, showline: false }), yaxis: names({ autorange: "reversed", showline: false }),
  }));
}

/** Returns the strongest correlations in words. */
export function strongest({ parameters, correlations }) {
  const short = shortNames(parameters);
  const below = (row, one) => row.slice(0, one).map((value, other) => ({ value, names: `${short[other]} and ${short[one]}` }));
  const pairs = correlations.flatMap(below);
  const strong = pairs.filter(({ value }) => Math.abs(value) >= STRONG).sort((a, b) => Math.abs(b.value) - Math.abs(a.value));
  if (strong.length === 0) return `No two parameters are correlated by ${STRONG} or more.`;
  const list = strong.slice(0, NAMED_MAX).map(({ value, names: both }) => `${both} ${value.toFixed(2).replace("-", "−")}`).join("; ");
  return `${strong.length} pairs are correlated by ${STRONG} or more; the strongest: ${list}. The logs determine such parameters only together.`;
}
