// Grid, walls and scale bar. Walls are cut into tiles of Path2D, so that only what is seen is stroked.

import { drawPlaceNames, drawPlaces, drawZones } from "./draw_places.js";

const TILE = 8; // m
const MANY = 2500; // walls seen at once above which the soft edge is left out

export class Floor {
  #tiles = new Map(); // "column row" -> {path, count, box}
  #cells = [];
  /** What the map names: {role, kind, name, x, y, theta, heads, forbidden, solid, points}. */
  objects;
  /** Extent of walls, cells and objects, or null without any. */
  bounds = null;

  /** @param map of the server, `cells` read as Cells */
  constructor(map = null, cells = []) {
    this.objects = map?.objects ?? [];
    this.#cells = cells;
    for (const wall of map?.walls ?? []) this.#add(wall);
    for (const { outline } of cells) for (const [x, y] of outline) this.bounds = grow(this.bounds, x, y);
    for (const { x, y, points } of this.objects) {
      for (const [px, py] of points.length ? points : [[x, y]]) this.bounds = grow(this.bounds, px, py);
    }
  }

  /** All that stands still, in world coordinates. @param shown function(layer) */
  draw(context, camera, palette, ratio, shown) {
    if (shown("grid")) drawGrid(context, camera, palette);
    if (shown("map")) for (const cells of this.#cells) cells.draw(context, camera, palette, ratio);
    if (shown("zones")) drawZones(context, camera, palette, this.objects);
    if (shown("map")) this.drawWalls(context, camera, palette);
    if (shown("places")) drawPlaces(context, camera, palette, this.objects);
    if (!shown("names")) return;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawPlaceNames(context, camera, palette, this.objects, ({ points, solid }) => shown(points.length ? solid ? "map" : "zones" : "places"));
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

  drawWalls(context, view, palette) {
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

export function drawGrid(context, view, palette) {
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
