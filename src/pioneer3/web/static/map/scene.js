// The picture: draws the model through the view, only when something has changed. Colours come from theme.css.

import { byId } from "../dom.js";
import { CachedPicture, SpriteCache } from "./cache.js";
import { FloorPlan, OccupancyGrid, drawScale } from "./floor_plan.js";
import { drawMapEdit } from "./map_editor.js";
import { readPalette, watchPalette } from "./palette.js";
import { drawRobotNames, drawRobots, drawSenses } from "./robots.js";
import { drawHovered } from "./places.js";
import { drawProposal, drawStop, drawTarget } from "./target.js";
import { byLayer, drawGhost, drawNames, drawSelection, drawThing } from "./things.js";
import { Trails } from "./trails.js";
import { drawWhereabouts } from "./whereabouts.js";

const BESIDE = 8; // px of the buttons that lie in the margin of a fitted picture

export class Scene {
  #canvas;
  #context;
  #static = new CachedPicture((context, camera, ratio) => this.#paintFloor(context, camera, ratio), { opaque: true });
  #trails = new Trails();
  #sprites = new SpriteCache();
  #version = 0; // counts changes of map, theme and layers
  #floor = new FloorPlan();
  #map = "";
  #palette = readPalette();
  #ratio = 1;
  #frame = 0;
  #then = 0;
  #running = false; // the last frame asked for the next one
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
  /** The selected thing, and the outline of the dragged one: {thing, ghost}. */
  editor = { thing: undefined, ghost: null };
  /** The editor of the map: the selected object, and what a drag would make. */
  mapEditor = { active: false };
  /** The three-dimensional picture, which is drawn in place of this one, or null. */
  solid = null;
  /** The goal that is proposed for the selected robot, and whether it can be sent to places. */
  goto = { proposal: null, stops: [], hovered: null, offers: false };

  constructor(canvas, view, model, layers) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d", { alpha: false });
    this.view = view;
    this.#model = model;
    this.#layers = layers;
    new ResizeObserver(() => this.#resize()).observe(canvas);
    watchPalette(() => this.#recolour());
  }

  get ratio() {
    return this.#ratio;
  }

  /** The objects that the map names. */
  get places() {
    return this.#floor.objects;
  }

  /** Where the map lies, or null without one. */
  get bounds() {
    return this.#floor.bounds;
  }

  /** Shows another map of the server, if it is another. */
  async adoptMap(map) {
    const text = JSON.stringify(map);
    if (text === this.#map) return;
    this.#map = text;
    const grids = await Promise.all((map?.cells ?? []).map((grid) => OccupancyGrid.read(grid)));
    if (text !== this.#map) return; // there is a newer one
    this.#floor = new FloorPlan(map, grids);
    this.view.setBounds(this.#floor.bounds);
    this.renew();
  }

  /** Asks for one more frame. */
  invalidate() {
    this.#frame ||= requestAnimationFrame((now) => this.#draw(now));
  }

  /** The static part of the picture has changed. */
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
    this.view.resize(width, height, byId("tools").offsetWidth - BESIDE);
    cancelAnimationFrame(this.#frame); // at once: a resized canvas is blank
    this.#draw(performance.now());
  }

  #draw(now) {
    this.#frame = 0;
    this.frames += 1;
    const dt = Math.min(0.1, Math.max(0, (now - this.#then) / 1000));
    const took = this.#running ? now - this.#then : 0;
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
    const panning = this.view.step(dt);
    const rough = this.solid ? this.#paintSolid(now, dt, took) : this.#paint(now);
    this.#running = panning || moving || rough;
    if (this.#running) this.invalidate();
  }

  /** @param took time since the frame before [ms], 0 if that one asked for no other */
  #paintSolid(now, dt, took) {
    return this.solid.draw({
      dt, took, plan: this.#floor, version: this.#version, palette: this.#palette, placed: this.robots, things: this.#things(now),
      model: this.#model, shown: this.#shown, isLive: this.#isLive, goto: this.goto,
    });
  }

  /** The things of the world where they are drawn, [thing, pose]. */
  #things(now) {
    const { world, robots } = this.#model;
    return byLayer(world.things.values())
      .map((thing) => [thing, robots.get(thing.own)?.poseAt(now) ?? world.poseAt(thing, now)]);
  }

  /** Returns whether something should be drawn once more to be sharp. */
  #paint(now) {
    const { view, robots: placed } = this;
    const context = this.#context;
    const palette = this.#palette;
    const [ratio, shown] = [this.#ratio, this.#shown];
    const { world, selected, chosen, several } = this.#model;
    const [sprites, scale] = [this.#sprites, view.scale * ratio];
    const common = { selected, chosen, several, isLive: this.#isLive, paused: world.paused, shown, now, sprites, scale, ratio };
    const things = this.#things(now);
    const visible = things.filter(([{ kind }]) => kind === "robot" || shown("things"));
    let rough = this.#static.draw(context, view, ratio, this.#version, now);
    if (shown("trails")) rough = this.#trails.draw(context, view, palette, placed, common) || rough;
    view.apply(context, ratio);
    for (const [thing, pose] of visible) if (!thing.own) drawThing(context, view, palette, thing, pose, sprites, scale);
    drawSenses(context, view, palette, placed, common);
    if (shown("targets")) this.#paintTargets(placed);
    drawRobots(context, view, palette, placed, common);
    if (shown("places") && this.goto.hovered) drawHovered(context, view, palette, this.goto.hovered);
    if (shown("places")) this.#paintWhereabouts(placed);
    for (const [at, stop] of this.goto.stops.entries()) drawStop(context, view, palette, stop, at + 1);
    if (this.goto.proposal) drawProposal(context, view, palette, this.goto.proposal, this.pose);
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
      if (target && this.#model.isLive(robot)) drawTarget(this.#context, this.view, this.#palette, target, pose, robot.way);
    }
  }

  #paintWhereabouts(placed) {
    for (const [robot, pose] of placed) {
      if (robot.navigation && this.#model.isLive(robot)) drawWhereabouts(this.#context, this.view, this.#palette, robot.navigation, pose);
    }
  }

  #paintEdit(placed) {
    const { thing: selected, ghost } = this.editor;
    const found = placed.find(([thing]) => thing === selected);
    if (found) drawSelection(this.#context, this.view, this.#palette, ...found);
    if (ghost) drawGhost(this.#context, this.view, this.#palette, ghost);
    if (this.mapEditor.active) drawMapEdit(this.#context, this.view, this.#palette, this.mapEditor);
  }

  #paintFloor(context, camera, ratio) {
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.#palette.floor;
    context.fillRect(0, 0, context.canvas.width, context.canvas.height);
    camera.apply(context, ratio);
    this.#floor.draw(context, camera, this.#palette, ratio, this.#shown, this.goto.offers);
  }
}
