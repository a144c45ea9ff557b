// The map: occupancy grids, walls, the metric grid and the scale bar.

import { make } from "../dom.js";
import { drawChanges } from "./changes.js";
import { drawPlaceNames, drawPlaces, drawZones } from "./places.js";

const TILE = 8; // m
const MANY = 2500; // visible walls above which the soft edge is left out
const FREE_ALPHA = 150; // of 255: the grid shows through free cells
const [OCCUPIED, FREE] = [1, 2]; // as the server has them; the shades are 85 times as bright

/** Walls in tiles of Path2D, so that only visible ones are stroked, with grids and named objects. */
export class FloorPlan {
  #tiles = new Map(); // "column row" -> {path, count, box}
  /** Walls [x0, y0, x1, y1] [m]. */
  walls;
  /** Cells, as OccupancyGrids. */
  grids;
  /** Objects that the map names. @type {import("../messages.d.ts").DrawnObject[]} */
  objects;
  /** Solids with heights. @type {import("../messages.d.ts").MapSolid[]} */
  solids;
  /** Of each wall [m], or of all where there are none. */
  heights;
  wallHeight;
  /** What has come and gone. @type {import("../messages.d.ts").DrawnChange[]} */
  changes;
  /** Extent of walls, cells and objects, or null without any. */
  bounds = null;

  /** @param {import("../messages.d.ts").Drawing | null} map @param grids [OccupancyGrid], read from it */
  constructor(map = null, grids = []) {
    this.objects = map?.objects ?? [];
    this.walls = map?.walls ?? [];
    this.grids = grids;
    this.solids = map?.solids ?? [];
    this.heights = map?.heights ?? [];
    this.changes = map?.changes ?? [];
    this.wallHeight = map?.wall_height ?? 1;
    for (const wall of this.walls) this.#add(wall);
    for (const { outline } of this.solids) for (const [x, y] of outline) this.bounds = grow(this.bounds, x, y);
    for (const { outline } of grids) for (const [x, y] of outline) this.bounds = grow(this.bounds, x, y);
    for (const { x, y, points } of this.objects) {
      for (const [px, py] of points.length ? points : [[x, y]]) this.bounds = grow(this.bounds, px, py);
    }
  }

  /** Draws all of it, in world coordinates. @param shown function(layer) @param offers whether a robot can be sent to places */
  draw(context, camera, palette, ratio, shown, offers) {
    if (shown("grid")) drawGrid(context, camera, palette);
    if (shown("map")) for (const grid of this.grids) grid.draw(context, camera, palette, ratio);
    if (shown("map")) this.#drawSolids(context, camera, palette);
    if (shown("zones")) drawZones(context, camera, palette, this.objects);
    if (shown("map")) this.#drawWalls(context, camera, palette);
    if (shown("changes")) drawChanges(context, camera, palette, this.changes);
    if (shown("places")) drawPlaces(context, camera, palette, this.objects);
    if (!shown("names")) return;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawPlaceNames(context, camera, palette, this.objects, ({ points, solid }) => shown(points.length ? solid ? "map" : "zones" : "places"), offers);
  }

  #add([x0, y0, x1, y1]) {
    const key = `${Math.floor((x0 + x1) / 2 / TILE)} ${Math.floor((y0 + y1) / 2 / TILE)}`;
    if (!this.#tiles.has(key)) this.#tiles.set(key, { path: new Path2D(), count: 0, box: null });
    const tile = this.#tiles.get(key);
    tile.path.moveTo(x0, y0);
    tile.path.lineTo(x1, y1);
    tile.count += 1;
    tile.box = grow(grow(tile.box, x0, y0), x1, y1);
    this.bounds = grow(grow(this.bounds, x0, y0), x1, y1);
  }

  /** What is flat floor here, and the tops of tables: faint outlines. */
  #drawSolids(context, view, palette) {
    if (!this.solids.length) return;
    context.beginPath();
    for (const { outline } of this.solids) {
      outline.forEach(([x, y], at) => (at ? context.lineTo(x, y) : context.moveTo(x, y)));
      context.closePath();
    }
    context.strokeStyle = palette["wall-soft"];
    context.lineWidth = Math.max(0.03, 1.5 / view.scale);
    context.stroke();
  }

  #drawWalls(context, view, palette) {
    const seen = view.window;
    const tiles = [...this.#tiles.values()].filter(({ box }) => box.left <= seen.right && box.right >= seen.left
      && box.bottom <= seen.top && box.top >= seen.bottom);
    const few = tiles.reduce((sum, tile) => sum + tile.count, 0) < MANY;
    context.lineCap = "square";
    if (few) {
      context.strokeStyle = palette["wall-soft"];
      context.lineWidth = Math.max(0.14, 7 / view.scale);
      for (const { path } of tiles) context.stroke(path);
    }
    context.strokeStyle = palette.wall;
    context.lineWidth = Math.max(0.03, 2 / view.scale);
    for (const { path } of tiles) context.stroke(path);
  }
}

function grow(box, x, y) {
  if (!box) return { left: x, right: x, bottom: y, top: y };
  return {
    left: Math.min(box.left, x), right: Math.max(box.right, x),
    bottom: Math.min(box.bottom, y), top: Math.max(box.top, y),
  };
}

/** A round length of at least `pixels` on the screen: 1, 2 or 5 times a power of ten [m]. */
function roundLength(scale, pixels) {
  const least = pixels / scale;
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((k) => k * power >= least * 0.999);
}

function drawGrid(context, view, palette) {
  const { left, right, bottom, top } = view.window;
  const minor = Math.max(0.1, roundLength(view.scale, 32));
  for (const [step, colour] of [[minor, palette.grid], [minor * 5, palette["grid-major"]]]) {
    context.beginPath();
    for (let x = Math.ceil(left / step) * step; x <= right; x += step) {
      context.moveTo(x, bottom);
      context.lineTo(x, top);
    }
    for (let y = Math.ceil(bottom / step) * step; y <= top; y += step) {
      context.moveTo(left, y);
      context.lineTo(right, y);
    }
    context.strokeStyle = colour;
    context.lineWidth = 1 / view.scale;
    context.stroke();
  }
}

/** In CSS pixels, bottom left. */
export function drawScale(context, view, palette) {
  const length = roundLength(view.scale, 64);
  const [x, y, width] = [16, view.height - 16, length * view.scale];
  context.strokeStyle = context.fillStyle = palette.ink;
  context.lineWidth = 2;
  context.lineCap = "butt";
  context.beginPath();
  context.moveTo(x, y - 6);
  context.lineTo(x, y);
  context.lineTo(x + width, y);
  context.lineTo(x + width, y - 6);
  context.stroke();
  context.font = "600 12px system-ui, sans-serif";
  context.textAlign = "center";
  context.fillText(length >= 1 ? `${length} m` : `${Math.round(length * 100)} cm`, x + width / 2, y - 8);
}

/** Cells of a map: a small grey picture from the server, coloured once for each theme and size. */
export class OccupancyGrid {
  #states; // Uint8Array, the lowest row first
  #pictures = new Map(); // cells joined along each side -> canvas
  #colours = "";

  constructor(states, { width, height, side, corner }) {
    this.#states = states;
    Object.assign(this, { width, height, side, corner });
  }

  /** Reads a grid of the server. */
  static async read({ png, ...where }) {
    const bytes = Uint8Array.from(atob(png), (char) => char.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
    const { width, height } = picture;
    const context = makeCanvas(width, height).getContext("2d", { willReadFrequently: true });
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const states = Uint8Array.from({ length: width * height }, (_, at) => Math.round(data[4 * at] / 85));
    return new OccupancyGrid(states, { width, height, ...where });
  }

  /** The four corners in the map [m]. */
  get outline() {
    const [x, y, theta] = this.corner;
    const [c, s] = [Math.cos(theta), Math.sin(theta)];
    const [width, height] = [this.width * this.side, this.height * this.side];
    return [[0, 0], [width, 0], [width, height], [0, height]].map(([a, b]) => [x + c * a - s * b, y + s * a + c * b]);
  }

  /** Columns and rows of the occupied cells. */
  occupied() {
    const found = [];
    this.#states.forEach((state, at) => state === OCCUPIED && found.push([at % this.width, Math.floor(at / this.width)]));
    return found;
  }

  /** In world coordinates, about one cell a pixel where there are more: none gets lost. */
  draw(context, camera, palette, ratio) {
    const pixels = camera.scale * this.side * ratio;
    const joined = 2 ** Math.max(0, Math.floor(Math.log2(1 / pixels)));
    const [x, y, theta] = this.corner;
    context.save();
    context.translate(x, y);
    context.rotate(theta);
    context.scale(this.side * joined, this.side * joined); // row 0 is the lowest, as y grows upwards
    context.imageSmoothingEnabled = pixels < 3; // large cells have edges
    context.drawImage(this.picture(palette, joined), 0, 0);
    context.restore();
  }

  /** A canvas with a pixel for each cell, or for `joined` ones along each side; its first row is the lowest. */
  picture(palette, joined = 1) {
    const colours = `${palette.cell} ${palette.free}`;
    if (this.#colours !== colours) this.#pictures.clear();
    this.#colours = colours;
    if (!this.#pictures.has(joined)) this.#pictures.set(joined, this.#paint(joined, palette));
    return this.#pictures.get(joined);
  }

  #paint(joined, palette) {
    const [width, height] = [Math.ceil(this.width / joined), Math.ceil(this.height / joined)];
    const canvas = makeCanvas(width, height);
    const context = canvas.getContext("2d");
    const image = context.createImageData(width, height);
    const pixels = new Uint32Array(image.data.buffer);
    const [occupied, free] = [pixelOf(palette.cell, 255), pixelOf(palette.free, FREE_ALPHA)];
    this.#states.forEach((state, at) => {
      const here = Math.floor(Math.floor(at / this.width) / joined) * width + Math.floor((at % this.width) / joined);
      if (state === OCCUPIED) pixels[here] = occupied;
      else if (state === FREE && pixels[here] === 0) pixels[here] = free;
    });
    context.putImageData(image, 0, 0);
    return canvas;
  }
}

function makeCanvas(width, height) {
  return make("canvas", { width, height });
}

/** #rrggbb as four bytes of an image. */
function pixelOf(colour, alpha) {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  return new Uint32Array(new Uint8Array([r, g, b, alpha]).buffer)[0];
}
