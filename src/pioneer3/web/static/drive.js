// Held inputs -> requests. Sends a velocity while something is held, three zeros on release, then
// nothing, so that others can drive. Every other way out is `stop`. Nothing survives a stop: what
// is still held must be let go and pressed again: a press begins with a zero, which says that it is
// a fresh one. One source drives at a time; what one of a higher rank puts aside counts again only
// when it is pressed anew.

const PERIOD = 66; // ms, 15 Hz
const ZEROS = 3;
const RANK = { gamepad: 100, keyboard: 90, touch: 80, tilt: 80 }; // as in pioneer3.web.hands
const LASTING = { gamepad: 5, tilt: 15 }; // periods: what must be moved again and again, or is let go

export class Drive {
  #source = "touch"; // of all that is held
  #holds = new Map(); // input -> {wish, left}; periods, so that a page that stood still lets go of nothing
  #zeros = 0;
  #timer = 0;
  #send;
  #limits;
  #onChange;

  /**
   * @param send     function(message)
   * @param limits   function() -> {speed, turnRate}, the user's [m/s, rad/s]
   * @param onChange function(), after what is held has changed
   */
  constructor({ send, limits, onChange }) {
    this.#send = send;
    this.#limits = limits;
    this.#onChange = onChange;
  }

  /** What is asked for: {forward, left}, -1 to 1. Opposites held at once cancel. */
  get wish() {
    const wishes = [...this.#holds.values()].map(({ wish }) => wish);
    return { forward: joined(wishes.map(({ forward }) => forward)), left: joined(wishes.map(({ left }) => left)) };
  }

  /** Directions held now, a Set of "forward", "back", "left", "right". */
  get directions() {
    const { forward, left } = this.wish;
    const held = { forward: forward > 0, back: forward < 0, left: left > 0, right: left < 0 };
    return new Set(Object.keys(held).filter((direction) => held[direction]));
  }

  get holding() {
    return this.#holds.size > 0;
  }

  /** Whether this input is held. */
  holds(input) {
    return this.#holds.has(input);
  }

  /** What is driven with, or null. */
  get source() {
    return this.holding ? this.#source : null;
  }

  /** Whether requests are still being sent. */
  get active() {
    return this.holding || this.#zeros > 0;
  }

  /**
   * An input (a key, a finger) begins to hold. Says whether it does: it does not against a source
   * of the same rank or a higher one.
   *
   * @param source "gamepad", "keyboard", "touch" or "tilt"
   * @param wish   {forward, left}, -1 to 1, and maybe its own `limits`
   */
  press(source, input, wish) {
    if (this.#holds.has(input)) return true;
    if (this.holding && source !== this.#source) {
      if (RANK[source] <= RANK[this.#source]) return false;
      this.#holds.clear();
    }
    this.#source = source;
    if (!this.holding) this.#sendZero();
    this.#keep(input, wish);
    this.#zeros = 0;
    this.#request();
    this.#timer ||= setInterval(() => this.#tick(), PERIOD);
    this.#onChange();
    return true;
  }

  /** An input that is held asks for something else from now on. Says whether it still is. */
  move(input, wish) {
    if (!this.#holds.has(input)) return false;
    this.#keep(input, wish);
    return true;
  }

  /** An input lets go. Unknown inputs are ignored. */
  release(input) {
    if (!this.#holds.delete(input)) return;
    if (this.holding) this.#request();
    else this.#beginZeros();
    this.#onChange();
  }

  /** Lets go of everything as if the user had. */
  releaseAll() {
    if (!this.holding) return;
    this.#holds.clear();
    this.#beginZeros();
    this.#onChange();
  }

  /** Lets go of everything and says nothing: for when somebody else drives. */
  forget() {
    this.#holds.clear();
    this.#zeros = 0;
    clearInterval(this.#timer);
    this.#timer = 0;
    this.#onChange();
  }

  /** Lets go of everything and stops the robot, whoever drives it. */
  stop() {
    this.forget();
    this.#send({ type: "stop" });
  }

  #keep(input, wish) {
    this.#holds.set(input, { wish, left: LASTING[this.#source] ?? Infinity });
  }

  #beginZeros() {
    this.#zeros = ZEROS;
    this.#tick();
  }

  #tick() {
    for (const [input, hold] of this.#holds) if (hold.left-- <= 0) return this.release(input);
    if (this.holding) {
      this.#request();
    } else if (this.#zeros > 0) {
      this.#zeros -= 1;
      this.#sendZero();
    }
    if (!this.active) {
      clearInterval(this.#timer);
      this.#timer = 0;
    }
  }

  #sendZero() {
    this.#send({ type: "drive", v: 0, w: 0, input: this.#source });
  }

  #request() {
    const { forward, left } = this.wish;
    const [{ wish }] = this.#holds.values();
    const { speed, turnRate } = wish.limits ?? this.#limits();
    this.#send({ type: "drive", v: speed * forward, w: turnRate * left, input: this.#source });
  }
}

const joined = (parts) => Math.max(0, ...parts) + Math.min(0, ...parts);
