// Flat ribbons on the floor along lines of points: one mesh for many lines, whose buffers are written anew in place.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Mesh, MeshBasicMaterial } from "../vendor/three-0.187.0/three.js";

const CORNERS = [0, 1, 2, 2, 1, 3]; // of the two triangles of a piece
const ROOM = 64; // pieces at first

export class Ribbons {
  mesh = new Mesh(new BufferGeometry(), new MeshBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false, side: DoubleSide }));
  #room = 0;
  #count = 0;

  constructor() {
    this.mesh.frustumCulled = false;
  }

  /**
   * Shows these lines in place of the ones before.
   * @param lines [{points: [[x, y], ...], width [m], height above the floor [m], color, alpha, dash: [on, off] [m] or null}]
   */
  show(lines) {
    this.#count = 0;
    for (const { points, width, height, color, alpha = 1, dash = null } of lines) {
      const shade = [...new Color(color).toArray(), alpha];
      for (const [from, to] of dash ? dashes(points, ...dash) : pairs(points)) this.#add(from, to, width / 2, height, shade);
    }
    const { geometry } = this.mesh;
    this.mesh.visible = this.#count > 0;
    geometry.setDrawRange(0, CORNERS.length * this.#count);
    for (const attribute of Object.values(geometry.attributes)) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, 4 * attribute.itemSize * this.#count);
      attribute.needsUpdate = true;
    }
  }

  #add([x0, y0], [x1, y1], half, height, shade) {
    const length = Math.hypot(x1 - x0, y1 - y0);
    if (length < 1e-6) return;
    if (this.#count === this.#room) this.#grow();
    const [nx, ny] = [(-(y1 - y0) / length) * half, ((x1 - x0) / length) * half];
    const { position, color } = this.mesh.geometry.attributes;
    const corner = 4 * this.#count;
    position.setXYZ(corner, x0 + nx, y0 + ny, height).setXYZ(corner + 1, x0 - nx, y0 - ny, height);
    position.setXYZ(corner + 2, x1 + nx, y1 + ny, height).setXYZ(corner + 3, x1 - nx, y1 - ny, height);
    for (let at = corner; at < corner + 4; at += 1) color.setXYZW(at, ...shade);
    this.#count += 1;
  }

  #grow() {
    const before = this.mesh.geometry;
    this.#room = Math.max(ROOM, 2 * this.#room);
    const geometry = new BufferGeometry();
    for (const [name, size] of [["position", 3], ["color", 4]]) {
      const array = new Float32Array(4 * size * this.#room);
      if (before.attributes[name]) array.set(before.attributes[name].array);
      geometry.setAttribute(name, new BufferAttribute(array, size).setUsage(DynamicDrawUsage));
    }
    const index = Uint32Array.from({ length: CORNERS.length * this.#room }, (_, at) => 4 * Math.floor(at / CORNERS.length) + CORNERS[at % CORNERS.length]);
    this.mesh.geometry = geometry.setIndex(new BufferAttribute(index, 1));
    before.dispose();
  }
}

const pairs = (line) => line.slice(1).map((point, at) => [line[at], point]);

function* dashes(line, on, off) {
  let along = 0;
  for (const [from, to] of pairs(line)) {
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const point = (at) => [from[0] + ((to[0] - from[0]) * at) / length, from[1] + ((to[1] - from[1]) * at) / length];
    for (let at = -(along % (on + off)); at < length; at += on + off) {
      if (at + on > 0) yield [point(Math.max(0, at)), point(Math.min(length, at + on))];
    }
    along += length;
  }
}
