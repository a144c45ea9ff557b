// The camera: it orbits a point, follows the selected robot, or sees as the robot does.

import { OrbitControls, PerspectiveCamera, Vector3 } from "../vendor/three-0.187.0/three.js";

const WIDE = 50; // degrees, upwards
const EYES = { height: 0.55, back: 0.05, ahead: 4, down: 0.75 }; // m: a little above a Pioneer, so that its deck is seen
const STEEP = (52 * Math.PI) / 180; // of the view of all, above the floor
const BEHIND = 1.9; // m behind a robot that is followed, and
const ABOVE = 1.25; // m above it
const EASE = 0.15; // s, time constant of a camera move

export class Camera3d {
  mode = "fit"; // "fit" | "follow" | "eyes" | "free"
  camera = new PerspectiveCamera(WIDE, 1, 0.05, 500);
  #controls;
  #still;
  #box = null;
  #pose = null;
  #goal = null; // {eye, at}: where a move ends

  /** @param changed function(), after the user has moved the camera */
  constructor(canvas, { changed, still }) {
    this.camera.up.set(0, 0, 1);
    this.#still = still;
    this.#controls = new OrbitControls(this.camera, canvas); // it has no keys: they drive the robot
    Object.assign(this.#controls, { enableDamping: false, maxPolarAngle: 0.49 * Math.PI, minDistance: 0.6, maxDistance: 150, zoomToCursor: true });
    this.#controls.addEventListener("start", () => (this.#goal = null));
    this.#controls.addEventListener("change", changed);
    this.#controls.addEventListener("end", () => this.mode === "fit" && ((this.mode = "free"), changed()));
  }

  resize(width, height) {
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.mode === "fit") this.#jump();
  }

  /** What the view of all shows: {left, right, bottom, top} [m]. */
  setBounds(box) {
    const same = JSON.stringify(box) === JSON.stringify(this.#box);
    this.#box = box;
    if (!same && this.mode === "fit") this.#jump();
  }

  setRobot(pose) {
    const before = this.#pose;
    this.#pose = pose;
    if (!pose) return;
    if (this.mode === "eyes") this.#jump();
    if (this.mode !== "follow" || !before) return;
    const by = new Vector3(pose.x - before.x, pose.y - before.y, pose.z - before.z);
    for (const point of this.#goal ? [this.#goal.eye, this.#goal.at] : [this.camera.position, this.#controls.target]) point.add(by);
    this.#controls.update();
  }

  setMode(mode) {
    const before = this.mode;
    if (!this.#pose && mode !== "fit") return;
    this.mode = mode;
    this.#controls.enabled = mode !== "eyes";
    this.#controls.enablePan = mode !== "follow";
    this.#goal = this.#target();
    if (mode === "eyes" || before === "eyes" || this.#still()) this.#jump();
  }

  toggle() {
    this.setMode(this.mode === "follow" ? "fit" : "follow");
  }

  zoomBy(factor) {
    this.#goal = null;
    if (this.mode === "eyes") return;
    const { target } = this.#controls;
    const away = this.camera.position.clone().sub(target);
    this.camera.position.copy(target).add(away.setLength(Math.min(150, Math.max(0.6, away.length() / factor))));
    if (this.mode === "fit") this.mode = "free";
    this.#controls.update();
  }

  /** Advances a camera move by dt [s]; returns whether it goes on. */
  step(dt) {
    if (!this.#goal) return false;
    const k = 1 - Math.exp(-dt / EASE);
    this.camera.position.lerp(this.#goal.eye, k);
    this.#controls.target.lerp(this.#goal.at, k);
    if (this.camera.position.distanceTo(this.#goal.eye) < 0.01) this.#jump();
    this.#controls.update();
    return this.#goal !== null;
  }

  #jump() {
    const goal = this.#target();
    this.#goal = null;
    if (!goal) return;
    this.camera.position.copy(goal.eye);
    this.#controls.target.copy(goal.at);
    if (this.mode === "eyes") this.camera.lookAt(goal.at);
    else this.#controls.update();
  }

  #target() {
    if (this.mode === "free") return null;
    const robot = this.#pose;
    if (this.mode === "fit" || !robot) return this.#overview();
    const [c, s] = [Math.cos(robot.theta), Math.sin(robot.theta)];
    const ahead = (far, height) => new Vector3(robot.x + far * c, robot.y + far * s, robot.z + height);
    if (this.mode === "eyes") return { eye: ahead(-EYES.back, EYES.height), at: ahead(EYES.ahead, EYES.height - EYES.down) };
    return { eye: ahead(-BEHIND, ABOVE), at: ahead(0.4, 0.2) };
  }

  /** From the south, so far away that all of the box is in the picture. */
  #overview() {
    const { left, right, bottom, top } = this.#box ?? around(this.#pose);
    const middle = new Vector3((left + right) / 2, (bottom + top) / 2, 0);
    const half = (WIDE * Math.PI) / 360;
    const wide = (right - left) / 2 / (Math.tan(half) * this.camera.aspect) + ((top - bottom) / 2) * Math.cos(STEEP);
    const high = ((top - bottom) / 2) * (Math.sin(STEEP) / Math.tan(half) + Math.cos(STEEP));
    const far = 1.06 * Math.max(wide, high, 3);
    return { eye: middle.clone().add(new Vector3(0, -far * Math.cos(STEEP), far * Math.sin(STEEP))), at: middle };
  }

  dispose() {
    this.#controls.dispose();
  }
}

const around = (pose) => ({ left: (pose?.x ?? 0) - 3, right: (pose?.x ?? 0) + 3, bottom: (pose?.y ?? 0) - 3, top: (pose?.y ?? 0) + 3 });
