// The state of the page: the robots, the selected one, the simulated world; and whether it is up to date.

import { Robot } from "./robot.js";
import { World } from "./world.js";

export class Model {
  /** @type {import("../messages.d.ts").Hello | null} */
  hello = null;
  /** id -> Robot, in the server's order. */
  robots = new Map();
  socketOpen = false;
  world = new World();
  /** Whether this page may only look, and stop. */
  viewer = false;
  /** The reason why the class does not let this page drive now, or empty. */
  denial = "";
  /** Whether a program at the robot's own port drives it. */
  program = false;
  /** Number of this page among the clients, by which drivers are told apart. */
  client = null;
  /** Control leases that are held. @type {import("../messages.d.ts").Holder[]} */
  leases = [];
  #selected = null;
  #also = new Set(); // numbers of the robots that are chosen beside the selected one
  #delay;

  /** @param delay of drawn poses [ms], where reports come less often than usual */
  constructor(delay) {
    this.#delay = delay;
  }

  /** Takes one message of the server. @param {import("../messages.d.ts").ToPage} message */
  receive(message) {
    if (message.type === "hello") this.#takeHello(message);
    else if (message.type === "status") this.#takeStatus(message);
    else if (message.type === "robots") this.#takeSnapshots(message);
    else if (message.type === "scans") this.#takeScans(message);
    else if (message.type === "navigation") this.#takeNavigation(message);
    else if (message.type === "mapping") this.#takeMapping(message);
    else if (message.type === "calibration") this.#takeCalibration(message);
    else if (message.type === "world") this.world.receive(message);
  }

  /** The robot that is driven, stopped and shown, or null before any is known. */
  get selected() {
    return this.robots.get(this.#selected) ?? null;
  }

  /** Selects one robot alone; returns whether it is another one, or was not alone. */
  select(id) {
    if ((id === this.#selected && this.#also.size === 0) || !this.robots.has(id)) return false;
    this.#selected = id;
    this.#also.clear();
    return true;
  }

  /** Chooses one robot more, or one less; the selected one is one of them, and the last one stays. */
  toggle(id) {
    if (!this.robots.has(id)) return;
    if (id !== this.#selected) {
      if (!this.#also.delete(id)) this.#also.add(id);
      return;
    }
    const next = this.chosen[1];
    if (!next) return;
    this.#also.delete(next.id);
    this.#selected = next.id;
  }

  /** Chooses all robots. */
  chooseAll() {
    for (const id of this.robots.keys()) if (id !== this.#selected) this.#also.add(id);
  }

  /** The robots that are driven together: the selected one first, then those chosen beside it. */
  get chosen() {
    const also = [...this.robots.values()].filter(({ id }) => this.#also.has(id) && id !== this.#selected);
    return this.selected ? [this.selected, ...also] : also;
  }

  /** Those of them that nobody else has control of. */
  get driven() {
    const chosen = this.chosen;
    if (chosen.length < 2) return chosen;
    return chosen.filter((robot) => {
      const holder = this.holderOf(robot);
      return robot.connected && (!holder || holder.id === this.client);
    });
  }

  get several() {
    return this.robots.size > 1;
  }

  /** With a closed socket all data count as old; the picture stays, greyed. */
  setSocket(open) {
    if (open === this.socketOpen) return;
    this.socketOpen = open;
    for (const robot of this.robots.values()) robot.expire();
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

  /** The robots that this page has control of: those that it drives, also by a mode. */
  get mine() {
    return [...this.robots.values()].filter((robot) => this.holderOf(robot)?.id === this.client);
  }

  /** The holder of a Robot's control lease, or undefined for nobody. @returns {import("../messages.d.ts").Holder | undefined} */
  holderOf(robot) {
    return this.leases.find((lease) => lease.robot === robot.id);
  }

  /** "you", "other" or null: who drives it. */
  get driver() {
    const driver = this.snapshot?.driver ?? null;
    if (driver === null) return null;
    return driver.id !== null && driver.id === this.client ? "you" : "other";
  }

  /** The selected robot as a thing of the simulated world, or undefined. */
  get own() {
    return this.world.own(this.#selected);
  }

  /** Whether the page shows the robot's present state. */
  get live() {
    return this.isLive(this.selected);
  }

  isLive(robot) {
    if (!this.socketOpen || !robot?.connected) return false;
    return robot.reporting || (this.world.paused && robot.snapshot !== null);
  }

  /** Whether the page shows a replay of logs. */
  get replayed() {
    return this.hello?.robots.some(({ kind }) => kind === "REPLAY") ?? false;
  }

  /** Forgets what belongs to another time of a replay. */
  forget() {
    for (const robot of this.robots.values()) robot.forget();
  }

  /** The reason why a press does not drive, or null when it may. */
  get refusal() {
    if (!this.socketOpen) return "Not connected to the driver.";
    if (this.replayed) return "This is a replay: nothing in it can be driven.";
    if (this.selected && !this.selected.connected) return "The robot is not connected.";
    if (!this.live) return "No news from the robot: driving blind is not possible.";
    if (this.viewer) return "You are a viewer: you may look, and stop the robot.";
    if (this.denial) return `${this.denial[0].toUpperCase()}${this.denial.slice(1)}.`;
    if (this.snapshot.emergency_stop) return "Emergency stop: reset it before driving.";
    return null;
  }

  #takeHello(hello) {
    this.hello = hello;
    const before = this.robots;
    this.robots = new Map(hello.robots.map((told) => [told.id, before.get(told.id) ?? new Robot(told, this.#delay)]));
    for (const told of hello.robots) this.robots.get(told.id).takeHello(told);
    for (const id of this.#also) if (!this.robots.has(id)) this.#also.delete(id);
    if (!this.robots.has(this.#selected)) this.#selected = hello.robots[0]?.id ?? null;
  }

  #takeStatus(status) {
    const robot = this.robots.get(status.robot);
    if (robot) robot.status = status;
  }

  #takeNavigation(navigation) {
    const robot = this.robots.get(navigation.robot);
    if (robot) robot.navigation = navigation;
  }

  #takeMapping(mapping) {
    const robot = this.robots.get(mapping.robot);
    if (robot) robot.mapping = mapping;
  }

  #takeCalibration(calibration) {
    const robot = this.robots.get(calibration.robot);
    if (robot) robot.calibration = calibration;
  }

  #takeSnapshots({ snapshots }) {
    for (const snapshot of snapshots) this.robots.get(snapshot.robot)?.takeSnapshot(snapshot);
  }

  #takeScans({ scans }) {
    for (const sweep of scans) this.robots.get(sweep.robot)?.takeScan(sweep);
  }
}
