// The named objects of a map: goals, docks, homes, forbidden lines and areas, and others.

const LEGIBLE = 14; // px per m; smaller pictures have no names of places
const SIZE = 9; // px, half of a mark
const FONT = "600 12px system-ui, sans-serif";

/** Lines and areas, in world coordinates. */
export function drawZones(context, camera, palette, objects) {
  for (const item of objects) {
    if (item.points.length === 0 || item.solid) continue;
    const colour = item.forbidden ? palette.forbidden : palette.zone;
    trace(context, item.points);
    if (item.role === "area") hatch(context, camera, colour, item.points);
    context.strokeStyle = colour;
    context.lineWidth = (item.forbidden ? 2.5 : 1.5) / camera.scale;
    context.setLineDash(item.forbidden ? [] : [8 / camera.scale, 5 / camera.scale]);
    context.stroke();
    context.setLineDash([]);
    if (item.forbidden && item.role === "line") crosses(context, camera, item.points);
  }
}

function trace(context, points) {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  if (points.length > 2) context.closePath();
}

/** Slanting lines: a forbidden area can be recognised without its colour. */
function hatch(context, camera, colour, points) {
  const xs = points.map(([x]) => x);
  const ys = points.map(([, y]) => y);
  const [left, right, bottom, top] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const step = Math.max(12 / camera.scale, (right - left + top - bottom) / 400);
  context.save();
  context.clip();
  context.globalAlpha = 0.14;
  context.fillStyle = colour;
  context.fill();
  context.globalAlpha = 0.55;
  context.beginPath();
  for (let at = left - (top - bottom); at < right; at += step) {
    context.moveTo(at, bottom);
    context.lineTo(at + top - bottom, top);
  }
  context.strokeStyle = colour;
  context.lineWidth = 1 / camera.scale;
  context.stroke();
  context.restore();
  trace(context, points);
}

/** Small crosses along a forbidden line. */
function crosses(context, camera, [[x0, y0], [x1, y1]]) {
  const length = Math.hypot(x1 - x0, y1 - y0);
  const arm = 4 / camera.scale;
  const count = Math.min(200, Math.max(1, Math.floor((length * camera.scale) / 48)));
  context.beginPath();
  for (let index = 0; index < count; index += 1) {
    const k = (index + 0.5) / count;
    const [x, y] = [x0 + (x1 - x0) * k, y0 + (y1 - y0) * k];
    context.moveTo(x - arm, y - arm);
    context.lineTo(x + arm, y + arm);
    context.moveTo(x - arm, y + arm);
    context.lineTo(x + arm, y - arm);
  }
  context.stroke();
}

/** Marks of goals, docks and homes, in world coordinates. */
export function drawPlaces(context, camera, palette, objects) {
  for (const item of objects) {
    if (item.points.length) continue;
    context.save();
    context.translate(item.x, item.y);
    context.scale(1 / camera.scale, 1 / camera.scale); // marks have the same size on every scale
    if (item.heads) drawHeading(context, palette[COLOURS[item.role]], item.theta);
    MARKS[item.role](context, palette);
    context.restore();
  }
}

const COLOURS = { goal: "goal", dock: "dock", home: "home", place: "ink" };

function drawHeading(context, colour, theta) {
  context.save();
  context.rotate(theta);
  context.beginPath();
  context.moveTo(SIZE + 11, 0);
  context.lineTo(SIZE + 2, 5.5);
  context.lineTo(SIZE + 2, -5.5);
  context.closePath();
  context.fillStyle = colour;
  context.fill();
  context.restore();
}

const MARKS = {
  goal(context, palette) { // a ring with a point: a target
    circle(context, SIZE);
    fillAndRing(context, palette, palette.goal);
    circle(context, 3);
    context.fillStyle = palette.goal;
    context.fill();
  },
  dock(context, palette) { // a square with a bolt
    context.beginPath();
    context.roundRect(-SIZE, -SIZE, 2 * SIZE, 2 * SIZE, 4);
    fillAndRing(context, palette, palette.dock);
    context.beginPath();
    for (const [x, y] of [[1.5, 6], [-4, -1], [-0.5, -1], [-1.5, -6], [4, 1], [0.5, 1]]) context.lineTo(x, y);
    context.closePath();
    context.fillStyle = palette.dock;
    context.fill();
  },
  home(context, palette) { // a house
    context.beginPath();
    for (const [x, y] of [[-8, -8], [8, -8], [8, 2], [0, 10], [-8, 2]]) context.lineTo(x, y);
    context.closePath();
    fillAndRing(context, palette, palette.home);
  },
  place(context, palette) { // a point
    circle(context, 4);
    fillAndRing(context, palette, palette.ink);
  },
};

function circle(context, radius) {
  context.beginPath();
  context.arc(0, 0, radius, 0, 2 * Math.PI);
}

function fillAndRing(context, palette, colour) {
  context.fillStyle = palette.floor;
  context.globalAlpha = 0.85;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.stroke();
}

/** Names below the marks and in the areas, in CSS pixels of the camera. */
export function drawPlaceNames(context, camera, palette, objects, shown) {
  if (camera.scale < LEGIBLE) return;
  Object.assign(context, {
    font: FONT, textAlign: "center", textBaseline: "top", lineWidth: 3, lineJoin: "round", strokeStyle: palette.floor,
  });
  for (const item of objects) {
    if (!item.name || !shown(item)) continue;
    const { x, y } = item.points.length ? middle(item.points) : item;
    const at = camera.toScreen(x, y);
    const below = at.y + (item.points.length ? -6 : SIZE + 5);
    context.fillStyle = item.forbidden ? palette.forbidden : palette.label;
    context.strokeText(item.name, at.x, below);
    context.fillText(item.name, at.x, below);
  }
  context.textBaseline = "alphabetic";
}

function middle(points) {
  const sum = points.reduce(([a, b], [x, y]) => [a + x, b + y], [0, 0]);
  return { x: sum[0] / points.length, y: sum[1] / points.length };
}

/** The goal or dock at a point of the map, at most `slack` [m] away. */
export function placeAt(objects, { x, y }, slack) {
  let [best, least] = [null, slack];
  for (const item of objects) {
    if (item.points.length || !["goal", "dock", "home"].includes(item.role)) continue;
    const far = Math.hypot(item.x - x, item.y - y);
    if (far <= least) [best, least] = [item, far];
  }
  return best;
}
