// One robot of the page: what it is, the latest it has said, and whether that may be trusted.

import { pointsOf } from "./draw_laser.js";
import { Glide } from "./glide.js";

const STALE = 1000; // ms without a snapshot
const STEP = 0.03; // m between trail points
const JUMP = 1.0; // m; a farther step is a new trail
const TRAIL = 3000; // points

export class Robot {
  /** {id, name, connection, url, robot: its shape, limits}, as the server tells it. */
  hello;
  snapshot = null;
  status = null;
  /** Whether the user holds the robot in the hand: that leaves no trail. */
  lifted = false;
  /** Trail of [x, y] in the map; null separates pieces. */
  trail = [];
  #glide = new Glide();
  #snapshotAt = -Infinity;
  /** What its laser saw last, as points of the map, or null. */
  points = null;
  #scannedAt = -Infinity;

  constructor(hello) {
    this.hello = hello;
  }

  get id() {
    return this.hello.id;
  }

  get name() {
    return this.hello.name;
  }

  /** Outline, sonars and bumpers, or null before any robot has answered. */
  get shape() {
    return this.hello.robot;
  }

  greet(hello) {
    if (this.hello.url !== hello.url) this.clearTrail();
    this.hello = hello;
  }

  see(snapshot) {
    this.snapshot = snapshot;
    this.#snapshotAt = performance.now();
    this.place(snapshot.pose);
    this.#leaveTrail(snapshot.pose);
  }

  /** Its laser has seen something. */
  scan(sweep) {
    this.points = pointsOf(sweep);
    this.#scannedAt = performance.now();
  }

  /** Whether its laser has just seen something. */
  get scanning() {
    return performance.now() - this.#scannedAt < STALE;
  }

  /** It is there now, whoever says so. */
  place(pose) {
    this.#glide.aim(pose, performance.now());
  }

  /** All that was known is old news; the picture stays. */
  forget() {
    this.status = null;
    this.#snapshotAt = -Infinity;
  }

  clearTrail() {
    this.trail.length = 0;
  }

  /** Where to draw it at `now` [ms], or null before the first snapshot. */
  poseAt(now) {
    return this.#glide.at(now);
  }

  moving(now) {
    return this.#glide.moving(now);
  }

  /** Whether it has just been heard of. */
  get hearing() {
    return performance.now() - this.#snapshotAt < STALE;
  }

  get connected() {
    return this.status === null || this.status.state === "connected";
  }

  #leaveTrail({ x, y }) {
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
