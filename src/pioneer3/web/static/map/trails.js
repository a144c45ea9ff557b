// The trails of robots: a cached picture, and the newest points drawn on top.

import { CachedPicture } from "./cache.js";

const PIECES = 10; // shades from old to new
const SHORT = 600; // points of a robot that is not selected
const TAIL = 600; // points drawn on top; when there are more, the picture is made anew

export class Trails {
  #picture = new CachedPicture((context, camera) => this.#paint(context, camera));
  #ends = new Map(); // Robot -> the last point in the picture
  #version = 0;
  #robots = [];
  #selected = null;
  #palette = null;

  /**
   * In world coordinates; returns whether it should be drawn once more to be sharp.
   * @param placed [[Robot, pose]]
   */
  draw(context, view, palette, placed, { selected, ratio, now }) {
    if (this.#selected !== selected || this.#palette !== palette) this.#version += 1;
    this.#selected = selected;
    this.#palette = palette;
    this.#robots = placed;
    if (this.#tails() > TAIL) this.#version += 1;
    const again = this.#picture.draw(context, view, ratio, this.#version, now);
    view.apply(context, ratio);
    prepare(context, view, palette);
    context.globalAlpha = 0.9;
    for (const [robot, pose] of placed) this.#drawTail(context, robot, pose);
    context.globalAlpha = 1;
    return again;
  }

  /** How many points are not in the picture. */
  #tails() {
    let count = 0;
    for (const [robot] of this.#robots) {
      const from = this.#tailOf(robot);
      if (from < 0) return Infinity; // the trail was cleared, or is new
      count += robot.trail.length - 1 - from;
    }
    return count;
  }

  /** Index of the last point in the picture, -1 if there is none. */
  #tailOf(robot) {
    const end = this.#ends.get(robot);
    if (robot.trail.length === 0) return end ? -1 : 0;
    return robot.trail.lastIndexOf(end);
  }

  #drawTail(context, robot, pose) {
    const { trail, lifted } = robot;
    if (trail.length === 0) return;
    context.beginPath();
    let drawing = false;
    for (let at = Math.max(0, this.#tailOf(robot)); at < trail.length; at += 1) {
      drawing = step(context, trail[at], drawing);
    }
    if (drawing && !lifted) context.lineTo(pose.x, pose.y);
    context.stroke();
  }

  #paint(context, camera) {
    this.#ends.clear();
    prepare(context, camera, this.#palette);
    for (const [robot] of this.#robots) {
      const { trail } = robot;
      this.#ends.set(robot, trail.findLast((point) => point !== null) ?? null);
      const first = robot === this.#selected ? 0 : Math.max(0, trail.length - SHORT);
      drawFading(context, trail, first);
    }
    context.globalAlpha = 1;
  }
}

function prepare(context, view, palette) {
  context.strokeStyle = palette.trail;
  context.lineWidth = 2.5 / view.scale;
  context.lineCap = "butt";
  context.lineJoin = "round";
}

function drawFading(context, trail, first) {
  const size = Math.max(1, Math.ceil((trail.length - first) / PIECES));
  for (let from = first; from < trail.length; from += size) {
    const to = Math.min(trail.length - 1, from + size);
    context.globalAlpha = 0.12 + (0.78 * (to - first + 1)) / (trail.length - first);
    context.beginPath();
    let drawing = false;
    for (let at = from; at <= to; at += 1) drawing = step(context, trail[at], drawing);
    context.stroke();
  }
}

/** One point further; null separates pieces. Returns whether a line may go on from here. */
function step(context, point, drawing) {
  if (point === null) return false;
  if (drawing) context.lineTo(point[0], point[1]);
  else context.moveTo(point[0], point[1]);
  return true;
}
