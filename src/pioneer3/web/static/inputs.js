// Everything that can drive: the keyboard, what is chosen on the screen (stick, keys, tilt), gamepads.

import { ask } from "./access.js";
import { Gamepads } from "./gamepad.js";
import { listenToKeys } from "./keys.js";
import { listenToPad } from "./pad.js";
import { listenToStick } from "./stick.js";
import { Tilt } from "./tilt.js";

const byId = (id) => document.getElementById(id);
const WAYS = ["stick", "keys", "tilt"];
const CHOSEN = "pioneer3 way"; // in localStorage
const BY_TOUCH = matchMedia("(pointer: coarse)");

export class Inputs {
  #hands;
  #stick;
  #tilt;
  #gamepads;
  #way = "keys";
  #buttons = [...document.querySelectorAll(".key")];

  /** @param hands Hands: what the inputs do */
  constructor(hands) {
    this.#hands = hands;
    listenToKeys(hands);
    listenToPad(this.#buttons, hands);
    this.#stick = listenToStick(byId("stick"), hands);
    this.#tilt = new Tilt(byId("tilt-hold"), hands);
    const acts = { stop: hands.stop, emergency_stop: hands.emergencyStop, reset: hands.reset };
    this.#gamepads = new Gamepads({ hands, acts, changed: (lost) => this.#showGamepad(lost) });
    for (const way of WAYS) byId(`way-${way}`).addEventListener("click", () => this.#choose(way));
    byId("way-tilt").hidden = !(navigator.maxTouchPoints > 0 && BY_TOUCH.matches);
    this.#show(remembered() ?? (BY_TOUCH.matches ? "stick" : "keys"));
  }

  /** Takes over what the server says about gamepads. */
  adopt({ gamepad }) {
    this.#gamepads.adopt(gamepad);
  }

  /** How to drive from here, in words. */
  get hint() {
    if (this.#gamepads.usable) return "Hold L1 of the gamepad and move its left stick to drive.";
    if (!BY_TOUCH.matches) return `Hold an arrow key${this.#way === "stick" ? ", or the stick," : ""} to drive. Space stops.`;
    return HOLD[this.#way];
  }

  /** Shows what `drive` holds; what it does not hold any more is let go here as well. */
  show(drive) {
    const held = drive.directions;
    for (const { classList, dataset } of this.#buttons) {
      classList.toggle("held", dataset.go.split(" ").every((direction) => held.has(direction)));
    }
    for (const id of ["stick", "tilt-hold"]) byId(id).classList.toggle("held", drive.holds(INPUTS[id]));
    byId("gamepad").classList.toggle("held", drive.source === "gamepad");
    if (!drive.holds(INPUTS.stick)) this.#stick.letGo();
    if (!drive.holds(INPUTS["tilt-hold"])) this.#tilt.letGo();
  }

  async #choose(way) {
    this.#hands.letGo(); // what is held may go from under a finger
    const allowed = way !== "tilt" || (await this.#tilt.allow());
    this.#show(way);
    byId("tilt-hold").hidden = !allowed;
    byId("tilt-why").hidden = allowed;
    if (!allowed) byId("tilt-why").replaceChildren(...(await whyNoTilt()));
    if (way !== "tilt") remember(way); // tilting asks for permission anew, in a tap
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
    if (lost) this.#hands.complain("The gamepad is gone: the robot stops.");
  }
}

/** Returns in words and links why this page may not know how the phone is held, and what helps. */
async function whyNoTilt() {
  if (window.isSecureContext) return ["This browser was not allowed to say how the device is held, or cannot."];
  const { urls } = await ask("GET", "me").catch(() => ({ urls: [] }));
  const secure = urls.filter((each) => each.startsWith("https:"));
  const url = secure.find((each) => new URL(each).hostname === location.hostname) ?? secure[0];
  if (!url) return ["Browsers say how a phone is held over https only: start the robot with --lan."];
  const first = urls[0].startsWith("https:") ? [] : [" First trust ", link("/ca.crt", "its certificate"), "."];
  return ["Tilting needs https: pair at ", link(url, url.replace("https://", "")), ".", ...first];
}

const HOLD = {
  stick: "Hold the stick to drive; let go to stop.",
  keys: "Hold an arrow to drive; let go to stop.",
  tilt: "Hold the button and tip the phone to drive; let go to stop.",
};
const INPUTS = { stick: "stick", "tilt-hold": "tilt" };

function link(href, text) {
  const element = document.createElement("a");
  element.href = href;
  element.textContent = text;
  return element;
}

function remembered() {
  try {
    const way = localStorage.getItem(CHOSEN);
    return ["stick", "keys"].includes(way) ? way : null;
  } catch {
    return null; // storage may be forbidden
  }
}

function remember(way) {
  try {
    localStorage.setItem(CHOSEN, way);
  } catch {
    // then it is chosen anew the next time
  }
}
