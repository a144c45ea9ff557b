// The two sliders: how fast the user wants to drive, never above what the server allows.

const MINIMUM = 0.05;

export class Limits {
  #speed = new Slider("speed", "m/s");
  #turn = new Slider("turn", "rad/s");
  #known = "";

  /** Takes over the server's limits; keeps the user's choice unless they changed. */
  adopt(limits) {
    const key = JSON.stringify(limits);
    if (key === this.#known) return;
    this.#known = key;
    this.#speed.adopt(limits.speed, limits.default_speed);
    this.#turn.adopt(limits.turn_rate, limits.default_turn_rate);
  }

  get values() {
    return { speed: this.#speed.value, turnRate: this.#turn.value };
  }
}

class Slider {
  #input;
  #output;
  #unit;
  #byKey = false;

  constructor(id, unit) {
    this.#input = document.getElementById(id);
    this.#output = document.getElementById(`${id}-out`);
    this.#unit = unit;
    this.#input.addEventListener("input", () => this.#show());
    this.#input.addEventListener("pointerdown", () => (this.#byKey = false));
    this.#input.addEventListener("keydown", (event) => {
      this.#byKey = true;
      if (event.key === "Enter" || event.key === "Escape") this.#input.blur();
    });
    // Gives the arrow keys back to driving, except to somebody who sets the slider with them.
    this.#input.addEventListener("change", () => this.#byKey || this.#input.blur());
  }

  get value() {
    return this.#input.disabled ? 0 : this.#input.valueAsNumber;
  }

  adopt(maximum, start) {
    this.#input.min = Math.min(MINIMUM, maximum);
    this.#input.max = maximum;
    this.#input.value = Math.min(start, maximum);
    this.#input.disabled = false;
    this.#show();
  }

  #show() {
    const { min, max, valueAsNumber: value } = this.#input;
    this.#output.textContent = `${value.toFixed(2)} ${this.#unit}`;
    this.#input.style.setProperty("--filled", `${(100 * (value - min)) / (max - min || 1)}%`);
    this.#input.setAttribute("aria-valuetext", this.#output.textContent);
  }
}
