// What stands still: the floor with its grid, walls, cells, places and zones of the map.

import {
  BoxGeometry, CanvasTexture, CircleGeometry, Color, DoubleSide, Group, InstancedMesh, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, PlaneGeometry,
  Quaternion, RingGeometry, Shape, ShapeGeometry, SRGBColorSpace, Vector3, LineBasicMaterial, LineSegments, BufferAttribute, BufferGeometry,
} from "../vendor/three-0.187.0/three.js";
import { Ribbons } from "./ribbons.js";
import { clear, label, merge } from "./shapes.js";
import { meshOf } from "./solids.js";

const THICK = 0.06; // m, of walls
const MOST_CELLS = 40000; // that are extruded; more stay a picture on the floor
const AROUND = 3; // m of floor around the map
const COLOURS = { goal: "goal", dock: "dock", home: "home", place: "ink" };

export class Floor {
  group = new Group();
  #made = "";

  /** Builds it anew if map, colours or layers are others. @param version counts those changes */
  show(version, plan, palette, shown) {
    if (version === this.#made) return;
    this.#made = version;
    clear(this.group);
    const box = plan.bounds ?? { left: -5, right: 5, bottom: -5, top: 5 };
    if (shown("grid")) this.#addGrid(box, palette);
    if (shown("map")) {
      this.#addWalls(plan, palette);
      for (const grid of plan.grids) this.#addCells(grid, plan.wallHeight, palette);
      if (plan.solids.length) this.group.add(meshOf(plan.solids, palette));
    }
    if (shown("zones")) for (const item of plan.objects) if (item.points.length && !item.solid) this.#addZone(item, palette);
    if (shown("places")) this.#addPlaces(plan.objects.filter(({ points }) => !points.length), palette);
    if (shown("names")) this.#addNames(plan.objects, palette, shown);
  }

  dispose() {
    clear(this.group);
  }

  #addGrid({ left, right, bottom, top }, palette) {
    const [x0, x1, y0, y1] = [Math.floor(left - AROUND), Math.ceil(right + AROUND), Math.floor(bottom - AROUND), Math.ceil(top + AROUND)];
    const step = Math.max(1, 2 ** Math.ceil(Math.log2(Math.max(x1 - x0, y1 - y0) / 200)));
    for (const [major, colour] of [[false, palette.grid], [true, palette["grid-major"]]]) {
      const ends = [];
      for (let x = x0; x <= x1; x += step) if ((x % (5 * step) === 0) === major) ends.push(x, y0, 0, x, y1, 0);
      for (let y = y0; y <= y1; y += step) if ((y % (5 * step) === 0) === major) ends.push(x0, y, 0, x1, y, 0);
      const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
      this.group.add(new LineSegments(geometry, new LineBasicMaterial({ color: brighter(colour, palette) })));
    }
  }

  #addWalls({ walls, heights, wallHeight }, palette) {
    const upright = walls.map((wall, at) => ({ wall, height: heights[at] ?? wallHeight })).filter(({ height }) => height > 0);
    const mesh = boxes(upright.length, softer(palette));
    const [turn, up] = [new Quaternion(), new Vector3(0, 0, 1)];
    upright.forEach(({ wall: [x0, y0, x1, y1], height }, at) => {
      const length = Math.hypot(x1 - x0, y1 - y0) + THICK;
      turn.setFromAxisAngle(up, Math.atan2(y1 - y0, x1 - x0));
      mesh.setMatrixAt(at, new Matrix4().compose(new Vector3((x0 + x1) / 2, (y0 + y1) / 2, height / 2), turn, new Vector3(length, THICK, height)));
    });
    this.group.add(mesh);
  }

  #addCells(grid, tall, palette) {
    const [x, y, theta] = grid.corner;
    const part = new Group();
    part.position.set(x, y, 0);
    part.rotation.z = theta;
    this.group.add(part);
    const [width, height] = [grid.width * grid.side, grid.height * grid.side];
    const map = new CanvasTexture(grid.picture(palette));
    Object.assign(map, { flipY: false, /* row 0 is the lowest */ colorSpace: SRGBColorSpace });
    const picture = new Mesh(new PlaneGeometry(width, height), new MeshBasicMaterial({ map, transparent: true, side: DoubleSide, depthWrite: false }));
    picture.position.set(width / 2, height / 2, -0.01);
    part.add(picture);
    const cells = grid.occupied();
    if (cells.length === 0 || cells.length > MOST_CELLS) return;
    const mesh = boxes(cells.length, softer(palette));
    const matrix = new Matrix4().makeScale(grid.side, grid.side, tall);
    cells.forEach(([column, row], at) => mesh.setMatrixAt(at, matrix.setPosition((column + 0.5) * grid.side, (row + 0.5) * grid.side, tall / 2)));
    part.add(mesh);
  }

  #addZone({ points, role, forbidden }, palette) {
    const color = forbidden ? palette.forbidden : palette.zone;
    const line = points.length > 2 ? [...points, points[0]] : points;
    const edge = new Ribbons();
    edge.show([{ points: line, width: forbidden ? 0.06 : 0.04, height: 0.012, color, dash: forbidden ? null : [0.25, 0.15] }]);
    this.group.add(edge.mesh);
    if (role !== "area") return;
    const shape = new Shape();
    points.forEach(([x, y], at) => (at ? shape.lineTo(x, y) : shape.moveTo(x, y)));
    const area = new Mesh(new ShapeGeometry(shape), flat(color, 0.18));
    area.position.z = 0.008;
    this.group.add(area);
  }

  #addPlaces(places, palette) {
    if (!places.length) return;
    const parts = places.flatMap(({ x, y, theta, role, heads }) => {
      const shapes = [new RingGeometry(0.2, 0.26, 32), new CircleGeometry(0.09, 24)];
      if (heads) shapes.push(new CircleGeometry(0.1, 3).translate(0.38, 0, 0).rotateZ(theta));
      return shapes.map((shape) => ({ geometry: shape.translate(x, y, 0.015), color: new Color(palette[COLOURS[role]]) }));
    });
    this.group.add(new Mesh(merge(parts), new MeshBasicMaterial({ vertexColors: true, side: DoubleSide })));
  }

  #addNames(objects, palette, shown) {
    for (const { name, points, x, y, solid, forbidden } of objects) {
      if (!name || !shown(points.length ? (solid ? "map" : "zones") : "places")) continue;
      const at = points.length ? points.reduce(([a, b], [px, py]) => [a + px / points.length, b + py / points.length], [0, 0]) : [x, y];
      const sprite = label(name, forbidden ? palette.forbidden : palette.label, palette.floor);
      sprite.position.set(...at, points.length ? 0.1 : 0.35);
      this.group.add(sprite);
    }
  }
}

/** Boxes of one colour that can be told apart: light falls on their sides. */
function boxes(count, color) {
  return new InstancedMesh(new BoxGeometry(1, 1, 1), new MeshLambertMaterial({ color }), count);
}

/** A colour without light, on the floor. */
export function flat(color, opacity = 1) {
  return new MeshBasicMaterial({ color, opacity, transparent: opacity < 1, side: DoubleSide, depthWrite: opacity === 1 });
}

/** A wall is a large area here: it is nearer to the floor's colour than its line on the flat map. */
const softer = (palette) => new Color(palette.wall).lerp(new Color(palette.floor), 0.25);

/** Lines are a pixel wide here: the grid needs a little more contrast than on the flat map. */
const brighter = (colour, palette) => new Color(colour).lerp(new Color(palette.wall), 0.08);
