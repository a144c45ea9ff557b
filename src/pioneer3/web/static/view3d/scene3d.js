// The three-dimensional picture of the same scene: it draws when the flat one would, on a canvas of its own.

import { DirectionalLight, HemisphereLight, Plane, Raycaster, Scene as Space, Vector2, Vector3, WebGLRenderer } from "../vendor/three-0.187.0/three.js";
import { byId, make } from "../dom.js";
import { robotAt } from "../map/robots.js";
import { Camera3d } from "./camera.js";
import { Floor } from "./floor.js";
import { Ground } from "./ground.js";
import { Marks } from "./marks.js";
import { Robots } from "./robots.js";
import { Sensors } from "./sensors.js";

const MOST_RATIO = 2; // pixels for a CSS pixel
const LEAST_RATIO = 0.5;
const [SLOW, FAST] = [55, 20]; // ms for a frame: the picture gets coarser, or finer again
const STEADY = 6; // frames of one kind before it changes
const TREMBLE = 5; // px that a tap may move
const DECK = 0.2; // m: robots are picked at this height

export class Scene3d {
  camera;
  frames = 0;
  #renderer;
  #canvas = make("canvas", { id: "canvas-3d", role: "img", "aria-label": "Three-dimensional map with the robots, their trails and what they sense" });
  #space = new Space();
  #floor = new Floor();
  #ground = new Ground();
  #groundOf = null; // the plan that it is of
  #robots;
  #sensors = new Sensors();
  #marks = new Marks();
  #placed = [];
  #invalidate;
  #observer;
  #size = { width: 1, height: 1 };
  #ratio = 1;
  #streak = 0; // slow frames in a row, or below zero fast ones
  #pressed = null;

  /**
   * @param invalidate function(): asks for a frame
   * @param tap  function(place, pointerType, event): a tap on the floor or on a robot, [m]
   * @param lost function(): the graphics card has given up
   */
  constructor({ invalidate, tap, lost, still }) {
    this.#invalidate = invalidate;
    this.#renderer = new WebGLRenderer({ canvas: this.#canvas, antialias: devicePixelRatio >= 1.5, powerPreference: "low-power" });
    this.#ratio = Math.min(MOST_RATIO, devicePixelRatio || 1);
    byId("canvas").after(this.#canvas);
    this.camera = new Camera3d(this.#canvas, { changed: invalidate, still });
    this.#robots = new Robots(invalidate);
    const sun = new DirectionalLight("#ffffff", 1.6);
    sun.position.set(-3, -5, 9);
    this.#space.add(new HemisphereLight("#ffffff", "#8899aa", 1.9), sun, this.#floor.group, this.#robots.group, this.#sensors.group, this.#marks.group);
    this.#canvas.addEventListener("webglcontextlost", lost);
    this.#listen(tap);
    this.#observer = new ResizeObserver(() => this.#resize());
    this.#observer.observe(this.#canvas);
    this.#resize();
  }

  /** Draws all; returns whether it should be drawn again at once. */
  draw({ dt, took, plan, version, palette, placed, things, model, shown, isLive, goto }) {
    this.#adapt(took);
    this.frames += 1;
    this.#placed = placed;
    const { selected, chosen, several, world } = model;
    const pose = placed.find(([robot]) => robot === selected)?.[1] ?? null;
    if (plan !== this.#groundOf) [this.#groundOf, this.#ground] = [plan, new Ground(plan.solids)];
    const ground = this.#ground;
    this.camera.setBounds(plan.bounds);
    this.camera.setRobot(pose && { ...pose, z: ground.height(pose.x, pose.y) });
    const moving = this.camera.step(dt);
    const common = { ground, selected, chosen, several, isLive, shown, palette, goto, paused: world.paused, hidden: this.camera.mode === "eyes" ? selected : null };
    this.#floor.show(version, plan, palette, shown);
    this.#robots.show(placed, things, common);
    this.#sensors.show(placed, common);
    this.#marks.show(placed, common);
    this.#renderer.setClearColor(palette.floor);
    this.#renderer.render(this.#space, this.camera.camera);
    return moving;
  }

  /** For tests: where robots are drawn, and what the graphics card holds. */
  get state() {
    const { geometries, textures } = this.#renderer.info.memory;
    const { position: { x, y, z } } = this.camera.camera;
    return {
      frames: this.frames, ratio: this.#ratio, mode: this.camera.mode, geometries, textures, calls: this.#renderer.info.render.calls, eye: [x, y, z],
      solids: this.#groundOf?.solids.length ?? 0,
      robots: Object.fromEntries(this.#placed.map(([robot]) => [robot.id, this.#robots.drawn(robot)])),
    };
  }

  dispose() {
    this.#observer.disconnect();
    for (const part of [this.camera, this.#robots, this.#sensors, this.#marks, this.#floor]) part.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss();
    this.#canvas.remove();
  }

  /** Fewer pixels while frames are slow. */
  #adapt(took) {
    if (took === 0) return;
    this.#streak = took > SLOW ? Math.max(0, this.#streak) + 1 : took < FAST ? Math.min(0, this.#streak) - 1 : 0;
    const most = Math.min(MOST_RATIO, devicePixelRatio || 1);
    const ratio = this.#streak >= STEADY ? Math.max(LEAST_RATIO, this.#ratio * 0.8) : this.#streak <= -20 * STEADY ? Math.min(most, this.#ratio * 1.15) : this.#ratio;
    if (ratio === this.#ratio) return;
    [this.#ratio, this.#streak] = [ratio, 0];
    this.#resize(false);
  }

  #resize(draw = true) {
    const { width, height } = this.#canvas.getBoundingClientRect();
    if (width < 1 || height < 1) return;
    this.#size = { width, height };
    this.#renderer.setPixelRatio(this.#ratio);
    this.#renderer.setSize(width, height, false);
    this.camera.resize(width, height);
    if (draw) this.#invalidate();
  }

  #listen(tap) {
    const canvas = this.#canvas;
    canvas.addEventListener("pointerdown", (event) => {
      this.#pressed = event.isPrimary && event.button === 0 ? { x: event.offsetX, y: event.offsetY, id: event.pointerId } : null;
    });
    canvas.addEventListener("pointerup", (event) => {
      const from = this.#pressed;
      this.#pressed = null;
      if (!from || from.id !== event.pointerId || Math.hypot(event.offsetX - from.x, event.offsetY - from.y) > TREMBLE) return;
      const place = this.#robotUnder(event) ?? this.#floorUnder(event, 0);
      if (place) tap(place, event.pointerType, event);
    });
    canvas.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
  }

  /** The middle of the robot under a pointer, or null. */
  #robotUnder(event) {
    const at = this.#floorUnder(event, DECK);
    const robot = at && robotAt(this.#placed, at, 0);
    return robot ? this.#placed.find(([one]) => one === robot)[1] : null;
  }

  #floorUnder({ offsetX, offsetY }, height) {
    const { width, height: tall } = this.#size;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * offsetX) / width - 1, 1 - (2 * offsetY) / tall), this.camera.camera);
    return ray.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -height), new Vector3());
  }
}
