// All robots of the class: their tiles, and when the pictures in them are drawn.

import { byId } from "../dom.js";
import { SharedFloor } from "./small_map.js";
import { Tile } from "./tile.js";

const PAUSE = 45; // ms between pictures at least: many small ones, which move slowly
const NEARBY = 5; // m; a picture shows other robots from about here on

export class Tiles {
  #model;
  #act;
  #tiles = new Map(); // id -> Tile
  #drawn = new Map(); // id -> {pose, live} as drawn last
  #all = true; // all pictures have to be drawn
  #frame = 0;
  #then = 0;
  #floor = new SharedFloor(() => this.invalidate());
  /** How many pictures have been drawn. */
  pictures = 0;

  /** @param act function(name, id): a button of a tile was pressed */
  constructor({ model, act }) {
    this.#model = model;
    this.#act = act;
  }

  /** Takes the map of the server. */
  adoptMap(map) {
    this.#floor.adopt(map);
  }

  /** Makes the tiles anew where the robots are others. */
  adopt() {
    const ids = [...this.#model.robots.keys()];
    if (ids.join() === [...this.#tiles.keys()].join()) return;
    this.#tiles = new Map(ids.map((id) => [id, new Tile(id, { floor: this.#floor, act: this.#act, changed: () => this.invalidate() })]));
    byId("tiles").replaceChildren(...[...this.#tiles.values()].map(({ element }) => element));
    this.invalidate();
  }

  /** @param {import("../messages.d.ts").Class} told */
  show(told) {
    for (const seat of told.seats) {
      const robot = this.#model.robots.get(seat.robot);
      this.#tiles.get(seat.robot)?.show(seat, robot?.snapshot ?? null, { all: told.paused, live: this.#isLive(robot) });
    }
  }

  /** All pictures have to be drawn anew. */
  invalidate() {
    this.#all = true;
    this.moved();
  }

  /** Some robots may have moved. */
  moved() {
    this.#frame ||= requestAnimationFrame((now) => this.#draw(now));
  }

  /** A robot that stands sends nothing: its last snapshot counts as long as the server is there. */
  #isLive = (robot) => this.#model.socketOpen && robot?.snapshot?.connected === true;

  #draw(now) {
    this.#frame = 0;
    if (now - this.#then < PAUSE) return this.moved();
    this.#then = now;
    const placed = [...this.#model.robots.values()].flatMap((robot) => {
      const pose = robot.poseAt(now);
      return pose ? [[robot, pose]] : [];
    });
    const changed = placed.filter(([robot, pose]) => this.#differs(robot, pose)).map(([, pose]) => pose);
    for (const tile of this.#tiles.values()) this.#drawTile(tile, placed, changed, now);
    this.#all = false;
    for (const [robot, pose] of placed) this.#drawn.set(robot.id, { pose, live: this.#isLive(robot) });
    if (placed.some(([robot]) => robot.moving(now)) || changed.length > 0) this.moved();
  }

  #drawTile(tile, placed, changed, now) {
    const robot = this.#model.robots.get(tile.id);
    const pose = robot?.poseAt(now) ?? null;
    const near = (other) => Math.hypot(other.x - pose.x, other.y - pose.y) < NEARBY;
    if (!robot || !(this.#all || (pose && changed.some(near)))) return;
    tile.draw(robot, pose, placed, this.#isLive);
    this.pictures += 1;
  }

  #differs(robot, pose) {
    const before = this.#drawn.get(robot.id);
    return before?.live !== this.#isLive(robot)
      || before.pose.x !== pose.x || before.pose.y !== pose.y || before.pose.theta !== pose.theta;
  }
}
