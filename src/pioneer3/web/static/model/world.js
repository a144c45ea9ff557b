// The things in the simulated world, as the server reports them, with poses interpolated for drawing.

import { PoseInterpolator } from "./interpolation.js";

export class World {
  /** id -> thing, without its pose */
  things = new Map();
  /** Null before the first message. @type {import("../messages.d.ts").SimulatedTime | null} */
  clock = null;
  #drawn = new Map(); // id -> PoseInterpolator

  /** @param {import("../messages.d.ts").WorldChanges} message */
  receive({ all, things, moved, gone, clock }) {
    const now = performance.now();
    if (all) this.clear();
    for (const id of gone) {
      this.things.delete(id);
      this.#drawn.delete(id);
    }
    for (const { thing_in_map: pose, ...thing } of things) {
      this.things.set(thing.id, thing);
      this.#place(thing, pose, now);
    }
    for (const [id, ...pose] of moved) this.#place(this.things.get(id), pose, now);
    this.clock = clock;
  }

  clear() {
    this.things.clear();
    this.#drawn.clear();
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
    return this.#drawn.get(thing.id).at(now);
  }

  /** Whether any drawn pose still changes. */
  moving(now) {
    return [...this.#drawn.values()].some((pose) => pose.moving(now));
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
    if (!this.#drawn.has(thing.id)) this.#drawn.set(thing.id, new PoseInterpolator());
    this.#drawn.get(thing.id).moveTo(thing.pose, now);
  }
}

/** Returns the name of a thing, or its kind and number. */
export function labelOf({ id, kind, name }) {
  return name || `${{ box: "Box", person: "Person", robot: "Robot" }[kind]} ${id}`;
}
