// Marks on the floor: trails, the planned ways, targets, the proposed goal, and where robots believe to be.

import { CircleGeometry, ConeGeometry, Group, Mesh, RingGeometry } from "../vendor/three-0.187.0/three.js";
import { flat } from "./floor.js";
import { Ribbons } from "./ribbons.js";
import { clear, free, label } from "./shapes.js";

const SHORT = 600; // points of the trail of a robot that is not selected
const EVERY = 6; // points that are drawn: 0.18 m apart
const LAG = 0.2; // m that a drawn trail may end behind its robot, which hides that
const [TRAIL, WAY] = [0.035, 0.045]; // m, width
const AHEAD = 1.5; // s, of the predicted path

export class Marks {
  group = new Group();
  #trails = new Ribbons();
  #drawn = { ends: new Map() }; // the state of the trails when they were drawn; ends: Robot -> [x, y]
  #lines = new Ribbons();
  #signs = new Group();
  #made = "";

  constructor() {
    this.group.add(this.#trails.mesh, this.#lines.mesh, this.#signs);
  }

  show(placed, { selected, isLive, shown, palette, goto }) {
    this.#showTrails(shown("trails") ? placed : [], selected, palette);
    const marks = [...marksOf(placed, { selected, isLive, shown, palette, goto })];
    this.#lines.show(marks.filter(({ points }) => points).map((line) => ({ ...line, width: WAY, height: 0.02 })));
    const signs = marks.filter(({ points }) => !points);
    const key = JSON.stringify([signs, palette.floor]);
    if (key === this.#made) return;
    this.#made = key;
    clear(this.#signs);
    for (const sign of signs) this.#add(sign, palette);
  }

  /** Draws all trails anew when one of them ends too far behind its robot. */
  #showTrails(placed, selected, palette) {
    const { ends, ...before } = this.#drawn;
    const same = before.palette === palette && before.selected === selected && ends.size === placed.length;
    if (same && placed.every(([robot]) => ends.has(robot) && near(ends.get(robot), robot.trail.at(-1)))) return;
    this.#drawn = { palette, selected, ends: new Map(placed.map(([robot]) => [robot, robot.trail.at(-1)])) };
    this.#trails.show(placed.flatMap(([robot]) => {
      const chosen = robot === selected;
      const style = { width: TRAIL, height: 0.01, color: palette.trail, alpha: chosen ? 0.8 : 0.45 };
      return pieces(chosen ? robot.trail : robot.trail.slice(-SHORT)).map((points) => ({ points, ...style }));
    }));
  }

  #add({ at, color, heading, ellipse, text }, palette) {
    const part = new Group();
    part.position.set(at[0], at[1], 0.025);
    this.#signs.add(part);
    if (ellipse) {
      const mesh = new Mesh(new CircleGeometry(1, 32), flat(color, 0.25));
      mesh.scale.set(Math.max(ellipse[0], 0.03), Math.max(ellipse[1], 0.03), 1);
      mesh.rotation.z = ellipse[2];
      part.add(mesh);
      return;
    }
    const pin = new Mesh(new ConeGeometry(0.09, 0.35, 16).rotateX(-Math.PI / 2).translate(0, 0, 0.2), flat(color));
    part.add(new Mesh(new RingGeometry(0.2, 0.25, 32), flat(color)), pin);
    if (typeof heading === "number") {
      const arrow = new Mesh(new CircleGeometry(0.11, 3), flat(color));
      arrow.position.set(0.38 * Math.cos(heading), 0.38 * Math.sin(heading), 0);
      arrow.rotation.z = heading;
      part.add(arrow);
    }
    if (text) {
      const sprite = label(text, color, palette.floor);
      sprite.position.z = 0.4;
      part.add(sprite);
    }
  }

  dispose() {
    for (const part of [this.#trails.mesh, this.#lines.mesh, this.#signs]) free(part);
  }
}

/** All that is on the floor beside trails, as data: lines, which have points, and signs. */
function* marksOf(placed, { selected, isLive, shown, palette, goto }) {
  for (const [robot, pose] of placed) {
    const { snapshot, navigation } = robot;
    if (!snapshot || !isLive(robot)) continue;
    if (shown("paths") && robot === selected && Math.abs(snapshot.twist.v) >= 0.02) yield { points: arc(robot, pose), color: palette.path, dash: [0.03, 0.08] };
    const { target } = snapshot;
    if (shown("targets") && target) {
      const color = target.person ? palette.person : palette.target;
      yield { points: [[pose.x, pose.y], ...(robot.way?.slice(1) ?? [[target.x, target.y]])], color, dash: [0.18, 0.14] };
      yield { at: [target.x, target.y], heading: target.heading, color };
    }
    if (shown("places") && navigation?.robot_in_map && navigation.ellipse) {
      yield { ellipse: navigation.ellipse, at: [navigation.robot_in_map.x, navigation.robot_in_map.y], color: navigation.sure ? palette.target : palette.hit };
    }
  }
  for (const [number, { x, y }] of goto.stops.entries()) yield { at: [x, y], heading: null, color: palette.target, text: String(number + 1) };
  const goal = goto.proposal;
  if (!goal) return;
  const from = placed.find(([robot]) => robot === selected)?.[1];
  if (goal.way?.length || (from && goal.straight)) {
    yield { points: goal.way?.length ? goal.way : [[from.x, from.y], [goal.x, goal.y]], color: palette.target, dash: [0.18, 0.14] };
  }
  yield { at: [goal.x, goal.y], heading: goal.heading, color: palette.target };
}

/** Pieces of a trail: null separates them. */
function pieces(trail) {
  const lines = [[]];
  for (const point of trail) point === null ? lines.push([]) : lines.at(-1).push(point);
  return lines.map((line) => line.filter((_, at) => at % EVERY === 0 || at === line.length - 1));
}

/** Whether a trail with another last point need not be drawn anew. */
function near(one, other) {
  return one === other || Boolean(one && other && Math.hypot(one[0] - other[0], one[1] - other[1]) < LAG);
}

/** The arc that a robot drives next at its velocity. */
function arc({ snapshot: { twist: { v, w } }, shape }, { x, y, theta }) {
  const nose = v > 0 ? shape?.length_front ?? 0.3 : -(shape?.length_rear ?? 0.3);
  return Array.from({ length: 13 }, (_, step) => {
    const t = (step / 12) * AHEAD;
    const turn = w * t;
    const [ahead, left] = Math.abs(w) < 1e-3 ? [v * t, 0] : [(v / w) * Math.sin(turn), (v / w) * (1 - Math.cos(turn))];
    const [a, b] = [ahead + nose * Math.cos(turn), left + nose * Math.sin(turn)];
    return [x + a * Math.cos(theta) - b * Math.sin(theta), y + a * Math.sin(theta) + b * Math.cos(theta)];
  });
}
