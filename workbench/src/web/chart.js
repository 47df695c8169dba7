// Plotly, with the colours and defaults of this page.

import { save } from "./dom.js";
import { colour } from "./theme.js";

/** Plotly decodes a few entities of its labels through markup; no other code may use markup. */
globalThis.trustedTypes?.createPolicy("default", {
  createHTML: (text) => {
    if (/^(&#?\w+;)?$/.test(text)) return text;
    throw new TypeError("markup in a label is not allowed");
  },
});

const loaded = new Promise((resolve, reject) => {
  if (globalThis.Plotly) { resolve(); return; }
  const script = document.getElementById("plotly");
  script.addEventListener("load", resolve);
  script.addEventListener("error", () => reject(new Error("the charting library was not loaded; reload the page")));
});

/** Returns the library as soon as it is loaded. */
export async function plotly() {
  await loaded;
  return globalThis.Plotly;
}

/** Escapes text for a label, since the library would interpret markup. */
export const label = (text) => String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");

/** Returns an axis in the colours of the page. */
export function axis(properties = {}) {
  return {
    color: colour("label"), gridcolor: colour("grid"), linecolor: colour("axis"), zerolinecolor: colour("axis"),
    zeroline: false, showline: true, ticks: "outside", ticklen: 4, automargin: false, exponentformat: "none", ...properties,
  };
}

/** Returns a layout in the colours of the page. */
export function layout(properties = {}) {
  return {
    paper_bgcolor: colour("card"), plot_bgcolor: colour("card"), showlegend: false, hovermode: "closest", dragmode: "zoom",
    font: { family: "system-ui, sans-serif", size: 12, color: colour("ink") },
    hoverlabel: { bgcolor: colour("raised"), bordercolor: colour("axis"), font: { color: colour("ink") } },
    margin: { l: 64, r: 14, t: 26, b: 42 }, ...properties,
  };
}

const CONFIG = { displaylogo: false, responsive: true, displayModeBar: false, doubleClick: false, showTips: false };

/** Draws a chart with `plotLayout`, or draws it again. */
export async function draw(place, traces, plotLayout) {
  const library = await plotly();
  place.style.height = `${plotLayout.height}px`;
  await library.react(place, traces, plotLayout, CONFIG);
}

/** Height (px) of the title and the legend above a saved chart. */
const HEAD = 46;

/** Returns a chart with a title, and with a legend of its named traces, above the plots. */
function withHead({ data, layout: shown }, title, height) {
  const named = new Set();
  const traces = data.map((trace) => {
    const showlegend = Boolean(trace.name) && !named.has(trace.name);
    named.add(trace.name);
    return { ...trace, showlegend };
  });
  const margin = { ...shown.margin, t: shown.margin.t + HEAD };
  const plotted = height - shown.margin.t - shown.margin.b;
  return {
    data: traces, config: CONFIG,
    layout: {
      ...shown, height: height + HEAD, margin, showlegend: true,
      title: { text: label(title), font: { size: 13 }, x: 0, xref: "paper", y: 1, yref: "container", yanchor: "top", pad: { t: 6 } },
      legend: { orientation: "h", x: 0, y: 1 + (shown.margin.t - 2) / plotted, yanchor: "bottom", font: { size: 11 }, bgcolor: "rgba(0, 0, 0, 0)" },
    },
  };
}

/** Saves a chart as `png` or `svg`, at its displayed size, with a title and a legend. */
export async function saveImage(place, format, name, title) {
  const library = await plotly();
  const { width, height } = place.getBoundingClientRect();
  const size = { width, height: height + HEAD };
  const svg = await library.toImage(withHead(place, title, height), { format: "svg", ...size });
  save(`${name}.${format}`, format === "svg" ? svg : await painted(svg, size.width, size.height));
}

/**
 * Converts an SVG into a PNG of twice its size. The library's own method needs images that the content policy refuses.
 */
async function painted(svg, width, height) {
  const image = new Image(width, height);
  image.src = svg;
  await image.decode();
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: 2 * width, height: 2 * height });
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return canvas.toDataURL("image/png");
}

/** Removes a chart with all data that the library stores about it. */
export function clear(place) {
  globalThis.Plotly?.purge(place);
}
