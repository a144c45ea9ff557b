// Heights of the ground, on which robots and things stand in the picture: steps, ramps, carpets and height fields.

import { Matrix4, Vector3 } from "../vendor/three-0.187.0/three.js";

const REACH = 0.15; // m from the middle of a robot to where the slope below it is looked for
const STEEPEST = 0.6; // more is an edge: what stands on it is drawn level

export class Ground {
  #shapes; // [{form, at, size, numbers, columns}]

  /** @param solids of the map @type {import("../messages.d.ts").MapSolid[]} */
  constructor(solids = []) {
    this.#shapes = solids.filter(({ ground }) => ground).flatMap(({ shapes }) => shapes);
  }

  /** Its height at a place [m]; 0 is the floor. */
  height(x, y) {
    return this.#shapes.reduce((most, shape) => Math.max(most, heightOn(shape, x, y)), 0);
  }

  /** The pose of what stands there, as a matrix: it leans as the ground does. */
  stance({ x, y, theta }) {
    const turn = new Matrix4().makeRotationZ(theta);
    const z = this.height(x, y);
    const base = turn.clone().setPosition(x, y, z);
    if (!this.#shapes.length) return base;
    const [c, s] = [REACH * Math.cos(theta), REACH * Math.sin(theta)];
    const along = (this.height(x + c, y + s) - this.height(x - c, y - s)) / (2 * REACH);
    const across = (this.height(x - s, y + c) - this.height(x + s, y - c)) / (2 * REACH);
    if (Math.max(Math.abs(along), Math.abs(across)) > STEEPEST || (along === 0 && across === 0)) return base;
    const ahead = new Vector3(1, 0, along).normalize();
    const up = ahead.clone().cross(new Vector3(0, 1, across)).normalize();
    return turn.multiply(new Matrix4().makeBasis(ahead, up.clone().cross(ahead), up)).setPosition(x, y, z);
  }
}

/** The height of one shape at a place of the map [m]; below the floor where it is not. */
function heightOn({ form, at: [x0, y0, z, theta], size: [length, width, height], numbers, columns }, x, y) {
  const [c, s] = [Math.cos(theta), Math.sin(theta)];
  const [along, across] = [(c * (x - x0) + s * (y - y0)) / length + 0.5, (c * (y - y0) - s * (x - x0)) / width + 0.5];
  if (along < 0 || along > 1 || across < 0 || across > 1) return -1;
  if (form === "wedge") return z + height * along;
  if (form !== "terrain") return z + height;
  const rows = numbers.length / columns;
  const [i, j] = [along * (columns - 1), across * (rows - 1)];
  const [column, row] = [Math.min(Math.floor(i), columns - 2), Math.min(Math.floor(j), rows - 2)];
  const [u, v] = [i - column, j - row];
  const [a, b, p, q] = [0, 1, columns, columns + 1].map((by) => numbers[row * columns + column + by]);
  return z + (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * p + u * q);
}
