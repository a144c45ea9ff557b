// What of the picture is shown: each layer on or off, remembered on this device.

const KEY = "pioneer3.layers";

/** In the order of the legend: name, label, whether it is on at first. */
export const LAYERS = [
  ["map", "Walls and cells", true],
  ["places", "Goals, docks, homes", true],
  ["zones", "Forbidden, marked", true],
  ["things", "Boxes and people", true],
  ["names", "Names", true],
  ["trails", "Trails", true],
  ["paths", "Where it will be", true],
  ["targets", "Where it is going", true],
  ["sonar", "Sonar", true],
  ["laser", "Laser", false],
  ["bumpers", "Bumper hits", true],
  ["grid", "Grid", true],
];

export class Layers {
  #shown;

  /** @param changed function(name), after a layer was switched */
  constructor(changed) {
    this.changed = changed;
    const kept = remembered();
    this.#shown = Object.fromEntries(LAYERS.map(([name, , on]) => [name, typeof kept[name] === "boolean" ? kept[name] : on]));
  }

  has(name) {
    return this.#shown[name];
  }

  get all() {
    return { ...this.#shown };
  }

  set(name, on) {
    if (!(name in this.#shown) || this.#shown[name] === on) return;
    this.#shown[name] = on;
    try {
      localStorage.setItem(KEY, JSON.stringify(this.#shown));
    } catch {
      // a browser that keeps nothing: it is on or off until the page is closed
    }
    this.changed(name);
  }
}

function remembered() {
  try {
    return JSON.parse(localStorage.getItem(KEY)) ?? {};
  } catch {
    return {};
  }
}
