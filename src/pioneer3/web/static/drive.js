// Held inputs -> requests. Sends a velocity while something is held, three zeros on release, then
// nothing, so that others can drive. Every other way out is `stop`. Nothing survives a stop: what
// is still held must be let go and pressed again.

const PERIOD = 66; // ms, 15 Hz
const ZEROS = 3;

export class Drive {
  #holds = new Map(); // input -> directions
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

  /** Directions held now, a Set of "forward", "back", "left", "right". */
  get directions() {
    return new Set([...this.#holds.values()].flat());
  }

  get holding() {
    return this.#holds.size > 0;
  }

  /** Whether requests are still being sent. */
  get active() {
    return this.holding || this.#zeros > 0;
  }

  /** An input (a key, a finger) begins to hold directions. */
  press(input, directions) {
    if (this.#holds.has(input)) return;
    this.#holds.set(input, directions);
    this.#zeros = 0;
    this.#request();
    this.#timer ||= setInterval(() => this.#tick(), PERIOD);
    this.#onChange();
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

  #beginZeros() {
    this.#zeros = ZEROS;
    this.#tick();
  }

  #tick() {
    if (this.holding) {
      this.#request();
    } else if (this.#zeros > 0) {
      this.#zeros -= 1;
      this.#send({ type: "drive", v: 0, w: 0 });
    }
    if (!this.active) {
      clearInterval(this.#timer);
      this.#timer = 0;
    }
  }

  #request() {
    const held = this.directions;
    const { speed, turnRate } = this.#limits();
    this.#send({
      type: "drive",
      v: speed * (held.has("forward") - held.has("back")),
      w: turnRate * (held.has("left") - held.has("right")),
    });
  }
}
