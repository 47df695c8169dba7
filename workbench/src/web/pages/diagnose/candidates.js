// Ranking of the effects: share of the error that each explains alone, its size, and its description.

import { button, element } from "../../dom.js";
import { number, unitText } from "../../format.js";
import { term } from "../../terms.js";

export class Candidates {
  constructor(diagnosis, effects, onAdd) {
    Object.assign(this, { diagnosis, effects, onAdd });
    this.element = element("section", { class: "card", id: "candidates", "aria-label": "Candidates" },
      element("h2", {}, "Candidates"),
      element("p", { class: "quiet" },
        "Share of the ", term("excess error"), " that each effect explains alone, with all parameters refitted. Named effects are coloured. Click for details."),
      element("div", { class: "ranking" }, this.ranking().map((candidate, index) => this.row(candidate, index))));
  }

  /** Returns the named effects in their order, then the others by the shown share. */
  ranking() {
    const { candidates, effects } = this.diagnosis;
    const place = ({ effect }) => effects.includes(effect) ? effects.indexOf(effect) : effects.length;
    return [...candidates].sort((a, b) => place(a) - place(b) || b.explained_share - a.explained_share);
  }

  row(candidate, index) {
    const isNamed = this.diagnosis.effects.includes(candidate.effect);
    const about = this.effects.get(candidate.effect);
    const share = Math.max(0, Math.min(1, candidate.explained_share));
    const size = candidate.parameters[0];
    return element("details", { class: `candidate${isNamed ? " named" : ""}`, data: { effect: candidate.effect }, open: isNamed && index === 0 },
      element("summary", {},
        element("span", { class: "name" }, about?.title ?? candidate.effect),
        element("span", { class: "track", "aria-hidden": "true" }, element("span", { class: "fill", style: { width: `${100 * share}%` } })),
        element("span", { class: "share" }, `${(100 * share).toFixed(0)} %`),
        element("span", { class: "size" }, share < 0.005 || !size ? this.limit(candidate, true) : `${number(size.value, 3)} ${unitText(size.unit)}`),
        isNamed && element("span", { class: "chip good" }, "named")),
      this.body(candidate, about));
  }

  body(candidate, about) {
    const title = (id) => this.effects.get(id)?.title ?? id;
    const form = about?.forms.find((one) => one.name === candidate.variant);
    const { diagnosis } = this;
    const isNamed = diagnosis.effects.includes(candidate.effect);
    const fact = (name, ...text) => [element("dt", {}, name), element("dd", {}, ...text)];
    const list = (regimes) => regimes.filter((regime) => regime.regime).map((regime) => `${regime.log}, ${regime.signal}: ${regime.sentence}`).join("; ");
    return element("div", { class: "body stack" },
      element("p", {}, candidate.physics),
      candidate.parameters.length > 0 && element("table", { class: "numbers" },
        element("thead", {}, element("tr", {}, ["parameter", "fitted", "95 % interval", "typical", "unit", ""].map((cell) => element("th", { scope: "col" }, cell)))),
        element("tbody", {}, candidate.parameters.map((parameter) => element("tr", {},
          element("th", { scope: "row" }, parameter.key), element("td", {}, number(parameter.value, 3)),
          element("td", {}, `${number(parameter.low, 3)} to ${number(parameter.high, 3)}`),
          element("td", {}, number(parameter.typical, 3)), element("td", {}, unitText(parameter.unit)),
          element("td", {}, parameter.at_bound && element("span", { class: "chip bad" }, "at its limit")))))),
      element("dl", { class: "facts" },
        fact("Form of the law", form && form.name !== "only" ? `${form.name}: ${form.about}` : "only one"),
        candidate.plausibility && fact("Plausibility", candidate.plausibility),
        fact("Detection limit", this.limit(candidate, false)),
        fact(term("Evidence"), `${number(candidate.evidence, 3)} (above 10: strong; below 0: against the effect)`),
        about && fact("Excited by", about.excited_by),
        about && fact("Acts on", about.acts_on),
        isNamed && fact("Error without it", list(diagnosis.where.before) || "in no particular regime"),
        isNamed && fact("Error with it", list(diagnosis.where.after) || "no excess error left"),
        about?.confused_with.length > 0 && fact("Confused with", about.confused_with.map(title).join(", ")),
        fact("Source", candidate.source)),
      about && element("pre", { class: "equation", tabIndex: 0, "aria-label": "Equation" }, about.equation),
      element("p", { class: "row" }, button("Add this effect", () => this.onAdd(candidate.effect), { class: isNamed ? "primary add" : "add" })));
  }

  /** Returns the detection limit. */
  limit({ effect, detection_limit: limit }, isShort) {
    if (limit.not_excited) return isShort ? "not excited" : `not excited: these logs show no realistic size of this effect. Test signal: ${limit.not_excited.test_signal}`;
    const { key, value, unit } = limit.size;
    const specs = this.effects.get(effect)?.forms.flatMap((form) => form.parameters) ?? [];
    const sign = value < 0 || specs.find((spec) => spec.key === key)?.is_stronger_below ? "≤" : "≥";
    return isShort ? `detectable ${sign} ${number(value, 2)} ${unitText(unit)}` : `${key} ${sign} ${number(value, 3)} ${unitText(unit)} is detectable`;
  }
}
