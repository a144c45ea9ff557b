// Held inputs become velocity commands. While an input is held, its velocity is sent again and again; on
// release, three zeros and then nothing, so that others can drive. `releaseAll` does the same for all inputs,
// `forget` sends nothing, and `stop` sends a stop. After a stop, an input that is still held must be released
// and pressed again. A press begins with a zero, which marks it as fresh. One source drives at a time; the
// inputs of a source that loses to one of higher priority count again only when they are pressed again.

const PERIOD = 66; // ms, 15 Hz
const ZEROS = 3;
const PRIORITY = { gamepad: 100, keyboard: 90, touch: 80, tilt: 80 }; // as on the server
const LIFETIME = { gamepad: 5, tilt: 15 }; // periods in which an input must be moved, or it is released

export class Drive {
  #source = "touch"; // of all held inputs
  #holds = new Map(); // input -> {command, periodsLeft}; a page that stands still uses up no periods
  #zeros = 0;
  #timer = 0;
  #send;
  #limits;
  #onChange;

  /**
   * @param send     function(message)
   * @param limits   function() -> {speed, turnRate}, the user's [m/s, rad/s]
   * @param onChange function(), after the held inputs have changed
   */
  constructor({ send, limits, onChange }) {
    this.#send = send;
    this.#limits = limits;
    this.#onChange = onChange;
  }

  /** The command of all held inputs: {forward, left}, -1 to 1. Opposites held at once cancel. */
  get command() {
    const commands = [...this.#holds.values()].map(({ command }) => command);
    return { forward: joined(commands.map(({ forward }) => forward)), left: joined(commands.map(({ left }) => left)) };
  }

  /** Directions held now, a Set of "forward", "back", "left", "right". */
  get directions() {
    const { forward, left } = this.command;
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

  /** The source that drives, or null. */
  get source() {
    return this.holding ? this.#source : null;
  }

  /** Whether requests are still being sent. */
  get active() {
    return this.holding || this.#zeros > 0;
  }

  /**
   * An input (a key, a finger) is pressed. Returns whether it is held now: it is not while a source of
   * the same or a higher priority drives.
   *
   * @param source "gamepad", "keyboard", "touch" or "tilt"
   * @param command {forward, left}, -1 to 1, and maybe its own `limits`
   */
  press(source, input, command) {
    if (this.#holds.has(input)) return true;
    if (this.holding && source !== this.#source) {
      if (PRIORITY[source] <= PRIORITY[this.#source]) return false;
      this.#holds.clear();
    }
    this.#source = source;
    if (!this.holding) this.#sendZero();
    this.#hold(input, command);
    this.#zeros = 0;
    this.#request();
    this.#timer ||= setInterval(() => this.#tick(), PERIOD);
    this.#onChange();
    return true;
  }

  /** A held input has another command from now on. Returns whether it is held. */
  move(input, command) {
    if (!this.#holds.has(input)) return false;
    this.#hold(input, command);
    return true;
  }

  /** An input is released. Unknown inputs are ignored. */
  release(input) {
    if (!this.#holds.delete(input)) return;
    if (this.holding) this.#request();
    else this.#beginZeros();
    this.#onChange();
  }

  /** Releases all inputs as if the user had. */
  releaseAll() {
    if (!this.holding) return;
    this.#holds.clear();
    this.#beginZeros();
    this.#onChange();
  }

  /** Releases all inputs and sends nothing: for when somebody else drives. */
  forget() {
    this.#holds.clear();
    this.#zeros = 0;
    clearInterval(this.#timer);
    this.#timer = 0;
    this.#onChange();
  }

  /**
   * Releases all inputs and stops the robot, whoever drives it. It is sent once, now or never: if it is lost, the
   * velocity expires all the same, and one that came late would stop somebody who drives by then.
   */
  stop() {
    this.forget();
    this.#send({ type: "stop" });
  }

  #hold(input, command) {
    this.#holds.set(input, { command, periodsLeft: LIFETIME[this.#source] ?? Infinity });
  }

  #beginZeros() {
    this.#zeros = ZEROS;
    this.#tick();
  }

  #tick() {
    for (const [input, hold] of this.#holds) if (hold.periodsLeft-- <= 0) return this.release(input);
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
    const { forward, left } = this.command;
    const [{ command }] = this.#holds.values();
    const { speed, turnRate } = command.limits ?? this.#limits();
    this.#send({ type: "drive", v: speed * forward, w: turnRate * left, input: this.#source });
  }
}

const joined = (parts) => Math.max(0, ...parts) + Math.min(0, ...parts);
