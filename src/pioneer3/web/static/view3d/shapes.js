// Geometry that several parts of the 3-D view share: merged colours, labels, and freeing.

import { BufferAttribute, BufferGeometry, CanvasTexture, Sprite, SpriteMaterial, SRGBColorSpace } from "../vendor/three-0.187.0/three.js";
import { make } from "../dom.js";

const TEXT = 28; // px, height of a label's letters in its picture
const LABEL = 0.028; // height of a label on the screen, as a share of it

/** One geometry with colours. @param parts [{geometry, color}] with indices, perhaps shades of each point; their geometries are freed */
export function merge(parts) {
  const count = parts.reduce((sum, { geometry }) => sum + geometry.attributes.position.count, 0);
  const [position, normal, colours] = [0, 1, 2].map(() => new Float32Array(3 * count));
  const index = [];
  let at = 0;
  for (const { geometry, color } of parts) {
    position.set(geometry.attributes.position.array, 3 * at);
    normal.set(geometry.attributes.normal.array, 3 * at);
    for (const corner of geometry.index.array) index.push(at + corner);
    const { shades } = geometry.userData;
    for (let own = 0; own < geometry.attributes.position.count; own += 1, at += 1) {
      const shade = shades ? shades[own] : 1;
      colours.set([color.r * shade, color.g * shade, color.b * shade], 3 * at);
    }
    geometry.dispose();
  }
  const merged = new BufferGeometry().setIndex(index);
  for (const [name, array] of [["position", position], ["normal", normal], ["color", colours]]) merged.setAttribute(name, new BufferAttribute(array, 3));
  return merged;
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

/** Takes an object out of its parent and frees all that it and its children hold on the graphics card. */
export function free(object) {
  object.removeFromParent();
  object.traverse((part) => {
    const { geometry, material, isInstancedMesh, isSprite } = part;
    if (geometry && !isSprite) geometry.dispose();
    if (material) (material.map?.dispose(), material.dispose());
    if (isInstancedMesh) part.dispose();
  });
}
