// The fields of forms of modes: made from the server's descriptions, and read when a mode is started.

import { make, makeButton, put, sentence } from "../dom.js";

const RETRY = 2000; // ms

/** Asks for forms until they are shown: the server may be away, or this browser not paired yet. */
export async function loadForms(address, show) {
  try {
    const answer = await fetch(address);
    if (!answer.ok) throw new Error(answer.statusText);
    show(await answer.json());
  } catch {
    setTimeout(() => loadForms(address, show), RETRY);
  }
}

/** A label and a choice; `options` are values, labels and perhaps hints. */
export function choice(id, label, options) {
  const select = make("select", { id, class: "small" }, ...options.map(([value, text]) => new Option(text, value)));
  const field = make("label", { class: "field" }, make("span", {}, label), select);
  if (!options[0][2]) return [select, field];
  const meaning = make("p", { class: "words meaning", role: "status" });
  const tell = () => put(meaning, options[select.selectedIndex][2]);
  select.addEventListener("change", tell);
  tell();
  return [select, make("div", {}, field, meaning)];
}

/** A label and a number in the unit of the field. */
function figure(id, { title, help, unit, required, default: value, low, high }) {
  // a negative minimum would shift the steps
  const attributes = { min: low !== null && low >= 0 ? low : null, max: high, value: value ?? (required ? 0 : null) };
  const given = Object.fromEntries(Object.entries(attributes).filter(([, one]) => one !== null));
  const step = unit.startsWith("deg") ? "5" : "0.05";
  const input = make("input", { id, type: "number", class: "small", step, title: help, ...given });
  const words = `${unit.replace("deg", "°")}${required || value !== null ? "" : ", may be empty"}`;
  return [input, make("label", { class: "field" }, make("span", {}, `${title} `, make("small", {}, words)), input)];
}

export const button = (id, text, act, extra = "") => makeButton(text, { id, class: `choice ${extra}`.trim() }, act);

/** Whether a number is none or out of range; numbers between two steps are right. */
const isWrong = ({ validity }) => validity.badInput || validity.rangeUnderflow || validity.rangeOverflow;

/** The fields of one mode. */
export class Fields {
  /** The elements with a choice, and those with a number. */
  choices = [];
  numbers = [];
  #fields;
  #inputs = [];

  constructor(mode, fields) {
    this.#fields = fields;
    for (const field of fields) {
      const [id, worded] = [`${mode}-${field.name}`, field.choices.length > 0];
      const [input, element] = worded
        ? choice(id, field.title, field.choices.map(({ name, title, hint }) => [name, title, sentence(hint)]))
        : figure(id, field);
      if (worded) {
        input.value = field.default;
        input.dispatchEvent(new Event("change"));
      }
      (worded ? this.choices : this.numbers).push(element);
      this.#inputs.push(input);
    }
  }

  /** Returns the values that are filled in [SI], or null where one is wrong, which `notify` says. */
  read(notify) {
    const inputs = this.#inputs;
    const wrong = inputs.find((input, i) => isWrong(input) || (input.value === "" && this.#fields[i].required));
    if (wrong) {
      wrong.focus();
      notify(wrong.validationMessage || "A number is missing.");
      return null;
    }
    const values = this.#fields.map(({ name, choices, scale }, i) => [name, choices.length ? inputs[i].value : inputs[i].valueAsNumber * scale]);
    return Object.fromEntries(values.filter((_, i) => inputs[i].value !== ""));
  }

  /** Fills in texts by the names of fields. */
  fill(texts) {
    this.#fields.forEach(({ name }, i) => { if (name in texts) this.#inputs[i].value = texts[name]; });
  }
}
