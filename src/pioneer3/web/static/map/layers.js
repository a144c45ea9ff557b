// The layers of the picture, each on or off and remembered on this device, and the legend with their switches.

import { byId, hasModifier, isTyping, make, recall, remember } from "../dom.js";

const KEY = "pioneer3.layers";

/** In the order of the legend: name, label, whether it is on at first, note. */
const LAYERS = [
  ["map", "Walls and cells", true],
  ["changes", "Gone (−) and new (+)", true],
  ["places", "Goals, docks, homes", true],
  ["zones", "Forbidden, marked", true],
  ["things", "Boxes and people", true],
  ["names", "Names", true],
  ["trails", "Trails", true],
  ["paths", "Where it will be", true],
  ["targets", "Where it is going", true],
  ["sonar", "Sonar", true],
  ["laser", "Laser", false, "switches it on"],
  ["bumpers", "Bumper hits", true],
  ["grid", "Grid", true],
];

export class Layers {
  #shown;

  /** @param changed function(name), after a layer was switched */
  constructor(changed) {
    this.changed = changed;
    const kept = recalled();
    this.#shown = Object.fromEntries(LAYERS.map(([name, , on]) => [name, typeof kept[name] === "boolean" ? kept[name] : on]));
  }

  has(name) {
    return this.#shown[name];
  }

  get all() {
    return { ...this.#shown };
  }

  /** Shows a layer unless the user has chosen otherwise on this device. */
  suggest(name) {
    if (typeof recalled()[name] !== "boolean" && !this.#shown[name]) {
      this.#shown[name] = true;
      this.changed(name);
    }
  }

  set(name, on) {
    if (!(name in this.#shown) || this.#shown[name] === on) return;
    this.#shown[name] = on;
    remember(KEY, JSON.stringify({ ...recalled(), [name]: on }));
    this.changed(name);
  }
}

function recalled() {
  try {
    return JSON.parse(recall(KEY)) ?? {};
  } catch {
    return {};
  }
}

export class Legend {
  #layers;
  #boxes = new Map();

  constructor(layers) {
    this.#layers = layers;
    byId("legend-list").replaceChildren(...LAYERS.map(([name, label, , note]) => this.#row(name, label, note)));
    byId("layers").addEventListener("click", () => this.open(byId("legend").hidden));
    byId("legend-close").addEventListener("click", () => this.open(false));
    addEventListener("keydown", (event) => {
      if (hasModifier(event)) return;
      const typing = isTyping(event) && !event.target.closest("#legend"); // its check boxes take no letters
      if (event.key === "l" && !typing) this.open(byId("legend").hidden, true);
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

  /** Lets a layer's box say whether the layer is shown. */
  update(name) {
    this.#boxes.get(name).checked = this.#layers.has(name);
  }

  /** Shows a layer's row only where there is something to show. */
  offer(name, there) {
    this.#boxes.get(name).closest("li").hidden = !there;
  }

  #row(name, label, note) {
    const box = make("input", { type: "checkbox", id: `layer-${name}` });
    box.checked = this.#layers.has(name);
    box.addEventListener("change", () => this.#layers.set(name, box.checked));
    box.addEventListener("keydown", ({ key }) => key === "Enter" && box.click()); // space stops the robot
    const swatch = make("i", { class: "swatch", "data-layer": name, "aria-hidden": "true" });
    const notes = note ? [make("small", {}, note)] : [];
    this.#boxes.set(name, box);
    return make("li", {}, box, make("label", { for: box.id }, swatch, label, ...notes));
  }
}
