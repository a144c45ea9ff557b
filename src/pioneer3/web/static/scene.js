// The picture: draws the model through the view, only when something has changed.

import { Floor, drawGrid, drawScale } from "./draw_map.js";
import { drawGhost, drawSelection } from "./draw_edit.js";
import { drawPath, drawTrail } from "./draw_motion.js";
import { drawRobot } from "./draw_robot.js";
import { drawSonar } from "./draw_sonar.js";
import { byLayer, drawNames, drawThing } from "./draw_things.js";
import { Glide } from "./glide.js";
import { readPalette } from "./palette.js";

export class Scene {
  #canvas;
  #context;
  #backdrop = document.createElement("canvas"); // grid and walls of a camera at rest
  #backdropKey = "";
  #lastKey = "";
  #version = 0; // counts changes of map and theme
  #floor = new Floor();
  #map = "";
  #glide = new Glide();
  #palette = readPalette();
  #ratio = 1;
  #frame = 0;
  #then = 0;
  #model;

  /** Pose drawn last, or null. */
  pose = null;
  /** What is selected and dragged, {thing, ghost}. */
  editor = { thing: undefined, ghost: null };

  constructor(canvas, view, model) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d", { alpha: false });
    this.view = view;
    this.#model = model;
    new ResizeObserver(() => this.#resize()).observe(canvas);
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.#recolour());
    matchMedia("(prefers-contrast: more)").addEventListener("change", () => this.#recolour());
  }

  get ratio() {
    return this.#ratio;
  }

  /** The map may have changed. */
  adoptMap(map) {
    const text = JSON.stringify(map);
    if (text === this.#map) return;
    this.#map = text;
    this.#floor = new Floor(map?.walls);
    this.#version += 1;
    this.view.setBounds(this.#floor.bounds);
    this.invalidate();
  }

  adoptPose(pose) {
    this.#glide.aim(pose, performance.now());
    this.invalidate();
  }

  /** Asks for one more frame. */
  invalidate() {
    this.#frame ||= requestAnimationFrame((now) => this.#draw(now));
  }

  #recolour() {
    this.#palette = readPalette();
    this.#version += 1;
    this.invalidate();
  }

  #resize() {
    const { width, height } = this.#canvas.getBoundingClientRect();
    if (width < 1 || height < 1) return;
    this.#ratio = Math.min(3, devicePixelRatio || 1);
    for (const surface of [this.#canvas, this.#backdrop]) {
      surface.width = Math.round(width * this.#ratio);
      surface.height = Math.round(height * this.#ratio);
    }
    this.#version += 1;
    this.view.resize(width, height);
    cancelAnimationFrame(this.#frame); // at once: a resized canvas is blank
    this.#draw(performance.now());
  }

  #draw(now) {
    this.#frame = 0;
    const dt = Math.min(0.1, Math.max(0, (now - this.#then) / 1000));
    this.#then = now;
    this.pose = this.#glide.at(now);
    if (this.pose) this.view.setRobot(this.pose);
    const gliding = this.view.step(dt);
    this.#paint(now);
    if (gliding || this.#glide.moving(now) || this.#model.world.moving(now)) this.invalidate();
  }

  #paint(now) {
    const { view } = this;
    const context = this.#context;
    const { world, trail, lifted } = this.#model;
    const placed = byLayer(world.things.values())
      .map((thing) => [thing, thing.own && this.pose ? this.pose : world.poseAt(thing, now)]);
    this.#paintBackdrop();
    view.apply(context, this.#ratio);
    drawTrail(context, view, this.#palette, trail, lifted ? null : this.pose);
    for (const [thing, pose] of placed) if (!thing.own) drawThing(context, view, this.#palette, thing, pose);
    if (this.pose) this.#paintRobot(this.pose);
    this.#paintEdit(placed);
    context.setTransform(this.#ratio, 0, 0, this.#ratio, 0, 0);
    drawNames(context, view, this.#palette, placed);
    drawScale(context, view, this.#palette);
  }

  #paintEdit(placed) {
    const { thing: selected, ghost } = this.editor;
    const found = placed.find(([thing]) => thing === selected);
    if (found) drawSelection(this.#context, this.view, this.#palette, ...found);
    if (ghost) drawGhost(this.#context, this.view, this.#palette, ghost);
  }

  #paintRobot({ x, y, theta }) {
    const context = this.#context;
    const { snapshot, hello } = this.#model;
    const robot = hello?.robot ?? null;
    context.save();
    context.translate(x, y);
    context.rotate(theta);
    drawSonar(context, this.view, this.#palette, { robot, sonar: snapshot?.sonar });
    if (snapshot && this.#model.live) {
      const start = { front: robot?.length_front ?? 0.3, rear: robot?.length_rear ?? 0.3 };
      drawPath(context, this.view, this.#palette, snapshot.twist, start);
    }
    drawRobot(context, this.view, this.#palette, { robot, bumpers: snapshot?.bumpers });
    context.restore();
  }

  #paintBackdrop() {
    const { x, y, scale } = this.view;
    const key = `${x} ${y} ${scale} ${this.#version}`;
    if (key !== this.#lastKey) {
      this.#lastKey = key;
      this.#paintFloor(this.#context);
      return;
    }
    if (key !== this.#backdropKey) {
      this.#backdropKey = key;
      this.#paintFloor(this.#backdrop.getContext("2d", { alpha: false }));
    }
    this.#context.setTransform(1, 0, 0, 1, 0, 0);
    this.#context.drawImage(this.#backdrop, 0, 0);
  }

  #paintFloor(context) {
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.#palette.floor;
    context.fillRect(0, 0, this.#canvas.width, this.#canvas.height);
    this.view.apply(context, this.#ratio);
    drawGrid(context, this.view, this.#palette);
    this.#floor.drawWalls(context, this.view, this.#palette);
  }
}
