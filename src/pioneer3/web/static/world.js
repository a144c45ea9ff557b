// What is in the simulated world, as the server tells it. Things glide from place to place.

import { Glide } from "./glide.js";

export class World {
  /** id -> {id, kind, name, front, rear, side, ..., pose: {x, y, theta}} */
  things = new Map();
  /** {paused, speed, factor, time}, or null while nothing is told. */
  clock = null;
  #glides = new Map();

  receive({ all, things, moved, gone, clock }) {
    const now = performance.now();
    if (all) this.clear();
    for (const id of gone) {
      this.things.delete(id);
      this.#glides.delete(id);
    }
    for (const { pose, ...thing } of things) {
      this.things.set(thing.id, thing);
      this.#place(thing, pose, now);
    }
    for (const [id, ...pose] of moved) this.#place(this.things.get(id), pose, now);
    this.clock = clock;
  }

  clear() {
    this.things.clear();
    this.#glides.clear();
    this.clock = null;
  }

  get paused() {
    return this.clock?.paused ?? false;
  }

  /** The robot of this number on the page as a thing, or undefined. */
  own(id) {
    return [...this.things.values()].find((thing) => thing.own === id);
  }

  /** Where to draw a thing at `now` [ms]. */
  poseAt(thing, now) {
    return this.#glides.get(thing.id).at(now);
  }

  /** Whether anything still glides. */
  moving(now) {
    return [...this.#glides.values()].some((glide) => glide.moving(now));
  }

  /** The thing at a point of the map, or up to `slack` [m] beside it; the nearest middle wins. */
  at({ x, y }, slack) {
    let [best, least] = [null, Infinity];
    for (const thing of this.things.values()) {
      const [dx, dy] = [x - thing.pose.x, y - thing.pose.y];
      const [c, s] = [Math.cos(thing.pose.theta), Math.sin(thing.pose.theta)];
      const [ahead, left] = [c * dx + s * dy, c * dy - s * dx];
      const beside = Math.hypot(
        Math.max(0, ahead - thing.front, -thing.rear - ahead), Math.max(0, Math.abs(left) - thing.side),
      );
      const far = Math.hypot(dx, dy);
      if (beside <= slack && far < least) [best, least] = [thing, far];
    }
    return best;
  }

  #place(thing, [x, y, theta], now) {
    thing.pose = { x, y, theta };
    if (!this.#glides.has(thing.id)) this.#glides.set(thing.id, new Glide());
    this.#glides.get(thing.id).aim(thing.pose, now);
  }
}

/** What to call a thing. */
export function labelOf({ id, kind, name }) {
  return name || `${{ box: "Box", person: "Person", robot: "Robot" }[kind]} ${id}`;
}
