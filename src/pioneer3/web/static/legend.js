// The legend: what the colours mean, and a switch for each layer.

import { LAYERS } from "./layers.js";

const byId = (id) => document.getElementById(id);
const NOTES = { laser: "switches it on" };

export class Legend {
  #layers;
  #boxes = new Map();

  constructor(layers) {
    this.#layers = layers;
    byId("legend-list").replaceChildren(...LAYERS.map(([name, label]) => this.#row(name, label)));
    byId("layers").addEventListener("click", () => this.open(byId("legend").hidden));
    byId("legend-close").addEventListener("click", () => this.open(false));
    addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === "l" && !isTyping(event.target)) this.open(byId("legend").hidden, true);
      if (event.key === "Escape") this.open(false);
    });
  }

  open(open, byKey = false) {
    const legend = byId("legend");
    if (legend.hidden === !open) return;
    const inside = legend.contains(document.activeElement);
    legend.hidden = !open;
    byId("layers").setAttribute("aria-expanded", String(open));
    if (open && byKey) this.#boxes.get(LAYERS[0][0]).focus();
    if (!open && inside) byId("layers").focus();
  }

  /** Shows the rows of what there is: no laser, no row. */
  offer(name, there) {
    this.#boxes.get(name).closest("li").hidden = !there;
  }

  #row(name, label) {
    const row = document.createElement("li");
    const box = document.createElement("input");
    Object.assign(box, { type: "checkbox", id: `layer-${name}`, checked: this.#layers.has(name) });
    box.addEventListener("change", () => this.#layers.set(name, box.checked));
    box.addEventListener("keydown", ({ key }) => key === "Enter" && box.click()); // space stops the robot
    const text = document.createElement("label");
    text.htmlFor = box.id;
    const swatch = document.createElement("i");
    swatch.className = "swatch";
    swatch.dataset.layer = name;
    swatch.setAttribute("aria-hidden", "true");
    text.append(swatch, label);
    if (NOTES[name]) text.append(Object.assign(document.createElement("small"), { textContent: NOTES[name] }));
    row.append(box, text);
    this.#boxes.set(name, box);
    return row;
  }
}

function isTyping(target) {
  return target instanceof Element && target.matches("input:not([type=checkbox]), textarea, select");
}
