// The robots, to scale, with their sensors; the ring around the selected one; their names.

import { drawLaser, drawPath, drawSonar } from "./sensors.js";

const OLD = 0.45; // opacity of a robot that does not report
const RING = 7; // px beside the robot
const LEGIBLE = 8; // px per m; smaller pictures have no names, but the selected one's
const SIZE = 0.3; // m, of a robot whose shape is not known
const SMALL = 26; // px; a shorter robot gets a ring to be found by
const GENERIC = { model: "", length_front: SIZE, length_rear: SIZE, width: 0.45, front_bumpers: 0, rear_bumpers: 0 };

/**
 * Readings of the sensors and predicted paths, to be drawn below all robots. In world coordinates.
 * @param placed [[Robot, pose]] as in all these functions
 * @param shown  function(layer)
 */
export function drawSenses(context, view, palette, placed, { selected, isLive, shown, paused }) {
  for (const [robot, pose] of placed) {
    const { shape, snapshot } = robot;
    const chosen = robot === selected;
    const live = isLive(robot);
    context.save();
    context.translate(pose.x, pose.y);
    context.rotate(pose.theta);
    if (shown("sonar") && (chosen || live)) {
      drawSonar(context, view, palette, { robot: shape, sonar: snapshot?.sonar, faint: !chosen });
    }
    if (shown("paths") && snapshot && live) {
      drawPath(context, view, palette, snapshot.twist, { front: shape?.length_front ?? SIZE, rear: shape?.length_rear ?? SIZE });
    }
    context.restore();
  }
  if (!shown("laser")) return;
  for (const [robot] of placed) if (robot.scanning || paused) drawLaser(context, view, palette, robot.points);
}

/** The robots themselves, in world coordinates; the selected one on top. */
export function drawRobots(context, view, palette, placed, { selected, chosen, several, isLive, shown, sprites, scale }) {
  const one = (robot, pose, colours) => {
    context.save();
    context.translate(pose.x, pose.y);
    context.rotate(pose.theta);
    if (robot !== selected && !isLive(robot)) context.globalAlpha = OLD;
    const bumpers = shown("bumpers") ? robot.snapshot?.bumpers : null;
    drawRobot(context, view, colours, { robot: robot.shape, bumpers }, sprites, scale);
    context.restore();
  };
  for (const [robot] of placed) if (robot.snapshot?.parting && isLive(robot)) drawTwin(context, view, palette, robot);
  for (const [robot, pose] of placed) {
    if (robot === selected) continue;
    if (chosen.includes(robot)) drawSelectionRing(context, view, palette, robot, pose, [6, 4]);
    one(robot, pose, palette.unselected);
  }
  for (const [robot, pose] of placed) {
    if (robot !== selected) continue;
    if (several) drawSelectionRing(context, view, palette, robot, pose);
    one(robot, pose, palette);
  }
}

/** The outline of the simulated twin that a robot differs from, dashed. */
function drawTwin(context, view, palette, { shape, snapshot }) {
  const { length_front: front, length_rear: rear, width } = shape ?? GENERIC;
  const { x, y, theta } = snapshot.parting.twin_in_map;
  context.save();
  context.translate(x, y);
  context.rotate(theta);
  context.strokeStyle = palette.gone;
  context.lineWidth = 2 / view.scale;
  context.setLineDash([5 / view.scale, 4 / view.scale]);
  context.strokeRect(-rear, -width / 2, front + rear, width);
  context.restore();
}

/** @param dashes of the line [px]; none for the selected robot */
function drawSelectionRing(context, view, palette, robot, pose, dashes = []) {
  context.beginPath();
  context.arc(pose.x, pose.y, reach(robot) + RING / view.scale, 0, 2 * Math.PI);
  context.strokeStyle = palette.nose;
  context.lineWidth = 2 / view.scale;
  context.setLineDash(dashes.map((length) => length / view.scale));
  context.stroke();
  context.setLineDash([]);
}

/** In CSS pixels, below each robot. */
export function drawRobotNames(context, view, palette, placed, selected, sprites, ratio) {
  for (const [robot, pose] of placed) {
    const chosen = robot === selected;
    if (view.scale < LEGIBLE && !chosen) continue;
    const { x, y } = view.toScreen(pose.x, pose.y);
    const colour = chosen ? palette.nose : palette.label;
    const font = `${chosen ? 750 : 600} 12px system-ui, sans-serif`;
    sprites.drawName(context, robot.name, x, y + reach(robot) * view.scale + RING + 4, { font, size: 12, colour, halo: palette.floor }, ratio);
  }
}

/** The robot at a point of the map, or up to `slack` [m] beside it, or null; the nearest wins. */
export function robotAt(placed, { x, y }, slack) {
  let [best, least] = [null, Infinity];
  for (const [robot, pose] of placed) {
    const far = Math.hypot(x - pose.x, y - pose.y);
    if (far <= reach(robot) + slack && far < least) [best, least] = [robot, far];
  }
  return best;
}

/** Radius of a circle around it [m]. */
function reach({ shape }) {
  return shape ? Math.max(shape.length_front, shape.length_rear, shape.width / 2) : SIZE;
}

/**
 * One robot in its own frame: x forward, y left [m].
 *
 * @param sprites keeps the picture of the robot without bumper hits
 * @param scale   device pixels per m
 * @param bumpers {front, rear} of a snapshot, or null
 * @param ringed  whether a small one gets a ring to be found by
 */
export function drawRobot(context, view, palette, { robot, bumpers, ringed = true }, sprites, scale) {
  const shape = robot ?? GENERIC;
  const ring = SMALL / view.scale / 2;
  if (ringed && shape.length_front < ring) drawRing(context, view, palette, ring);
  const key = [shape.model, shape.length_front, shape.length_rear, shape.width, shape.front_bumpers, shape.rear_bumpers,
    palette.body, palette.edge].join();
  sprites.drawShape(context, key, around(shape, 24 / scale), scale, (own, at) => drawShape(own, { scale: at }, palette, shape));
  if (bumpers?.front.includes(true)) drawBumper(context, palette, shape, 1, bumpers.front);
  if (bumpers?.rear.includes(true)) drawBumper(context, palette, shape, -1, bumpers.rear);
}

/** @param margin [m], for the shadow */
function around({ length_front, length_rear, width }, margin) {
  return { left: -length_rear - margin, right: length_front + margin, bottom: -width / 2 - margin, top: width / 2 + margin };
}

function drawShape(context, view, palette, shape) {
  const front = shape.length_front - (shape.front_bumpers ? 0.055 : 0);
  const rear = shape.length_rear - (shape.rear_bumpers ? 0.055 : 0);
  drawWheels(context, palette, shape, front, rear);
  drawBody(context, view, palette, shape, front, rear);
  drawBumper(context, palette, shape, 1, Array(shape.front_bumpers).fill(false));
  drawBumper(context, palette, shape, -1, Array(shape.rear_bumpers).fill(false));
}

function drawRing(context, view, palette, radius) {
  context.beginPath();
  context.arc(0, 0, radius, 0, 2 * Math.PI);
  context.fillStyle = palette.nose;
  context.globalAlpha = 0.2;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = palette.nose;
  context.lineWidth = 1.5 / view.scale;
  context.stroke();
}

function drawWheels(context, palette, { model, width }, front, rear) {
  context.fillStyle = palette.wheel;
  const four = /at|seekur|patrol/i.test(model);
  const [length, thick] = four ? [0.22, 0.085] : [0.19, 0.05];
  const centres = four ? [front - 0.14, -(rear - 0.14)] : [0];
  for (const x of centres) {
    for (const side of [1, -1]) {
      const y = side > 0 ? width / 2 - thick : -width / 2;
      box(context, x - length / 2, y, length, thick, 0.02);
      context.fill();
    }
  }
}

function drawBody(context, view, palette, { model, width }, front, rear) {
  const half = width / 2 - (/at|seekur/i.test(model) ? 0.07 : 0.035);
  const length = front + rear;
  context.save();
  context.shadowColor = "rgb(0 0 0 / 0.35)";
  context.shadowBlur = 14;
  box(context, -rear, -half, length, 2 * half, 0.07);
  context.fillStyle = palette.body;
  context.fill();
  context.restore();
  context.strokeStyle = palette.edge;
  context.lineWidth = Math.max(0.008, 1 / view.scale);
  context.stroke();
  box(context, -rear + 0.05, -half + 0.045, length - 0.1, 2 * half - 0.09, 0.05);
  context.fillStyle = palette.deck;
  context.fill();
  context.beginPath(); // an arrow ahead
  context.moveTo(front - 0.03, 0);
  context.lineTo(front - 0.25, half * 0.66);
  context.lineTo(front - 0.19, 0);
  context.lineTo(front - 0.25, -half * 0.66);
  context.closePath();
  context.fillStyle = palette.arrow;
  context.fill();
}

/** Segments across the front (end 1, from left to right) or the rear (end -1, from right to left). */
function drawBumper(context, palette, shape, end, hits) {
  const reach = end > 0 ? shape.length_front : shape.length_rear;
  const point = (t) => [end * (reach - 0.018 - 0.05 * t * t), end * t * shape.width * 0.46];
  context.lineCap = "butt";
  hits.forEach((hit, index) => {
    const gap = 0.03;
    const from = 1 - (2 * index) / hits.length - gap;
    const to = 1 - (2 * (index + 1)) / hits.length + gap;
    context.beginPath();
    context.moveTo(...point(from));
    const [a, b] = [point(from), point(to)];
    const middle = point((from + to) / 2);
    context.quadraticCurveTo(2 * middle[0] - (a[0] + b[0]) / 2, 2 * middle[1] - (a[1] + b[1]) / 2, ...b);
    context.strokeStyle = hit ? palette.hit : palette.bumper;
    context.lineWidth = hit ? 0.06 : 0.034;
    context.save();
    if (hit) Object.assign(context, { shadowColor: palette.hit, shadowBlur: 18 });
    context.stroke();
    context.restore();
  });
}

function box(context, x, y, width, height, radius) {
  context.beginPath();
  context.roundRect(x, y, width, height, radius);
}
