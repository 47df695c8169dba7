// Common parts of the cards of planned experiments: limits of the rig, duty cycles of the best test signal.

import * as api from "../api.js";
import { axis, clear, draw, label, layout } from "../chart.js";
import { element } from "../dom.js";
import { colour } from "../theme.js";

const HEIGHT = 230;

/** Fields for the limits of an experiment. */
export class LimitFields {
  constructor() {
    const field = (value, more) => element("input", { type: "number", min: 0, step: "any", class: "short", value, ...more });
    this.duration = field(20);
    this.pressure = field("", { placeholder: "auto", title: "If empty: 90 % of the supply pressure" });
    this.duty = field(100);
    this.elements = [
      element("label", {}, "duration up to ", this.duration, " s"),
      element("label", {}, "pressure up to ", this.pressure, " bar"),
      element("label", {}, "duty cycle up to ", this.duty, " %"),
    ];
  }

  /** Returns the limits for a request. */
  requested() {
    return {
      duration_s: Number(this.duration.value),
      max_bar: this.pressure.value === "" ? null : Number(this.pressure.value),
      max_duty_pct: Number(this.duty.value),
    };
  }
}

/** Chart of the duty cycles of the best test signal. */
export class DutyChart {
  constructor(id) {
    this.element = element("div", { class: "chart", id, role: "img", "aria-label": "Duty cycles of the best test signal" });
  }

  draw({ sequence, ranking }) {
    const end = ranking[0]?.duration_s ?? 0;
    const times = [...sequence.map((phase) => phase.time_s), end];
    const trace = (name, role, key, dash) => ({
      name, x: times, y: [...sequence.map((phase) => phase[key]), sequence.at(-1)?.[key] ?? 0], mode: "lines", type: "scatter",
      line: { color: colour(role), width: 2, shape: "hv", dash }, hovertemplate: `${name} %{y:.0f} % from %{x:.2f} s<extra></extra>`,
    });
    draw(this.element, [trace("fill valve", "fill", "duty_fill_pct", "solid"), trace("vent valve", "vent", "duty_vent_pct", "dash")], layout({
      height: HEIGHT, showlegend: true, legend: { orientation: "h", x: 1, xanchor: "right", y: 1.12, yanchor: "bottom" },
      title: { text: label(ranking[0]?.name ?? ""), font: { size: 13 }, x: 0, xanchor: "left" },
      xaxis: axis({ title: { text: "time [s]", standoff: 4 }, range: [0, end] }),
      yaxis: axis({ title: { text: "duty cycle [%]", standoff: 4 }, range: [-4, 106] }),
    }));
  }

  clear() {
    clear(this.element);
  }
}

/** Returns the link to the duty cycles as a file `name`. */
export function dutiesLink(path, name, id) {
  return element("p", { class: "row" },
    element("a", { class: "button", href: api.address(path), download: name, id }, "Duty cycles as CSV"),
    element("span", { class: "quiet" }, "One row per ECU sample; input for the rig and for retarder simulate."));
}
