// One robot of the page: its description, its latest data, and whether they are up to date.

import { PoseInterpolator } from "./interpolation.js";

const STALE = 1000; // ms without a snapshot
const STEP = 0.03; // m between trail points
const JUMP = 1.0; // m; a farther step is a new trail
const TRAIL = 3000; // points

export class Robot {
  /** Its part of the server's hello. @type {import("../messages.d.ts").ListedRobot} */
  hello;
  /** @type {import("../messages.d.ts").SnapshotMessage | null} */
  snapshot = null;
  /** @type {import("../messages.d.ts").Status | null} */
  status = null;
  /** Its place on the map and the rest of its way, as told last. @type {import("../messages.d.ts").Navigation | null} */
  navigation = null;
  /** The map that is being made with it, as told last. @type {import("../messages.d.ts").Mapping | null} */
  mapping = null;
  /** The calibration of it, as told last. @type {import("../messages.d.ts").CalibrationState | null} */
  calibration = null;
  /** Whether the user drags it in the editor: that leaves no trail. */
  lifted = false;
  /** Trail of [x, y] in the map; null separates pieces. */
  trail = [];
  #drawn;
  #snapshotAt = -Infinity;
  /** The last scans of its lasers as points of the map, together, or null. */
  points = null;
  #scans = new Map(); // points by the number of the laser
  #scannedAt = -Infinity;

  /** @param delay of the drawn pose [ms] */
  constructor(hello, delay) {
    this.hello = hello;
    this.#drawn = new PoseInterpolator(delay);
  }

  get id() {
    return this.hello.id;
  }

  get name() {
    return this.hello.name;
  }

  /** Outline, sonars and bumpers, or null before any robot has answered. */
  get shape() {
    return this.hello.shape;
  }

  takeHello(hello) {
    if (this.hello.url !== hello.url) this.clearTrail();
    this.hello = hello;
  }

  takeSnapshot(snapshot) {
    this.snapshot = snapshot;
    this.#snapshotAt = performance.now();
    this.moveTo(snapshot.robot_in_map);
    this.#leaveTrail(snapshot.robot_in_map);
  }

  /** @param {import("../messages.d.ts").LaserSweep} sweep */
  takeScan(sweep) {
    this.#scans.set(sweep.laser, pointsOf(sweep));
    this.points = joined([...this.#scans.values()]);
    this.#scannedAt = performance.now();
  }

  /** Whether the last scan is fresh. */
  get scanning() {
    return performance.now() - this.#scannedAt < STALE;
  }

  /** Moves the drawn robot to a pose, as reported by the robot or by the simulated world. */
  moveTo(pose) {
    this.#drawn.moveTo(pose, performance.now());
  }

  /** Marks all data as old; the picture stays. */
  expire() {
    this.status = null;
    this.#snapshotAt = -Infinity;
  }

  /** Forgets what belongs to another time of a replay. */
  forget() {
    this.clearTrail();
    this.navigation = null;
    this.#scans.clear();
    this.#scannedAt = -Infinity;
  }

  clearTrail() {
    this.trail.length = 0;
  }

  /** Where to draw it at `now` [ms], or null before the first snapshot. */
  poseAt(now) {
    return this.#drawn.at(now);
  }

  moving(now) {
    return this.#drawn.moving(now);
  }

  /** Whether the last snapshot is fresh. */
  get reporting() {
    return performance.now() - this.#snapshotAt < STALE;
  }

  /** The points of the way to its target as it is planned, [[x, y], ...], or null where it drives straight on. */
  get way() {
    const { target } = this.snapshot;
    const planned = (this.mapping?.exploring ? this.mapping.way : this.navigation?.way) ?? [];
    return planned.length || (this.hello.plans && !target.person) ? planned : null;
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

function joined(parts) {
  if (parts.length === 1) return parts[0];
  const all = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
  parts.reduce((at, part) => (all.set(part, at), at + part.length), 0);
  return all;
}

/** Returns the points of a scan in the map: [x, y, x, y, ...] [m]. */
function pointsOf({ sensor_in_map: [x_mm, y_mm, theta_mrad], first, step, ranges }) {
  const [x, y, theta] = [x_mm / 1000, y_mm / 1000, theta_mrad / 1000];
  const points = new Float32Array(2 * ranges.length);
  let count = 0;
  ranges.forEach((range_mm, number) => {
    if (range_mm === 0) return; // no echo
    const bearing = theta + first + number * step;
    points[count] = x + (range_mm / 1000) * Math.cos(bearing);
    points[count + 1] = y + (range_mm / 1000) * Math.sin(bearing);
    count += 2;
  });
  return points.subarray(0, count);
}
