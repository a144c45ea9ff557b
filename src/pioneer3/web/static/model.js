// What the page knows: the robots, the one that is selected, the world; and whether it may be trusted.

import { Robot } from "./robot.js";
import { World } from "./world.js";

export class Model {
  hello = null;
  /** id -> Robot, in the server's order. */
  robots = new Map();
  socketOpen = false;
  world = new World();
  /** Whether this page may only look, and stop. */
  viewer = false;
  /** Number of this page's guest, by which drivers are told apart. */
  guest = null;
  /** Who has which wheel: [{robot, id, name}]. */
  wheels = [];
  #selected = null;

  /** Takes in one message of the server. */
  receive(message) {
    if (message.type === "hello") this.#greet(message);
    else if (message.type === "status") this.#note(message);
    else if (message.type === "robots") this.#see(message);
    else if (message.type === "scans") this.#scan(message);
    else if (message.type === "world") this.world.receive(message);
  }

  /** The robot that is driven, stopped and shown, or null before any is known. */
  get selected() {
    return this.robots.get(this.#selected) ?? null;
  }

  /** Says whether that is another one. */
  select(id) {
    if (id === this.#selected || !this.robots.has(id)) return false;
    this.#selected = id;
    return true;
  }

  get several() {
    return this.robots.size > 1;
  }

  /** A closed socket makes all that was known old news; the picture stays, greyed. */
  setSocket(open) {
    if (open === this.socketOpen) return;
    this.socketOpen = open;
    for (const robot of this.robots.values()) robot.forget();
  }

  clearTrail() {
    for (const robot of this.robots.values()) robot.clearTrail();
  }

  // of the selected robot

  get snapshot() {
    return this.selected?.snapshot ?? null;
  }

  get status() {
    return this.selected?.status ?? null;
  }

  /** The robots whose wheel this page's guest has: those they drive, also by a mode. */
  get mine() {
    return [...this.robots.values()].filter((robot) => this.holderOf(robot)?.id === this.guest);
  }

  /** Who has the wheel of a Robot: {id, name}, or undefined for nobody. */
  holderOf(robot) {
    return this.wheels.find((wheel) => wheel.robot === robot.id);
  }

  /** "you", "other" or null: who drives it. */
  get driver() {
    const driver = this.snapshot?.driver ?? null;
    if (driver === null) return null;
    return driver.id !== null && driver.id === this.guest ? "you" : "other";
  }

  /** It as a thing of the simulated world, or undefined. */
  get own() {
    return this.world.own(this.#selected);
  }

  /** Whether what the page shows is what the robot does now. */
  get live() {
    return this.isLive(this.selected);
  }

  get hearing() {
    return this.selected?.hearing ?? false;
  }

  isLive(robot) {
    if (!this.socketOpen || !robot?.connected) return false;
    return robot.hearing || (this.world.paused && robot.snapshot !== null);
  }

  /** Why a press does not drive, or null when it may. */
  get obstacle() {
    if (!this.socketOpen) return "Not connected to the driver.";
    if (this.selected && !this.selected.connected) return "The robot is not connected.";
    if (!this.live) return "No news from the robot: driving blind is not possible.";
    if (this.viewer) return "You are a viewer: you may look, and stop the robot.";
    if (this.snapshot.emergency_stop) return "Emergency stop: reset it before driving.";
    return null;
  }

  #greet(hello) {
    this.hello = hello;
    const before = this.robots;
    this.robots = new Map(hello.robots.map((told) => [told.id, before.get(told.id) ?? new Robot(told)]));
    for (const told of hello.robots) this.robots.get(told.id).greet(told);
    if (!this.robots.has(this.#selected)) this.#selected = hello.robots[0]?.id ?? null;
  }

  #note(status) {
    const robot = this.robots.get(status.robot);
    if (robot) robot.status = status;
  }

  #see({ snapshots }) {
    for (const snapshot of snapshots) this.robots.get(snapshot.robot)?.see(snapshot);
  }

  #scan({ scans }) {
    for (const sweep of scans) this.robots.get(sweep.robot)?.scan(sweep);
  }
}
