// The picture: draws the model through the view, only when something has changed.

import { Cells } from "./cells.js";
import { drawGhost, drawSelection } from "./draw_edit.js";
import { Floor, drawScale } from "./draw_map.js";
import { drawRobotNames, drawRobots, drawSenses } from "./draw_robots.js";
import { drawOffer, drawTarget } from "./draw_target.js";
import { byLayer, drawNames, drawThing } from "./draw_things.js";
import { readPalette } from "./palette.js";
import { Sprites } from "./sprites.js";
import { Still } from "./still.js";
import { Trails } from "./trails.js";

export class Scene {
  #canvas;
  #context;
  #still = new Still((context, camera, ratio) => this.#paintFloor(context, camera, ratio), { opaque: true });
  #trails = new Trails();
  #sprites = new Sprites();
  #version = 0; // counts changes of map, theme and layers
  #floor = new Floor();
  #map = "";
  #palette = readPalette();
  #ratio = 1;
  #frame = 0;
  #then = 0;
  #model;
  #layers;
  #shown = (layer) => this.#layers.has(layer);
  #isLive = (robot) => this.#model.isLive(robot);

  /** How many pictures have been drawn. */
  frames = 0;
  /** Pose of the selected robot drawn last, or null. */
  pose = null;
  /** The page's robots where they were drawn last, [Robot, pose]. */
  robots = [];
  /** What is selected and dragged, {thing, ghost}. */
  editor = { thing: undefined, ghost: null };
  /** Where the selected robot may be sent, {offer}. */
  errand = { offer: null };

  constructor(canvas, view, model, layers) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d", { alpha: false });
    this.view = view;
    this.#model = model;
    this.#layers = layers;
    new ResizeObserver(() => this.#resize()).observe(canvas);
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.#recolour());
    matchMedia("(prefers-contrast: more)").addEventListener("change", () => this.#recolour());
  }

  get ratio() {
    return this.#ratio;
  }

  /** What the map names. */
  get places() {
    return this.#floor.objects;
  }

  /** The map may have changed. */
  async adoptMap(map) {
    const text = JSON.stringify(map);
    if (text === this.#map) return;
    this.#map = text;
    const cells = await Promise.all((map?.cells ?? []).map((grid) => Cells.read(grid)));
    if (text !== this.#map) return; // there is a newer one
    this.#floor = new Floor(map, cells);
    this.view.setBounds(this.#floor.bounds);
    this.renew();
  }

  /** Asks for one more frame. */
  invalidate() {
    this.#frame ||= requestAnimationFrame((now) => this.#draw(now));
  }

  /** What stands still has changed. */
  renew() {
    this.#version += 1;
    this.invalidate();
  }

  #recolour() {
    this.#palette = readPalette();
    this.#sprites.clear();
    this.renew();
  }

  #resize() {
    const { width, height } = this.#canvas.getBoundingClientRect();
    if (width < 1 || height < 1) return;
    this.#ratio = Math.min(3, devicePixelRatio || 1);
    this.#canvas.width = Math.round(width * this.#ratio);
    this.#canvas.height = Math.round(height * this.#ratio);
    this.view.resize(width, height);
    cancelAnimationFrame(this.#frame); // at once: a resized canvas is blank
    this.#draw(performance.now());
  }

  #draw(now) {
    this.#frame = 0;
    this.frames += 1;
    const dt = Math.min(0.1, Math.max(0, (now - this.#then) / 1000));
    this.#then = now;
    const { robots, selected, world } = this.#model;
    this.robots.length = 0;
    let moving = world.moving(now);
    for (const robot of robots.values()) {
      const pose = robot.poseAt(now);
      if (pose) this.robots.push([robot, pose]);
      moving ||= robot.moving(now);
    }
    this.pose = selected?.poseAt(now) ?? null;
    this.view.setRobots(this.robots.map(([, pose]) => pose));
    if (this.pose) this.view.setRobot(this.pose);
    const gliding = this.view.step(dt);
    const rough = this.#paint(now);
    if (gliding || moving || rough) this.invalidate();
  }

  /** Says whether something should be drawn once more to be sharp. */
  #paint(now) {
    const { view, robots: placed } = this;
    const context = this.#context;
    const palette = this.#palette;
    const [ratio, shown] = [this.#ratio, this.#shown];
    const { world, robots, selected, several } = this.#model;
    const [sprites, scale] = [this.#sprites, view.scale * ratio];
    const common = { selected, several, isLive: this.#isLive, paused: world.paused, shown, now, sprites, scale, ratio };
    const things = byLayer(world.things.values())
      .map((thing) => [thing, robots.get(thing.own)?.poseAt(now) ?? world.poseAt(thing, now)]);
    const visible = things.filter(([{ kind }]) => kind === "robot" || shown("things"));
    let rough = this.#still.draw(context, view, ratio, this.#version, now);
    if (shown("trails")) rough = this.#trails.draw(context, view, palette, placed, common) || rough;
    view.apply(context, ratio);
    for (const [thing, pose] of visible) if (!thing.own) drawThing(context, view, palette, thing, pose, sprites, scale);
    drawSenses(context, view, palette, placed, common);
    if (shown("targets")) this.#paintTargets(placed);
    drawRobots(context, view, palette, placed, common);
    if (this.errand.offer) drawOffer(context, view, palette, this.errand.offer, this.pose);
    this.#paintEdit(things);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (shown("names")) drawNames(context, view, palette, visible, sprites, ratio);
    if (shown("names") && several) drawRobotNames(context, view, palette, placed, selected, sprites, ratio);
    drawScale(context, view, palette);
    return rough;
  }

  #paintTargets(placed) {
    for (const [robot, pose] of placed) {
      const target = robot.snapshot?.target;
      if (target && this.#model.isLive(robot)) drawTarget(this.#context, this.view, this.#palette, target, pose);
    }
  }

  #paintEdit(placed) {
    const { thing: selected, ghost } = this.editor;
    const found = placed.find(([thing]) => thing === selected);
    if (found) drawSelection(this.#context, this.view, this.#palette, ...found);
    if (ghost) drawGhost(this.#context, this.view, this.#palette, ghost);
  }

  #paintFloor(context, camera, ratio) {
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.#palette.floor;
    context.fillRect(0, 0, context.canvas.width, context.canvas.height);
    camera.apply(context, ratio);
    this.#floor.draw(context, camera, this.#palette, ratio, this.#shown);
  }
}
