// Where a picture is taken from: world [m, y up] <-> canvas [CSS px, y down].

export class Camera {
  width = 1;
  height = 1;
  x = 0; // world point in the middle
  y = 0;
  scale = 60; // px per m

  toScreen(x, y) {
    return { x: this.width / 2 + (x - this.x) * this.scale, y: this.height / 2 - (y - this.y) * this.scale };
  }

  toWorld(px, py) {
    return { x: this.x + (px - this.width / 2) / this.scale, y: this.y - (py - this.height / 2) / this.scale };
  }

  /** Applies the camera to a context whose units are CSS pixels times `ratio`. */
  apply(context, ratio) {
    const k = this.scale * ratio;
    context.setTransform(k, 0, 0, -k, (this.width * ratio) / 2 - this.x * k, (this.height * ratio) / 2 + this.y * k);
  }

  /** Visible part of the world. */
  get window() {
    const { x: left, y: top } = this.toWorld(0, 0);
    const { x: right, y: bottom } = this.toWorld(this.width, this.height);
    return { left, right, bottom, top };
  }
}

const ZOOM_MIN = 2; // px per m
const ZOOM_MAX = 600;
const EASE = 0.09; // s, time constant of a camera move
const MARGIN = 40; // px around a fitted map
const BELOW = 24; // px more below, where the card of a goal begins
const CLOSE = 80; // px per m of a framed box at most
const PIECE = 2; // m
const BESIDE = 0.5; // m around the middle of a robot

export class View extends Camera {
  mode = "fit"; // "fit" | "follow" | "free" | "frame"
  #aside = 0; // px more on the right, where the buttons are
  #frame = null; // {box, around, top, bottom, before}: what the frame shows in the part that is free, and the mode before
  #bounds = null;
  #box = null; // around robots that are not within the bounds
  #boxed = ""; // the same as text
  #robot = { x: 0, y: 0 };
  #goal = null; // {x, y, scale}: where a move ends
  #still;

  constructor({ reducedMotion }) {
    super();
    this.#still = reducedMotion;
  }

  /** @param aside of the width, covered by the buttons on the right */
  resize(width, height, aside = 0) {
    this.width = width;
    this.height = height;
    this.#aside = aside;
    if (this.mode === "fit" || this.mode === "frame") this.#jump();
  }

  /**
   * Shows a box [m] in what `top` and `bottom` [px] leave free, until it is called with null; the user may move on.
   * @param room {around, top, bottom}: px around the box, and covered by other things
   */
  frame(box, { around = 0, top = 0, bottom = 0 } = {}) {
    const before = this.#frame;
    if (!box && before) {
      this.#frame = null;
      if (this.mode === "frame") this.setMode(before.before);
    }
    if (!box) return;
    const frame = { box, around, top, bottom, before: before?.before ?? this.mode };
    if (JSON.stringify(frame) === JSON.stringify(before)) return;
    this.#frame = frame;
    if (!before || this.mode === "frame") this.setMode("frame");
  }

  /** Where the map lies; `null` where there is none. */
  setBounds(bounds) {
    this.#bounds = bounds;
    if (this.mode === "fit") this.#jump();
  }

  /** Where all robots are: a fitted picture shows them, too. */
  setRobots(poses) {
    const bounds = this.#bounds;
    const box = around(bounds ? poses.filter((pose) => !within(bounds, pose)) : poses.length > 1 ? poses : []);
    const key = JSON.stringify(box);
    if (key === this.#boxed) return;
    const first = this.#boxed === "";
    [this.#boxed, this.#box] = [key, box];
    if (this.mode === "fit") first ? this.#jump() : this.setMode("fit");
  }

  /** The box that a fitted picture shows, or null. */
  get #whole() {
    return this.#bounds && this.#box ? joined(this.#bounds, this.#box) : this.#bounds ?? this.#box;
  }

  setRobot(pose) {
    this.#robot = pose;
    if (this.mode === "follow" || (this.mode === "fit" && !this.#whole)) {
      if (this.#goal) Object.assign(this.#goal, { x: pose.x, y: pose.y });
      else Object.assign(this, { x: pose.x, y: pose.y });
    }
  }

  /** Changes the mode; the camera moves there smoothly. */
  setMode(mode) {
    this.mode = mode;
    this.#goal = mode === "free" ? null : this.#target();
    if (this.#still()) this.#jump();
  }

  /** Follows, or when already following shows the map. */
  toggle() {
    this.setMode(this.mode === "follow" ? "fit" : "follow");
  }

  panBy(dx, dy) {
    this.#goal = null;
    this.mode = "free";
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
  }

  /** Zooms about a canvas point, or about the robot while following it. */
  zoomBy(factor, px = this.width / 2, py = this.height / 2) {
    this.#goal = null;
    const before = this.toWorld(px, py);
    this.scale = clamp(this.scale * factor, ZOOM_MIN, ZOOM_MAX);
    if (this.mode === "follow") return;
    this.mode = "free";
    const after = this.toWorld(px, py);
    this.x += before.x - after.x;
    this.y += before.y - after.y;
  }

  /** Advances a camera move by dt [s]; returns whether it goes on. */
  step(dt) {
    if (!this.#goal) return false;
    const k = 1 - Math.exp(-dt / EASE);
    this.x += (this.#goal.x - this.x) * k;
    this.y += (this.#goal.y - this.y) * k;
    this.scale *= (this.#goal.scale / this.scale) ** k;
    const off = Math.hypot(this.#goal.x - this.x, this.#goal.y - this.y) * this.scale;
    if (off < 0.5 && Math.abs(this.#goal.scale / this.scale - 1) < 0.002) this.#jump();
    return this.#goal !== null;
  }

  #jump() {
    Object.assign(this, this.#target());
    this.#goal = null;
  }

  #target() {
    if (this.mode === "free") return { x: this.x, y: this.y, scale: this.scale };
    if (this.mode === "frame") return this.#framed();
    const whole = this.#whole;
    if (this.mode === "follow" || !whole) {
      const scale = this.mode === "follow" ? Math.max(this.scale, 45) : Math.min(this.width, this.height) / 8;
      return { x: this.#robot.x, y: this.#robot.y, scale: clamp(scale, ZOOM_MIN, ZOOM_MAX) };
    }
    const { left, right, bottom, top } = whole;
    const fitting = Math.min(
      Math.max(40, this.width - 2 * MARGIN - this.#aside) / (right - left || 1),
      Math.max(40, this.height - 2 * MARGIN - BELOW) / (top - bottom || 1),
    );
    const scale = clamp(fitting, ZOOM_MIN, ZOOM_MAX / 4);
    return { x: (left + right + this.#aside / scale) / 2, y: (bottom + top - BELOW / scale) / 2, scale };
  }

  #framed() {
    const { box, around, top, bottom } = this.#frame;
    const free = Math.max(40, this.height - top - bottom);
    const room = (size) => Math.max(size / 2, size - 2 * around);
    const scale = clamp(Math.min(room(this.width) / (box.right - box.left || 1), room(free) / (box.top - box.bottom || 1)), ZOOM_MIN, CLOSE);
    return { x: (box.left + box.right) / 2, y: (box.bottom + box.top) / 2 + (top - bottom) / 2 / scale, scale };
  }
}

/** The box of whole pieces of the map around some poses, or null: it changes seldom while they drive. */
function around(poses) {
  if (poses.length === 0) return null;
  const [xs, ys] = [poses.map(({ x }) => x), poses.map(({ y }) => y)];
  const [low, high] = [(all) => PIECE * Math.floor((Math.min(...all) - BESIDE) / PIECE), (all) => PIECE * Math.ceil((Math.max(...all) + BESIDE) / PIECE)];
  return { left: low(xs), right: high(xs), bottom: low(ys), top: high(ys) };
}

const within = ({ left, right, bottom, top }, { x, y }) => x >= left && x <= right && y >= bottom && y <= top;
const joined = (a, b) => ({
  left: Math.min(a.left, b.left), right: Math.max(a.right, b.right), bottom: Math.min(a.bottom, b.bottom), top: Math.max(a.top, b.top),
});
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
