// How the phone is held -> Drive. Counts while a button is held, from how the phone was held at the press:
// tip it to drive, turn it to turn, flip it to stop.

import { attitude, meaning, rotation } from "./attitude.js";
import { response } from "./response.js";

const DEAD = 5; // degrees
const ALL = 40; // degrees: so far is all the way
const GENTLE = 0.3;
const FLIPPED = 60; // degrees about the long axis
const RECENT = 1000; // ms
const INPUT = "tilt";

const part = (angle) => response(angle / ALL, DEAD / ALL, GENTLE);

/** Returns how far a turn in the phone's frame asks to go: {forward, left}, or null for a flip. */
export function wishOf(turned, screenAngle) {
  const { tip, turn, flip } = meaning(turned, screenAngle);
  if (Math.abs(flip) > FLIPPED || Math.hypot(...turned) > 2 * FLIPPED) return null;
  return { forward: part(tip), left: part(turn) };
}

export class Tilt {
  #hands;
  #element;
  #now = null; // the latest attitude
  #heardAt = -Infinity;
  #finger = null; // {id, from, screenAngle}
  #listening = false;

  /**
   * @param element what is held; its properties --x and --y say where to draw the knob, -1 to 1
   * @param hands   {press, move, release, abandon, stop, complain}
   */
  constructor(element, hands) {
    this.#element = element;
    this.#hands = hands;
    element.addEventListener("pointerdown", (event) => this.#begin(event));
    element.addEventListener("pointerup", (event) => this.#end(event.pointerId) && hands.release(INPUT));
    for (const taken of ["pointercancel", "lostpointercapture"]) {
      element.addEventListener(taken, (event) => this.#end(event.pointerId) && hands.abandon());
    }
    element.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
  }

  /** Asks to be told how the phone is held; iOS wants that in a tap. Says whether it may be. */
  async allow() {
    if (!window.isSecureContext || !("DeviceOrientationEvent" in window)) return false;
    try {
      const answer = await DeviceOrientationEvent.requestPermission?.();
      if (answer === "denied") return false;
    } catch {
      return false;
    }
    if (!this.#listening) addEventListener("deviceorientation", (event) => this.#turned(event));
    this.#listening = true;
    return true;
  }

  /** Ends the hold, if any: somebody stopped it. */
  letGo() {
    this.#end(this.#finger?.id);
  }

  #begin(event) {
    if (this.#finger || (event.pointerType === "mouse" && event.button !== 0)) return;
    event.preventDefault();
    if (performance.now() - this.#heardAt > RECENT) {
      this.#hands.complain("The sensor of this device is silent: move it a little, then press again.");
      return;
    }
    try {
      this.#element.setPointerCapture(event.pointerId);
    } catch {
      return; // lifted already
    }
    if (!this.#hands.press("tilt", INPUT, { forward: 0, left: 0 })) return;
    const screenAngle = screen.orientation?.angle ?? window.orientation ?? 0;
    this.#finger = { id: event.pointerId, from: this.#now, screenAngle };
  }

  #turned({ alpha, beta, gamma }) {
    if (![alpha, beta, gamma].every(Number.isFinite)) return;
    this.#now = attitude(alpha, beta, gamma);
    this.#heardAt = performance.now();
    if (!this.#finger) return;
    const { id, from, screenAngle } = this.#finger;
    const wish = wishOf(rotation(from, this.#now), screenAngle);
    if (wish === null) {
      this.#end(id);
      this.#hands.stop();
      this.#hands.complain("Flipped: the robot stops.");
    } else if (this.#hands.move(INPUT, wish)) {
      this.#show(-wish.left, -wish.forward);
    } else {
      this.#end(id);
    }
  }

  #end(id) {
    if (!this.#finger || this.#finger.id !== id) return false;
    this.#finger = null;
    this.#show(0, 0);
    return true;
  }

  #show(x, y) {
    this.#element.style.setProperty("--x", x.toFixed(3));
    this.#element.style.setProperty("--y", y.toFixed(3));
  }
}
