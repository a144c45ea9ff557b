// Driving by tilting the phone. It counts while a button is held, from the attitude at the press: tip the
// phone to drive, turn it to turn, flip it to stop. Attitudes are quaternions [w, x, y, z]: unlike the angles of
// the sensor, they are never ambiguous.

import { response } from "./stick.js";

const RADIANS = Math.PI / 180;
const DEAD = 5; // degrees
const FULL = 40; // degrees, full deflection
const EXPO = 0.3;
const FLIPPED = 60; // degrees about the long axis
const RECENT = 1000; // ms
const INPUT = "tilt";

const part = (angle) => response(angle / FULL, DEAD / FULL, EXPO);

/** Returns the command of a turn in the phone's frame: {forward, left}, or null for a flip. */
export function commandOf(turned, screenAngle) {
  const { tip, turn, flip } = meaning(turned, screenAngle);
  if (Math.abs(flip) > FLIPPED || Math.hypot(...turned) > 2 * FLIPPED) return null;
  return { forward: part(tip), left: part(turn) };
}

export class Tilt {
  #teleop;
  #element;
  #attitude = null; // the latest
  #heardAt = -Infinity;
  #finger = null; // {id, from, screenAngle}
  #listening = false;

  /**
   * @param element the button; its properties --x and --y place the knob, -1 to 1
   * @param teleop  Teleop
   */
  constructor(element, teleop) {
    this.#element = element;
    this.#teleop = teleop;
    element.addEventListener("pointerdown", (event) => this.#begin(event));
    element.addEventListener("pointerup", (event) => this.#end(event.pointerId) && teleop.release(INPUT));
    for (const taken of ["pointercancel", "lostpointercapture"]) {
      element.addEventListener(taken, (event) => this.#end(event.pointerId) && teleop.abandon());
    }
    element.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
  }

  /** Asks for permission to read the sensor, which iOS grants in a tap only. Returns whether it is granted. */
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

  /** Ends the hold, if any. */
  release() {
    this.#end(this.#finger?.id);
  }

  #begin(event) {
    if (this.#finger || (event.pointerType === "mouse" && event.button !== 0)) return;
    event.preventDefault();
    if (performance.now() - this.#heardAt > RECENT) {
      this.#teleop.notify("The sensor of this device is silent: move it a little, then press again.");
      return;
    }
    try {
      this.#element.setPointerCapture(event.pointerId);
    } catch {
      return; // lifted already
    }
    if (!this.#teleop.press("tilt", INPUT, { forward: 0, left: 0 })) return;
    const screenAngle = screen.orientation?.angle ?? window.orientation ?? 0;
    this.#finger = { id: event.pointerId, from: this.#attitude, screenAngle };
  }

  #turned({ alpha, beta, gamma }) {
    if (![alpha, beta, gamma].every(Number.isFinite)) return;
    this.#attitude = attitude(alpha, beta, gamma);
    this.#heardAt = performance.now();
    if (!this.#finger) return;
    const { id, from, screenAngle } = this.#finger;
    const command = commandOf(rotation(from, this.#attitude), screenAngle);
    if (command === null) {
      this.#end(id);
      this.#teleop.stop();
      this.#teleop.notify("Flipped: the robot stops.");
    } else if (this.#teleop.move(INPUT, command)) {
      this.#show(-command.left, -command.forward);
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

/** Returns the attitude of the angles of `deviceorientation`: alpha, beta, gamma [degrees] (W3C: Z-X'-Y''). */
export function attitude(alpha, beta, gamma) {
  const [z, x, y] = [alpha, beta, gamma].map((angle) => (angle * RADIANS) / 2);
  const about = (w, sin, axis) => [w, ...[0, 1, 2].map((i) => (i === axis ? sin : 0))];
  return product(
    product(about(Math.cos(z), Math.sin(z), 2), about(Math.cos(x), Math.sin(x), 0)),
    about(Math.cos(y), Math.sin(y), 1),
  );
}

/**
 * Returns the shortest turn from one attitude to another as a vector: its direction is the axis, in
 * the phone's own frame (x to the right, y to the top, z out of the screen), its length the angle [degrees].
 */
export function rotation(from, to) {
  const [w, ...axis] = product([from[0], -from[1], -from[2], -from[3]], to);
  const sine = Math.hypot(...axis);
  if (sine < 1e-9) return [0, 0, 0];
  const angle = (2 * Math.atan2(sine, Math.abs(w))) / RADIANS;
  const length = (Math.sign(w) || 1) * angle / sine;
  return axis.map((part) => part * length);
}

/**
 * Returns a turn as seen from in front of the screen [degrees]: `tip` the far edge down, `turn` to the left in
 * the plane of the screen, `flip` the left edge up.
 *
 * @param turned as `rotation` returns it
 * @param screenAngle `screen.orientation.angle`: 0 upright, 90 with the phone's top to the left [degrees]
 */
export function meaning([x, y, z], screenAngle) {
  const cos = Math.cos(screenAngle * RADIANS);
  const sin = Math.sin(screenAngle * RADIANS);
  return { tip: -(x * cos - y * sin), turn: z, flip: x * sin + y * cos };
}

function product([a, b, c, d], [e, f, g, h]) {
  return [
    a * e - b * f - c * g - d * h,
    a * f + b * e + c * h - d * g,
    a * g - b * h + c * e + d * f,
    a * h + b * g - c * f + d * e,
  ];
}
