// What the page knows: the latest message of each kind, and whether it may be trusted.

import { World } from "./world.js";

const STALE = 1000; // ms without a snapshot
const STEP = 0.03; // m between trail points
const JUMP = 1.0; // m; a farther step is a new trail
const TRAIL = 3000; // points

export class Model {
  hello = null;
  snapshot = null;
  status = null;
  socketOpen = false;
  world = new World();
  /** Whether the user holds the robot in the hand: that leaves no trail. */
  lifted = false;
  /** Trail of [x, y] in the map; null separates pieces. */
  trail = [];
  #snapshotAt = -Infinity;

  /** Takes in one message of the server. */
  receive(message) {
    if (message.type === "hello") this.#greet(message);
    else if (message.type === "status") this.status = message;
    else if (message.type === "snapshot") this.#see(message);
    else if (message.type === "world") this.world.receive(message);
  }

  /** A closed socket makes all that was known old news; the picture stays, greyed. */
  setSocket(open) {
    if (open === this.socketOpen) return;
    this.socketOpen = open;
    this.status = null;
    this.#snapshotAt = -Infinity;
  }

  clearTrail() {
    this.trail.length = 0;
  }

  /** Whether what the page shows is what the robot does now. */
  get live() {
    return this.socketOpen && this.robotConnected && (this.hearing || (this.world.paused && this.snapshot !== null));
  }

  /** Whether the robot has just been heard of. */
  get hearing() {
    return performance.now() - this.#snapshotAt < STALE;
  }

  get robotConnected() {
    return this.status === null || this.status.state === "connected";
  }

  /** Why a press does not drive, or null when it may. */
  get obstacle() {
    if (!this.socketOpen) return "Not connected to the driver.";
    if (!this.robotConnected) return "The robot is not connected.";
    if (!this.live) return "No news from the robot: driving blind is not possible.";
    if (this.snapshot.emergency_stop) return "Emergency stop: reset it before driving.";
    return null;
  }

  #greet(hello) {
    if (this.hello && this.hello.url !== hello.url) this.clearTrail();
    this.hello = hello;
  }

  #see(snapshot) {
    this.snapshot = snapshot;
    this.#snapshotAt = performance.now();
    const { x, y } = snapshot.pose;
    const last = this.trail.at(-1);
    if (this.lifted) {
      if (last) this.trail.push(null);
      return;
    }
    const distance = last ? Math.hypot(x - last[0], y - last[1]) : JUMP;
    if (distance < STEP) return;
    if (last && distance >= JUMP) this.trail.push(null);
    this.trail.push([x, y]);
    if (this.trail.length > TRAIL) this.trail.splice(0, this.trail.length - TRAIL);
  }
}
