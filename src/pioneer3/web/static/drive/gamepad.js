// Gamepads. The stick counts while the deadman button is held. The server says which button that is, and how
// fast the robot goes. A gamepad that is unplugged, or a page without the focus, releases the stick.

import { response } from "./stick.js";

const PERIOD = 20; // ms between two polls: browsers send no events of sticks and buttons
const INPUT = "gamepad";
const ACTS = ["stop", "emergency_stop", "reset"];

export class Gamepads {
  #teleop;
  #acts;
  #changed;
  #scheme = null;
  #timer = 0;
  #down = null; // name of a button -> whether it was pressed at the last poll; null before the first
  #shown = "";

  /** Name of the gamepad, or "" for none. */
  name = "";
  /** Whether it has the standard layout: else the deadman button is not known. */
  usable = false;

  /**
   * @param teleop  {press, move, release}
   * @param acts    {stop, emergency_stop, reset}: functions
   * @param changed function(lost): the gamepad has changed, `lost` if one that drove is gone
   */
  constructor({ teleop, acts, changed }) {
    this.#teleop = teleop;
    this.#acts = acts;
    this.#changed = changed;
    for (const name of ["gamepadconnected", "gamepaddisconnected"]) addEventListener(name, () => this.#watch());
  }

  /** Takes the layout of buttons and axes from the server. */
  adopt(scheme) {
    this.#scheme = scheme;
    this.#watch();
  }

  #watch() {
    if (!this.#scheme) return;
    this.#poll();
    if (this.name && !this.#timer) this.#timer = setInterval(() => this.#poll(), PERIOD);
  }

  #poll() {
    const there = [...(navigator.getGamepads?.() ?? [])].filter((pad) => pad?.connected);
    const pad = there.find(({ mapping }) => mapping === "standard") ?? there[0] ?? null;
    this.#select(pad);
    if (pad && this.usable) this.#read(pad);
  }

  /** Takes another gamepad, or none; the inputs of the one before are released. */
  #select(pad) {
    const key = pad ? `${pad.index} ${pad.id}` : "";
    if (key === this.#shown) return;
    const drove = Boolean(this.#down?.deadman);
    this.#shown = key;
    this.#down = null;
    this.name = pad?.id || (pad ? "Gamepad" : "");
    this.usable = pad?.mapping === "standard";
    this.#teleop.release(INPUT);
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
    if (!before || !document.hasFocus()) return this.#teleop.release(INPUT); // a button that was held before is no press
    const fresh = (name) => this.#down[name] && !before[name];
    for (const act of ACTS) if (fresh(act)) this.#acts[act]();
    const limits = pressed("turbo")
      ? { speed: scheme.turbo_speed, turnRate: scheme.turbo_turn_rate }
      : { speed: scheme.speed, turnRate: scheme.turn_rate };
    const out = (axis) => response(-axes[axis], scheme.dead_zone); // sticks count down and right
    const command = { forward: out(scheme.forward_axis), left: out(scheme.turn_axis), limits };
    if (fresh("deadman")) this.#teleop.press("gamepad", INPUT, command);
    else if (this.#down.deadman) this.#teleop.move(INPUT, command);
    else this.#teleop.release(INPUT);
  }
}
