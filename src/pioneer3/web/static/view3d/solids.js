// The solids of the map: steps, ramps, carpets, cylinders, tables, height fields, meshes. One mesh draws them all.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DoubleSide, Matrix4, Mesh, MeshLambertMaterial,
} from "../vendor/three-0.187.0/three.js";
import { merge } from "./shapes.js";

const SIDES = 32; // of a cylinder
const [LOW, HIGH] = [0.65, 1.45]; // shades of a terrain

/** @param solids of the map, at least one @type {import("../messages.d.ts").MapSolid[]} */
export function meshOf(solids, palette) {
  const parts = solids.flatMap((solid) => solid.shapes.map((shape) => ({ geometry: placed(shape), color: colourOf(solid, palette) })));
  return new Mesh(merge(parts), new MeshLambertMaterial({ vertexColors: true, side: DoubleSide }));
}

function colourOf({ kind, ground }, palette) {
  if (kind === "carpet") return new Color(palette.zone).lerp(new Color(palette.floor), 0.55);
  const other = ground ? palette.floor : palette["box-edge"];
  return new Color(palette.wall).lerp(new Color(other), ["ramp", "heightfield"].includes(kind) ? 0.45 : ground ? 0.62 : 0.55);
}

function placed(shape) {
  const { at: [x, y, z, theta] } = shape;
  return geometryOf(shape).applyMatrix4(new Matrix4().makeRotationZ(theta).setPosition(x, y, z));
}

/** A shape that stands on its foot, with an index and normals. */
function geometryOf({ form, size: [length, width, height], numbers, corners, columns }) {
  switch (form) {
    case "block":
      return new BoxGeometry(length, width, height).translate(0, 0, height / 2);
    case "column":
      return new CylinderGeometry(length / 2, length / 2, height, SIDES).rotateX(Math.PI / 2).translate(0, 0, height / 2);
    case "wedge":
      return wedge(length / 2, width / 2, height);
    case "terrain":
      return terrain(length, width, height, numbers, columns);
    default:
      return faceted(numbers, corners);
  }
}

function wedge(x, y, z) {
  const points = [-x, -y, 0, -x, y, 0, x, -y, 0, x, y, 0, x, -y, z, x, y, z];
  return faceted(points, [0, 4, 5, 0, 5, 1, 2, 3, 5, 2, 5, 4, 0, 2, 4, 1, 5, 3]);
}

/** Triangles with edges: none shares a point with another. */
function faceted(numbers, corners) {
  const position = new Float32Array(corners.flatMap((corner) => numbers.slice(3 * corner, 3 * corner + 3)));
  return withNormals(position, corners.map((_, at) => at));
}

/** Higher places are lighter: seen from above the light alone tells little. */
function terrain(length, width, height, numbers, columns) {
  const rows = numbers.length / columns;
  const position = new Float32Array(numbers.flatMap((z, at) => (
    [((at % columns) / (columns - 1) - 0.5) * length, (Math.floor(at / columns) / (rows - 1) - 0.5) * width, z]
  )));
  const index = [];
  for (let row = 0; row + 1 < rows; row += 1) {
    for (let column = 0; column + 1 < columns; column += 1) {
      const at = row * columns + column;
      index.push(at, at + 1, at + columns + 1, at, at + columns + 1, at + columns);
    }
  }
  const geometry = withNormals(position, index);
  geometry.userData.shades = numbers.map((z) => LOW + ((HIGH - LOW) * z) / height);
  return geometry;
}

function withNormals(position, index) {
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(position, 3)).setIndex(index);
  geometry.computeVertexNormals();
  return geometry;
}
