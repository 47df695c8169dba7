// Effects of the plant: switches, forms of their laws, and sliders.

import { button, element, fill } from "../../dom.js";
import { number, unitText } from "../../format.js";

/** Positions of a slider. */
const PLACES = 2000;

/** Converts between a value and its position from 0 to 1, logarithmic if the library specifies it. */
function scaleOf({ lowest, highest, is_log: isLog }) {
  const [low, high] = isLog ? [Math.log(lowest), Math.log(highest)] : [lowest, highest];
  return {
    place: (value) => Math.max(0, Math.min(1, ((isLog ? Math.log(value) : value) - low) / (high - low))),
    value: (place) => {
      const value = low + place * (high - low);
      return Math.max(lowest, Math.min(highest, isLog ? Math.exp(value) : value));
    },
  };
}

export class Effects {
  /** `onChange` gets steps, `onMove` the position of a moving slider. */
  constructor(library, onChange, onMove) {
    Object.assign(this, { library, onChange, onMove, cards: new Map() });
    this.list = element("div", { class: "stack" });
    this.choice = element("select", { id: "add-effect", "aria-label": "Effect to add" });
    this.element = element("section", { class: "card", id: "effects" }, element("h2", {}, "Effects"), this.list,
      element("p", { class: "row" }, this.choice, button("Add", () => this.onChange({ add: { effect: this.choice.value } }), { id: "add" })));
  }

  take(effects) {
    const shape = (effect) => `${effect.effect}/${effect.variant}`;
    for (const [key, card] of this.cards) {
      if (!effects.some((effect) => shape(effect) === key)) { card.element.remove(); this.cards.delete(key); }
    }
    for (const effect of effects) {
      const key = shape(effect);
      if (!this.cards.has(key)) this.cards.set(key, new Card(effect, this.library.get(effect.effect), this.onChange, this.onMove));
      const card = this.cards.get(key);
      card.take(effect);
      // An element that is not moved keeps its focus.
      const place = effects.indexOf(effect);
      if (this.list.children[place] !== card.element) this.list.insertBefore(card.element, this.list.children[place] ?? null);
    }
    if (effects.length === 0) fill(this.list, element("p", { class: "quiet" }, "None: the plant is as opened. Add one, or find one with Diagnose."));
    else for (const child of [...this.list.children]) if (child.tagName === "P") child.remove();
    const free = [...this.library.values()].filter((one) => !effects.some((effect) => effect.effect === one.id));
    const before = this.choice.value;
    fill(this.choice, free.map((one) => element("option", { value: one.id, title: one.sentence, selected: one.id === before }, one.title)));
  }
}

class Card {
  constructor(effect, about, onChange, onMove) {
    const id = effect.effect;
    const form = about.forms.find((one) => one.name === effect.variant);
    this.toggle = element("input", { type: "checkbox", role: "switch", data: { switch: id }, on: { change: () => onChange({ switch: { effect: id, is_on: this.toggle.checked } }) } });
    const forms = about.forms.length > 1 && element("select", { "aria-label": `Form of ${about.title}`, title: form.about, on: { change: (event) => onChange({ form: { effect: id, form: event.target.value } }) } },
      about.forms.map((one) => element("option", { value: one.name, selected: one === form, title: one.about }, one.name)));
    this.sliders = form.parameters.map((spec) => new Slider(id, spec, onChange, onMove));
    this.element = element("div", { class: "effect", data: { effect: id } },
      element("div", { class: "row" },
        element("label", { class: "switch", title: about.sentence }, this.toggle, element("b", {}, ` ${about.title}`)), forms,
        element("span", { class: "space" }), button("Remove", () => onChange({ remove: { effect: id } }), { class: "link" })),
      this.sliders.map((slider) => slider.element));
  }

  take(effect) {
    this.toggle.checked = effect.is_on;
    this.element.classList.toggle("off", !effect.is_on);
    for (const slider of this.sliders) slider.take(effect.parameters.find((one) => one.key === slider.spec.key), effect.is_on);
  }
}

class Slider {
  constructor(effect, spec, onChange, onMove) {
    Object.assign(this, { spec, scale: scaleOf(spec) });
    const of = (value) => ({ effect, key: spec.key, value });
    const value = () => this.scale.value(Number(this.range.value) / PLACES);
    this.range = element("input", {
      type: "range", min: 0, max: PLACES, step: 1, data: { key: spec.key }, "aria-label": `${spec.key} of ${effect}`, title: spec.about,
      on: {
        input: () => { this.show(value()); if (this.isOn) onMove(of(value())); },
        change: () => onChange({ set: of(value()) }),
      },
    });
    this.field = element("input", { type: "number", step: "any", min: spec.lowest, max: spec.highest, class: "short", "aria-label": `${spec.key} of ${effect} as a number`, data: { field: spec.key }, on: { change: () => onChange({ set: of(Number(this.field.value)) }) } });
    this.interval = element("span", { class: "interval", hidden: true });
    this.best = element("span", { class: "best", hidden: true });
    this.words = element("span", { class: "quiet" });
    this.element = element("div", { class: "slider" },
      element("div", { class: "row" }, element("span", { class: "name", title: spec.about }, spec.key), element("span", { class: "space" }), this.field, element("span", { class: "unit" }, unitText(spec.unit))),
      element("div", { class: "track" }, this.interval, this.best, this.range), this.words);
  }

  show(value) {
    this.field.value = value === null ? "" : String(Number(value.toPrecision(4)));
    this.range.setAttribute("aria-valuetext", value === null ? "off" : `${number(value, 3)} ${this.spec.unit}`);
  }

  take(parameter, isOn) {
    if (!parameter) return;
    this.isOn = isOn;
    const { value, fitted } = parameter;
    this.range.value = Math.round(PLACES * this.scale.place(value ?? this.spec.typical ?? this.spec.lowest));
    this.show(value);
    this.interval.hidden = this.best.hidden = !fitted;
    const { lowest, highest, unit } = this.spec;
    const bounds = `${number(lowest, 2)} to ${number(highest, 2)}${this.spec.is_log ? ", logarithmic" : ""}`;
    if (!fitted) {
      this.words.textContent = bounds;
      return;
    }
    // The centre of the thumb stays half its width away from both ends.
    const at = (place) => `calc(${8 - 16 * place}px + ${100 * place}%)`;
    const [low, best, high] = [fitted.low, fitted.value, fitted.high].map((one) => this.scale.place(one));
    Object.assign(this.interval.style, { left: at(low), right: `calc(100% - (${8 - 16 * high}px + ${100 * high}%))` });
    this.best.style.left = at(best);
    this.words.textContent = `fitted ${number(fitted.value, 3)} (${number(fitted.low, 3)} to ${number(fitted.high, 3)}) ${unitText(unit)}; ${bounds}`;
  }
}
