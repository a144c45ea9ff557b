// All inputs: the keyboard, the chosen control on the screen (stick, keys, tilt), gamepads; and the two sliders
// that limit speed and turn rate.

import { byId, make, recall, remember } from "../dom.js";
import { ask } from "../http.js";
import { Gamepads } from "./gamepad.js";
import { listenToKeys, listenToPad } from "./keys.js";
import { listenToStick } from "./stick.js";
import { Tilt } from "./tilt.js";

const WAYS = ["stick", "keys", "tilt"];
const CHOSEN = "pioneer3 way"; // in localStorage
const BY_TOUCH = matchMedia("(pointer: coarse)");
const LEAST_LIMIT = 0.05; // m/s, rad/s

const HINTS = {
  stick: "Hold the stick to drive; let go to stop.",
  keys: "Hold an arrow to drive; let go to stop.",
  tilt: "Hold the button and tip the phone to drive; let go to stop.",
};
const AGAIN = { stick: "Hold the stick to drive.", keys: "Press an arrow to drive.", tilt: "Hold the button to drive." };
const INPUTS = { stick: "stick", "tilt-hold": "tilt" };

export class Inputs {
  #teleop;
  #stick;
  #tilt;
  #gamepads;
  #way = "keys";
  #buttons = [...document.querySelectorAll(".key")];

  /** @param teleop Teleop */
  constructor(teleop) {
    this.#teleop = teleop;
    listenToKeys(teleop);
    listenToPad(this.#buttons, teleop);
    this.#stick = listenToStick(byId("stick"), teleop);
    this.#tilt = new Tilt(byId("tilt-hold"), teleop);
    const acts = { stop: teleop.stop, emergency_stop: teleop.emergencyStop, reset: teleop.reset };
    this.#gamepads = new Gamepads({ teleop, acts, changed: (lost) => this.#showGamepad(lost) });
    for (const way of WAYS) byId(`way-${way}`).addEventListener("click", () => this.#choose(way));
    byId("way-tilt").hidden = !(navigator.maxTouchPoints > 0 && BY_TOUCH.matches);
    this.#show(chosen() ?? (BY_TOUCH.matches ? "stick" : "keys"));
  }

  /** Takes the layout of gamepads from the server's hello. */
  adopt({ gamepad }) {
    this.#gamepads.adopt(gamepad);
  }

  /** How to drive from here, in words. */
  get hint() {
    if (this.#gamepads.usable) return "Hold L1 of the gamepad and move its left stick to drive.";
    if (!BY_TOUCH.matches) return `Hold an arrow key${this.#way === "stick" ? ", or the stick," : ""} to drive. Space stops.`;
    return HINTS[this.#way];
  }

  /** How to drive on after a stop, in words. */
  get again() {
    return AGAIN[BY_TOUCH.matches ? this.#way : "keys"];
  }

  /** Shows the inputs that `drive` holds, and releases the others. */
  show(drive) {
    const held = drive.directions;
    for (const { classList, dataset } of this.#buttons) {
      classList.toggle("held", dataset.go.split(" ").every((direction) => held.has(direction)));
    }
    for (const id of ["stick", "tilt-hold"]) byId(id).classList.toggle("held", drive.holds(INPUTS[id]));
    byId("gamepad").classList.toggle("held", drive.source === "gamepad");
    if (!drive.holds(INPUTS.stick)) this.#stick.release();
    if (!drive.holds(INPUTS["tilt-hold"])) this.#tilt.release();
  }

  async #choose(way) {
    this.#teleop.releaseAll(); // a held control may vanish from under a finger
    const allowed = way !== "tilt" || (await this.#tilt.allow());
    this.#show(way);
    byId("tilt-hold").hidden = !allowed;
    byId("tilt-why").hidden = allowed;
    if (!allowed) byId("tilt-why").replaceChildren(...(await whyNoTilt()));
    if (way !== "tilt") remember(CHOSEN, way); // tilting needs a new permission, in a tap
  }

  #show(way) {
    this.#way = way;
    for (const each of WAYS) {
      byId(`way-${each}`).setAttribute("aria-pressed", String(each === way));
      byId(each).hidden = each !== way;
    }
  }

  #showGamepad(lost) {
    const { name, usable } = this.#gamepads;
    byId("gamepad").hidden = !name;
    byId("gamepad").title = name;
    byId("gamepad").textContent = usable ? "Gamepad: hold L1" : "Gamepad of an unknown layout";
    if (lost) this.#teleop.notify("The gamepad is gone: the robot stops.");
  }
}

/** Returns, as texts and links, the reason why this page may not read the sensor, and the remedy. */
async function whyNoTilt() {
  if (window.isSecureContext) return ["This browser was not allowed to say how the device is held, or cannot."];
  const { urls } = await ask("GET", "me").catch(() => ({ urls: [] }));
  const secure = urls.filter((each) => each.startsWith("https:"));
  const url = secure.find((each) => new URL(each).hostname === location.hostname) ?? secure[0];
  if (!url) return ["Browsers say how a phone is held over https only: start the robot with --lan."];
  const first = urls[0].startsWith("https:") ? [] : [" First trust ", link("/ca.crt", "its certificate"), "."];
  return ["Tilting needs https: pair at ", link(url, url.replace("https://", "")), ".", ...first];
}

const link = (href, text) => make("a", { href }, text);

function chosen() {
  const way = recall(CHOSEN);
  return ["stick", "keys"].includes(way) ? way : null;
}

/** The two sliders: how fast the user wants to drive, never above the server's limits. */
export class Limits {
  #speed = new Slider("speed", "m/s");
  #turn = new Slider("turn", "rad/s");
  #known = "";

  /** Takes the server's limits; keeps the user's choice unless they have changed. */
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
    this.#input = byId(id);
    this.#output = byId(`${id}-out`);
    this.#unit = unit;
    this.#input.addEventListener("input", () => this.#show());
    this.#input.addEventListener("pointerdown", () => (this.#byKey = false));
    this.#input.addEventListener("keydown", (event) => {
      this.#byKey = true;
      if (event.key === "Enter" || event.key === "Escape") this.#input.blur();
    });
    // returns the arrow keys to driving, unless they set the slider
    this.#input.addEventListener("change", () => this.#byKey || this.#input.blur());
  }

  get value() {
    return this.#input.disabled ? 0 : this.#input.valueAsNumber;
  }

  adopt(maximum, start) {
    this.#input.min = Math.min(LEAST_LIMIT, maximum);
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
