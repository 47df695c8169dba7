// Tables of the plant file that are edited as text: the valves without a coil, and the user's own effects.

import { button, element, fill } from "../../dom.js";

const OWN_EFFECT = `
[own_effects.lifting_seal]
sentence = "The lip of the shaft seal lifts above a pressure."
acts_on = "leak_flow"
expression = "k * max(p - p_lift, 0)"
parameters.k = { typical = 1e-10, range = [1e-12, 1e-8], unit = "kg/s/Pa" }
parameters.p_lift = { typical = 4e5, range = [1.5e5, 9e5], unit = "Pa" }

# The effect is a candidate of each diagnosis. These values add it to the plant.
[effects.own.lifting_seal]
k = 1e-10
p_lift = 4e5
`;

const ON_OFF_VALVE = `
# Also write fill = "on_off" in [valves]; the vent valve has the table [on_off_vent].
[on_off_fill]
conductance_dm3_per_s_bar = { value = 0.64, tolerance_pct = 15 }
critical_ratio = { value = 0.25, tolerance = 0.1 }
opening_delay_s = { value = 9e-3, tolerance_pct = 25 }
closing_delay_s = { value = 8e-3, tolerance_pct = 25 }
opening_ramp_s = 2.5e-3
closing_ramp_s = 3.5e-3
`;

export class Tables {
  /** `send` sends a change, and throws its refusal. */
  constructor(send) {
    Object.assign(this, { send, taken: "" });
    this.text = element("textarea", { id: "tables", rows: 16, spellcheck: false, "aria-label": "Tables of the valves and own effects, TOML" });
    this.problems = element("ul", { class: "plain", id: "tables-problems", role: "alert" });
    this.element = element("section", { class: "card" },
      element("h2", {}, "Valves and own effects"),
      element("p", { class: "quiet" },
        "The tables of the plant file with the kinds of the valves, the valves without a coil (delays, ramps, conductance), ",
        "and effects of your own. A valve with a coil is described in a plant file."),
      this.text, this.problems,
      element("p", { class: "row" },
        button("Apply", () => this.apply(), { class: "primary", id: "apply-tables" }),
        button("Discard", () => this.reset(), { id: "discard-tables" }),
        button("Insert an own effect", () => this.insert(OWN_EFFECT), { id: "insert-effect" }),
        button("Insert an on/off valve", () => this.insert(ON_OFF_VALVE), { id: "insert-valve" })));
  }

  /** Shows the tables of the plant, unless the user is editing them. */
  take(tables) {
    const isEdited = this.text.value !== this.taken;
    this.taken = tables;
    if (!isEdited) this.reset();
  }

  reset() {
    this.text.value = this.taken;
    this.taken = this.text.value;
    fill(this.problems);
  }

  insert(text) {
    this.text.value += text;
    this.text.focus();
    this.text.scrollTop = this.text.scrollHeight;
  }

  async apply() {
    const [edited, before] = [this.text.value, this.taken];
    fill(this.problems);
    try {
      this.taken = edited;
      await this.send({ tables: edited });
    } catch (refusal) {
      this.taken = before;
      if (!refusal.isLost) fill(this.problems, (refusal.problems ?? [{ message: String(refusal) }]).map((problem) => this.problem(problem)));
    }
  }

  problem({ line, message }) {
    const place = line && button(`line ${line}`, () => this.goTo(line), { class: "link" });
    return element("li", { class: "problem" }, place, place && ": ", message);
  }

  /** Selects a line of the text. */
  goTo(line) {
    const lines = this.text.value.split("\n");
    const start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    this.text.focus();
    this.text.setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
  }
}
