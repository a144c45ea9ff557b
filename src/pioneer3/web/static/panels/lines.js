// Digital and analog lines of the controller.

import { make, number, put, set } from "./dom.js";

export class LineBoard {
  element;
  #inputs = make("ol", { class: "bits", "aria-label": "Digital inputs", start: 0 });
  #outputs = make("ol", { class: "bits", "aria-label": "Digital outputs", start: 0 });
  #analog = make("p", { class: "words" });

  constructor() {
    this.element = make("div", {}, make("h4", {}, "Digital inputs"), this.#inputs, make("h4", {}, "Digital outputs"), this.#outputs, make("h4", {}, "Analog inputs"), this.#analog);
  }

  show({ digital_in: inputs, digital_out: outputs, analog, selected }) {
    bits(this.#inputs, inputs);
    bits(this.#outputs, outputs);
    const chosen = `port ${selected.port}: ${number(selected.voltage, 2)} V`;
    put(this.#analog, analog?.length ? analog.map((voltage, port) => `${port}: ${number(voltage, 2)} V`).join("   ") : `Only the selected one is known, ${chosen}.`);
  }
}

function bits(list, levels) {
  if (list.children.length !== levels.length) {
    list.replaceChildren(...levels.map((_, i) => make("li", {}, make("small", {}, String(i)), make("b", {}))));
  }
  levels.forEach((high, i) => {
    const item = list.children[i];
    set(item, "class", high ? "high" : "low");
    put(item.lastElementChild, high ? "1" : "0");
  });
}
