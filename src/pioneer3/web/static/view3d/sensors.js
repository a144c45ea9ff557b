// Sonar cones and laser points, with the colours of the flat map.

import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Group, InstancedMesh, Matrix4, MeshBasicMaterial, Points, PointsMaterial, Quaternion, Vector3,
} from "../vendor/three-0.187.0/three.js";
import { HALF, colourOf } from "../map/sensors.js";
import { clear, free } from "./shapes.js";

const HEIGHT = 0.2; // m, of sonars and of laser points above the floor
const LASER_HEIGHT = 0.3;
const MOST = 16; // sonars of a robot at first; more make the mesh anew
const POINT = 4; // px
const RIM = 0.012; // half the height of an echo's arc, as a share of its range
const STEPS = 5; // of an arc
const [INNER, OUTER] = [0.05, 0.3]; // opacity of a cone at the transducer and at the echo

export class Sensors {
  group = new Group();
  #cones = null;
  #rims = null;
  #points = null;
  #scans = []; // that are drawn
  #palette = null;

  /** @param placed [[Robot, pose]] */
  show(placed, { selected, isLive, shown, paused, palette, ground }) {
    if (palette !== this.#palette) (this.dispose(), (this.#palette = palette));
    this.#showSonar(shown("sonar") ? placed : [], { selected, isLive, palette, ground });
    this.#showLasers(shown("laser") ? placed.filter(([robot]) => (robot.scanning || paused) && robot.points) : [], palette, ground);
  }

  /** Cones of the selected robot; of the others only the ends where something echoed. */
  #showSonar(placed, { selected, isLive, palette, ground }) {
    this.#reserve(placed.reduce((sum, [{ shape }]) => sum + (shape?.sonars.length ?? 0), 0));
    let [cones, rims] = [0, 0];
    for (const [robot, pose] of placed) {
      const { shape, snapshot } = robot;
      const chosen = robot === selected;
      if (!shape || !snapshot?.sonar.enabled || !(chosen || isLive(robot))) continue;
      const base = new Matrix4().makeRotationZ(pose.theta).setPosition(pose.x, pose.y, HEIGHT + ground.height(pose.x, pose.y));
      snapshot.sonar.ranges.forEach((range, number) => {
        const mount = shape.sonars[number];
        if (!mount || range === null) return; // nothing echoed: no cone hides the view
        const reach = Math.max(range, 0.01);
        const own = new Matrix4().compose(new Vector3(mount.x, mount.y, 0), new Quaternion().setFromAxisAngle(UP, mount.theta), new Vector3(reach, reach, reach));
        const colour = new Color(...shadeOf(range, palette));
        own.premultiply(base);
        if (chosen) put(this.#cones, cones++, own, colour);
        put(this.#rims, rims++, own, colour);
      });
    }
    for (const [mesh, count] of [[this.#cones, cones], [this.#rims, rims]]) {
      mesh.count = count;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
  }

  #reserve(count) {
    if (this.#cones && this.#cones.userData.room >= count) return;
    for (const mesh of [this.#cones, this.#rims]) if (mesh) free(mesh);
    const room = Math.max(MOST, 2 * count);
    this.#cones = cone(room, 0);
    this.#rims = cone(room, 1);
    this.group.add(this.#cones, this.#rims);
  }

  /** The points of all lasers, written anew when a scan has come. */
  #showLasers(placed, palette, ground) {
    const scans = placed.map(([robot]) => robot.points);
    if (scans.length === this.#scans.length && scans.every((points, at) => points === this.#scans[at])) return;
    this.#scans = scans;
    const count = scans.reduce((sum, points) => sum + points.length / 2, 0);
    if (!this.#points || this.#points.geometry.attributes.position.count < count) {
      if (this.#points) free(this.#points);
      const position = new BufferAttribute(new Float32Array(3 * 2 * count), 3).setUsage(DynamicDrawUsage);
      this.#points = new Points(new BufferGeometry().setAttribute("position", position), new PointsMaterial({ color: palette.laser, size: POINT, sizeAttenuation: false }));
      this.#points.frustumCulled = false;
      this.group.add(this.#points);
    }
    const { geometry } = this.#points;
    const { position } = geometry.attributes;
    let at = 0;
    for (const [{ points }, { x, y }] of placed) {
      const height = LASER_HEIGHT + ground.height(x, y);
      for (let k = 0; k < points.length; k += 2) position.setXYZ(at++, points[k], points[k + 1], height);
    }
    position.needsUpdate = true;
    geometry.setDrawRange(0, count);
  }

  dispose() {
    clear(this.group);
    this.#cones = this.#rims = this.#points = null;
    this.#scans = [];
  }
}

const UP = new Vector3(0, 0, 1);

/** Fans of length 1 along x, or with `from` only their ends. */
function cone(room, from) {
  const geometry = from ? ringEnd() : fan();
  const material = new MeshBasicMaterial({ vertexColors: !from, transparent: !from, depthWrite: Boolean(from), side: DoubleSide });
  const mesh = new InstancedMesh(geometry, material, room);
  Object.assign(mesh, { count: 0, frustumCulled: false, userData: { room } });
  return mesh;
}

/** A flat cone that is fainter at the transducer than at the echo. */
function fan() {
  const [corners, colours] = [[], []];
  for (let at = 0; at < STEPS; at += 1) {
    const [a, b] = [at, at + 1].map((k) => -HALF + (2 * HALF * k) / STEPS);
    corners.push(0, 0, 0, Math.cos(a), Math.sin(a), 0, Math.cos(b), Math.sin(b), 0);
    for (const alpha of [INNER, OUTER, OUTER]) colours.push(1, 1, 1, alpha);
  }
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(corners), 3))
    .setAttribute("color", new BufferAttribute(new Float32Array(colours), 4));
}

/** The arc where a sonar's echo lies: an upright strip across the end of the cone. */
function ringEnd() {
  const corners = [];
  for (let at = 0; at < STEPS; at += 1) {
    const [a, b] = [at, at + 1].map((k) => -HALF + (2 * HALF * k) / STEPS);
    const [p, q] = [a, b].map((angle) => [Math.cos(angle), Math.sin(angle)]);
    for (const [[x, y], z] of [[p, -RIM], [q, -RIM], [p, RIM], [p, RIM], [q, -RIM], [q, RIM]]) corners.push(x, y, z);
  }
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(corners), 3));
}

function put(mesh, at, matrix, colour) {
  mesh.setMatrixAt(at, matrix);
  mesh.setColorAt(at, colour);
}

/** The flat map's colour of a range, as red, green and blue of light. */
function shadeOf(range, palette) {
  const [r, g, b] = colourOf(range, palette).match(/\d+/g).map((part) => part / 255);
  return new Color().setRGB(r, g, b, "srgb").toArray();
}
