// Geometry that several parts of the 3-D view share: merged solids, ribbons on the floor, labels.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, CanvasTexture, Color, CylinderGeometry, Euler, Matrix4, Quaternion, Sprite, SpriteMaterial, SRGBColorSpace, Vector3,
} from "../vendor/three-0.187.0/three.js";
import { make } from "../dom.js";

const sidesOf = (width) => (width < 0.05 ? 8 : 16); // of a cylinder [m]
const TEXT = 28; // px, height of a label's letters in its picture
const LABEL = 0.028; // height of a label on the screen, as a share of it

/** One geometry of many boxes and cylinders with colours. @param parts [{solid, matrix}] of a body from the server */
export function mergeSolids(parts) {
  const made = parts.map(({ solid, matrix }) => {
    const [x, y, z] = solid.size;
    const geometry = solid.shape === "box" ? new BoxGeometry(x, y, z) : new CylinderGeometry(x / 2, x / 2, z, sidesOf(x)).rotateX(Math.PI / 2);
    const [roll, pitch, yaw] = solid.turned;
    const turned = new Quaternion().setFromEuler(new Euler(roll, pitch, yaw, "ZYX"));
    const own = new Matrix4().compose(new Vector3(...solid.at), turned, new Vector3(1, 1, 1));
    return { geometry: geometry.applyMatrix4(own.premultiply(matrix)), color: new Color().setRGB(...solid.color, SRGBColorSpace) };
  });
  return merge(made);
}

/** One geometry with colours. @param parts [{geometry, color}]; their geometries are freed */
export function merge(parts) {
  const flat = parts.map(({ geometry, color }) => ({ geometry: geometry.index ? geometry.toNonIndexed() : geometry, color }));
  const count = flat.reduce((sum, { geometry }) => sum + geometry.attributes.position.count, 0);
  const [position, normal, colours] = [0, 1, 2].map(() => new Float32Array(3 * count));
  let at = 0;
  for (const { geometry, color } of flat) {
    position.set(geometry.attributes.position.array, 3 * at);
    normal.set(geometry.attributes.normal.array, 3 * at);
    for (let end = at + geometry.attributes.position.count; at < end; at += 1) colours.set([color.r, color.g, color.b], 3 * at);
    geometry.dispose();
  }
  const merged = new BufferGeometry();
  for (const [name, array] of [["position", position], ["normal", normal], ["color", colours]]) merged.setAttribute(name, new BufferAttribute(array, 3));
  return merged;
}

/**
 * Flat ribbons on the floor along lines of points.
 * @param lines [[[x, y], ...]]; width, height above the floor [m]; dash [on, off] [m] or null
 */
export function ribbons(lines, width, height, dash = null) {
  const corners = [];
  const piece = ([x0, y0], [x1, y1]) => {
    const length = Math.hypot(x1 - x0, y1 - y0);
    if (length < 1e-6) return;
    const [nx, ny] = [(-(y1 - y0) / length) * (width / 2), ((x1 - x0) / length) * (width / 2)];
    const [a, b, c, d] = [[x0 + nx, y0 + ny], [x0 - nx, y0 - ny], [x1 + nx, y1 + ny], [x1 - nx, y1 - ny]];
    for (const [x, y] of [a, b, c, c, b, d]) corners.push(x, y, height);
  };
  for (const line of lines) for (const [from, to] of dash ? dashes(line, ...dash) : pairs(line)) piece(from, to);
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(corners), 3));
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

/** A name that faces the camera, of one size on the screen; its picture is freed by `free`. */
export function label(text, colour, halo) {
  const canvas = make("canvas");
  const context = canvas.getContext("2d");
  const font = `600 ${TEXT}px system-ui, sans-serif`;
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 12;
  canvas.height = TEXT + 14;
  Object.assign(context, { font, textBaseline: "middle", lineWidth: 7, lineJoin: "round", strokeStyle: halo, fillStyle: colour });
  context.strokeText(text, 6, canvas.height / 2);
  context.fillText(text, 6, canvas.height / 2);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, transparent: true }));
  sprite.scale.set((LABEL * canvas.width) / canvas.height, LABEL, 1);
  sprite.center.set(0.5, 0);
  sprite.renderOrder = 10;
  return sprite;
}

/** Takes all children out of a group and frees what they hold on the graphics card. */
export function clear(group) {
  for (const child of [...group.children]) free(child);
}

/** Takes an object out of its parent and frees all that it, and what is in it, holds; shared geometries and materials stay. */
export function free(object) {
  object.removeFromParent();
  object.traverse(({ geometry, material, isInstancedMesh, isSprite, userData, dispose }) => {
    if (geometry && !isSprite && !userData.shared) geometry.dispose();
    if (material && !userData.shared) (material.map?.dispose(), material.dispose());
    if (isInstancedMesh) dispose?.call(object);
  });
}
