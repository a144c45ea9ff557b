// The named objects of a map: goals, docks, homes, forbidden lines and areas, and others.

const LEGIBLE = 14; // px per m; smaller pictures have no names of places
const SIZE = 9; // px, half of a mark
const FONT = "600 12px system-ui, sans-serif";
const CHIP = { height: 22, below: SIZE + 4, beside: 9 }; // px, of the name of a place that looks like a button
const SENT_TO = ["goal", "dock", "home"]; // roles of places that a robot can be sent to
const RULER = document.createElement("canvas").getContext("2d");

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

/**
 * Names below the marks and in the areas, in CSS pixels of the camera.
 * @param offers whether a robot can be sent to places: then they look like buttons
 */
export function drawPlaceNames(context, camera, palette, objects, shown, offers) {
  if (camera.scale < LEGIBLE) return;
  Object.assign(context, {
    font: FONT, textAlign: "center", textBaseline: "top", lineWidth: 3, lineJoin: "round", strokeStyle: palette.floor,
  });
  const chips = chipsOf(objects, camera);
  for (const item of objects) {
    if (!item.name || !shown(item) || (offers && hasChip(item) && !chips.has(item))) continue;
    const { x, y } = item.points.length ? middle(item.points) : item;
    const at = camera.toScreen(x, y);
    const below = at.y + (item.points.length ? -6 : SIZE + 5);
    const chip = offers ? chips.get(item) : null;
    context.fillStyle = item.forbidden ? palette.forbidden : palette.label;
    if (chip) drawChip(context, palette, chip, palette[COLOURS[item.role]]);
    else context.strokeText(item.name, at.x, below);
    if (chip) context.fillStyle = palette.label;
    context.fillText(item.name, at.x, chip ? chip.top + 5 : below);
  }
  context.textBaseline = "alphabetic";
}

function middle(points) {
  const sum = points.reduce(([a, b], [x, y]) => [a + x, b + y], [0, 0]);
  return { x: sum[0] / points.length, y: sum[1] / points.length };
}

const hasChip = ({ points, name, role }) => !points.length && name && SENT_TO.includes(role);

/** The boxes of the names of places that a robot can be sent to [CSS px]; none lies upon another. */
function chipsOf(objects, camera) {
  const chips = new Map();
  if (camera.scale < LEGIBLE) return chips;
  for (const item of objects.filter(hasChip)) {
    const chip = chipOf(item, camera);
    if (![...chips.values()].some((other) => meet(chip, other))) chips.set(item, chip);
  }
  return chips;
}

function meet(one, other) {
  return Math.abs(one.left + one.width / 2 - other.left - other.width / 2) < (one.width + other.width) / 2 && Math.abs(one.top - other.top) < CHIP.height;
}

function chipOf(item, camera) {
  RULER.font = FONT;
  const { x, y } = camera.toScreen(item.x, item.y);
  const width = RULER.measureText(item.name).width + 2 * CHIP.beside;
  return { left: x - width / 2, top: y + CHIP.below, width, height: CHIP.height };
}

function drawChip(context, palette, { left, top, width, height }, colour, line = 1.25) {
  const { fillStyle, strokeStyle, lineWidth } = context;
  context.beginPath();
  context.roundRect(left, top, width, height, height / 2);
  Object.assign(context, { fillStyle: palette.floor, strokeStyle: colour, lineWidth: line });
  context.fill();
  context.stroke();
  Object.assign(context, { fillStyle, strokeStyle, lineWidth });
}

/** Marks the place under the mouse, in world coordinates: a click offers to go there. */
export function drawHovered(context, camera, palette, item) {
  const chip = hasChip(item) ? chipOf(item, camera) : null;
  context.save();
  context.translate(item.x, item.y);
  context.scale(1 / camera.scale, -1 / camera.scale);
  context.strokeStyle = palette.target;
  context.lineWidth = 3;
  context.beginPath();
  context.arc(0, 0, SIZE + 5, 0, 2 * Math.PI);
  context.stroke();
  if (chip) {
    const [left, top] = [-chip.width / 2, CHIP.below];
    drawChip(context, palette, { ...chip, left, top }, palette.target, 2);
    Object.assign(context, { font: FONT, textAlign: "center", textBaseline: "top", fillStyle: palette.label });
    context.fillText(item.name, 0, top + 5);
  }
  context.restore();
}

/** The place that a robot can be sent to at a point of the canvas, its name included, at most `slack` px beside its mark, or null. */
export function placeAt(objects, camera, { x, y }, slack) {
  let [best, least] = [null, slack];
  const chips = chipsOf(objects, camera);
  for (const item of objects) {
    if (item.points.length || !SENT_TO.includes(item.role)) continue;
    const at = camera.toScreen(item.x, item.y);
    const far = Math.hypot(at.x - x, at.y - y);
    const chip = chips.get(item);
    const named = chip && x >= chip.left && x <= chip.left + chip.width && y >= chip.top && y <= chip.top + chip.height;
    if (far <= least) [best, least] = [item, far];
    else if (named && !best) best = item;
  }
  return best;
}
