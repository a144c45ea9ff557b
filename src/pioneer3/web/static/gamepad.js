// A gamepad -> Drive. Its stick counts while the deadman button is held; which button that is, and how
// fast it goes, the server says. A gamepad that goes, or a page that nobody looks at, lets go.

import { response } from "./response.js";

const LOOK = 20; // ms between two looks: browsers tell nothing of sticks and buttons by themselves
const INPUT = "gamepad";
const ACTS = ["stop", "emergency_stop", "reset"];

export class Gamepads {
  #hands;
  #acts;
  #changed;
  #scheme = null;
  #timer = 0;
  #down = null; // buttons by name, at the last look; null before the first
  #shown = "";

  /** Name of the gamepad that is there, or "". */
  name = "";
  /** Whether its buttons are where a standard gamepad's are: else nobody knows which is the deadman. */
  usable = false;

  /**
   * @param hands   {press, move, release}, those of Drive
   * @param acts    {stop, emergency_stop, reset}: functions
   * @param changed function(lost): another gamepad is there, or none; `lost` one that drove
   */
  constructor({ hands, acts, changed }) {
    this.#hands = hands;
    this.#acts = acts;
    this.#changed = changed;
    for (const name of ["gamepadconnected", "gamepaddisconnected"]) addEventListener(name, () => this.#watch());
  }

  /** Takes over which button does what, as the server says. */
  adopt(scheme) {
    this.#scheme = scheme;
    this.#watch();
  }

  #watch() {
    if (!this.#scheme) return;
    this.#look();
    if (this.name && !this.#timer) this.#timer = setInterval(() => this.#look(), LOOK);
  }

  #look() {
    const there = [...(navigator.getGamepads?.() ?? [])].filter((pad) => pad?.connected);
    const pad = there.find(({ mapping }) => mapping === "standard") ?? there[0] ?? null;
    this.#notice(pad);
    if (pad && this.usable) this.#read(pad);
  }

  /** Notes which gamepad is there; what the one before held is let go. */
  #notice(pad) {
    const key = pad ? `${pad.index} ${pad.id}` : "";
    if (key === this.#shown) return;
    const drove = Boolean(this.#down?.deadman);
    this.#shown = key;
    this.#down = null;
    this.name = pad?.id || (pad ? "Gamepad" : "");
    this.usable = pad?.mapping === "standard";
    this.#hands.release(INPUT);
    if (!pad) {
      clearInterval(this.#timer);
      this.#timer = 0;
    }
    this.#changed(drove);
  }

  #read({ axes, buttons }) {
    const scheme = this.#scheme;
    const pressed = (name) => buttons[scheme[name]]?.pressed ?? false;
    const before = this.#down;
    this.#down = Object.fromEntries(["deadman", ...ACTS].map((name) => [name, pressed(name)]));
    if (!before || !document.hasFocus()) return this.#hands.release(INPUT); // held before is not pressed now
    const fresh = (name) => this.#down[name] && !before[name];
    for (const act of ACTS) if (fresh(act)) this.#acts[act]();
    const limits = pressed("turbo")
      ? { speed: scheme.turbo_speed, turnRate: scheme.turbo_turn_rate }
      : { speed: scheme.speed, turnRate: scheme.turn_rate };
    const out = (axis) => response(-axes[axis], scheme.dead_zone); // sticks count down and right
    const wish = { forward: out(scheme.forward_axis), left: out(scheme.turn_axis), limits };
    if (fresh("deadman")) this.#hands.press("gamepad", INPUT, wish);
    else if (this.#down.deadman) this.#hands.move(INPUT, wish);
    else this.#hands.release(INPUT);
  }
}
