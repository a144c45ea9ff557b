// Small pictures of the map, each around one robot. The floor is painted once, and all pictures are cut from it.

import { make } from "../dom.js";
import { SpriteCache } from "../map/cache.js";
import { FloorPlan, OccupancyGrid } from "../map/floor_plan.js";
import { readPalette, watchPalette } from "../map/palette.js";
import { drawRobot } from "../map/robots.js";
import { Camera } from "../map/view.js";

const ACROSS = 6; // m of the map across a picture, or less
const LEAST = 50; // px per m, so that the robots can be told from each other
const AROUND = 4; // m of painted floor around the map
const SHARP = 60; // px per m of the painted floor, where it does not get too large
const MAX_PIXELS = 16e6;
const TRAIL = 250; // newest points that are drawn
const LAYERS = ["map", "zones", "places", "grid"];
const OLD = 0.45; // opacity of a robot that does not report

const shown = (layer) => LAYERS.includes(layer);

/** The floor and the colours that all pictures share. */
export class SharedFloor {
  #plan = new FloorPlan();
  #text = "";
  #canvas = null; // null until it is needed
  #box = null;
  #scale = 0; // device pixels per m
  palette = readPalette();
  sprites = new SpriteCache();

  /** @param changed function(): all pictures have to be drawn anew */
  constructor(changed) {
    this.changed = changed;
    watchPalette(() => {
      this.palette = readPalette();
      this.sprites.clear();
      this.#renew();
    });
  }

  /** Takes the map of the server. @param {import("../messages.d.ts").Drawing | null} map */
  async adopt(map) {
    const text = JSON.stringify(map);
    if (text === this.#text) return;
    this.#text = text;
    const grids = await Promise.all((map?.cells ?? []).map((grid) => OccupancyGrid.read(grid)));
    if (text !== this.#text) return; // there is a newer one
    this.#plan = new FloorPlan(map, grids);
    this.#renew();
  }

  /** Draws the floor as `camera` sees it. */
  draw(context, camera, ratio) {
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.palette.floor;
    context.fillRect(0, 0, context.canvas.width, context.canvas.height);
    if (!this.#plan.bounds) {
      camera.apply(context, ratio);
      this.#plan.draw(context, camera, this.palette, ratio, shown);
      return;
    }
    this.#canvas ??= this.#paint(ratio);
    const { left, right, bottom, top } = camera.window;
    const k = this.#scale;
    const [x, y] = [(left - this.#box.left) * k, (this.#box.top - top) * k];
    context.drawImage(this.#canvas, x, y, (right - left) * k, (top - bottom) * k, 0, 0, context.canvas.width, context.canvas.height);
  }

  #renew() {
    this.#canvas = null;
    this.changed();
  }

  #paint(ratio) {
    const { left, right, bottom, top } = this.#plan.bounds;
    const box = { left: left - AROUND, right: right + AROUND, bottom: bottom - AROUND, top: top + AROUND };
    const [width, height] = [box.right - box.left, box.top - box.bottom];
    const scale = Math.min(SHARP, Math.sqrt(MAX_PIXELS / (width * height)) / ratio);
    const camera = Object.assign(new Camera(), {
      width: width * scale, height: height * scale, x: (box.left + box.right) / 2, y: (box.bottom + box.top) / 2, scale,
    });
    const canvas = make("canvas", { width: Math.ceil(camera.width * ratio), height: Math.ceil(camera.height * ratio) });
    const context = canvas.getContext("2d", { alpha: false });
    context.fillStyle = this.palette.floor;
    context.fillRect(0, 0, canvas.width, canvas.height);
    camera.apply(context, ratio);
    this.#plan.draw(context, camera, this.palette, ratio, shown);
    [this.#box, this.#scale] = [box, scale * ratio];
    return canvas;
  }
}

/** The picture around one robot: the floor, its trail, other robots nearby, and itself in the middle. */
export class SmallMap {
  canvas = make("canvas", { class: "small-map", "aria-hidden": "true" });
  #context = this.canvas.getContext("2d", { alpha: false });
  #camera = new Camera();
  #floor;
  #ratio = 1;
  #visible = true;

  /** @param floor SharedFloor @param changed function(): it has to be drawn anew */
  constructor(floor, changed) {
    this.#floor = floor;
    new ResizeObserver(([{ contentRect }]) => {
      this.#resize(contentRect);
      changed();
    }).observe(this.canvas);
    new IntersectionObserver(([{ isIntersecting }]) => {
      this.#visible = isIntersecting;
      changed();
    }).observe(this.canvas);
  }

  /**
   * Draws the picture, if it can be seen.
   * @param robot  Robot in the middle
   * @param placed [[Robot, pose]] of all robots
   * @param isLive function(Robot)
   */
  draw(robot, pose, placed, isLive) {
    if (!this.#visible || this.#camera.width < 2) return;
    const [context, camera, ratio] = [this.#context, this.#camera, this.#ratio];
    const { palette } = this.#floor;
    if (pose) Object.assign(camera, { x: pose.x, y: pose.y });
    this.#floor.draw(context, camera, ratio);
    if (!pose) return;
    camera.apply(context, ratio);
    drawTrail(context, camera, palette, robot.trail, pose);
    const { left, right, bottom, top } = camera.window;
    for (const [other, at] of placed) {
      if (other === robot || at.x < left - 1 || at.x > right + 1 || at.y < bottom - 1 || at.y > top + 1) continue;
      this.#drawRobot(other, at, palette.unselected, isLive(other));
    }
    this.#drawRobot(robot, pose, palette, isLive(robot));
  }

  #drawRobot({ shape }, pose, colours, live) {
    const [context, camera] = [this.#context, this.#camera];
    context.save();
    context.translate(pose.x, pose.y);
    context.rotate(pose.theta);
    if (!live) context.globalAlpha = OLD;
    drawRobot(context, camera, colours, { robot: shape, bumpers: null, ringed: false }, this.#floor.sprites, camera.scale * this.#ratio);
    context.restore();
  }

  #resize({ width, height }) {
    this.#ratio = Math.min(2, devicePixelRatio || 1);
    this.canvas.width = Math.round(width * this.#ratio);
    this.canvas.height = Math.round(height * this.#ratio);
    Object.assign(this.#camera, { width, height, scale: Math.max(width / ACROSS, LEAST) });
  }
}

function drawTrail(context, camera, palette, trail, pose) {
  context.beginPath();
  let drawing = false;
  for (let at = Math.max(0, trail.length - TRAIL); at < trail.length; at += 1) {
    const point = trail[at]; // null separates pieces
    if (point && drawing) context.lineTo(point[0], point[1]);
    else if (point) context.moveTo(point[0], point[1]);
    drawing = point !== null;
  }
  if (drawing) context.lineTo(pose.x, pose.y);
  context.strokeStyle = palette.trail;
  context.lineWidth = 2 / camera.scale;
  context.lineJoin = "round";
  context.globalAlpha = 0.8;
  context.stroke();
  context.globalAlpha = 1;
}
