// Boxes, people and external robots, to scale; their names; and the selection and outlines of the editor.

import { labelOf } from "../model/world.js";
import { drawRobot } from "./robots.js";

const ORDER = ["box", "person", "robot"];
const LEGIBLE = 22; // px per m; smaller pictures have no names
const SMALL = 7; // px; people are not drawn smaller
const KNOB = 30; // px from a thing's front to the knob that turns it
export const KNOB_RADIUS = 9; // px
const shapes = new WeakMap(); // thing -> shape

export function byLayer(things) {
  return [...things].sort((a, b) => ORDER.indexOf(a.kind) - ORDER.indexOf(b.kind));
}

/** In world coordinates. */
export function drawThing(context, view, palette, thing, pose, sprites, scale) {
  context.save();
  context.translate(pose.x, pose.y);
  context.rotate(pose.theta);
  if (thing.kind === "box") drawBox(context, view, palette, thing);
  else if (thing.kind === "person") drawPerson(context, view, palette, thing);
  else drawRobot(context, view, palette.external, { robot: shapeOf(thing), bumpers: null }, sprites, scale);
  context.restore();
}

/** The outline a thing has on the floor, as the current path. */
export function outline(context, { kind, front, rear, side }, grow = 0) {
  context.beginPath();
  if (kind === "person") context.arc(0, 0, side + grow, 0, 2 * Math.PI);
  else context.rect(-rear - grow, -side - grow, front + rear + 2 * grow, 2 * (side + grow));
}

function drawBox(context, view, palette, thing) {
  const { front, side } = thing;
  outline(context, thing);
  context.fillStyle = palette.box;
  context.fill();
  context.moveTo(-front, -side); // crossed, as boxes are on plans
  context.lineTo(front, side);
  context.moveTo(-front, side);
  context.lineTo(front, -side);
  context.strokeStyle = palette["box-edge"];
  context.lineWidth = Math.max(0.02, 1.5 / view.scale);
  context.lineJoin = "miter";
  context.stroke();
}

/** From above: shoulders, head, and an arrow ahead of a person who walks. */
function drawPerson(context, view, palette, thing) {
  const r = Math.max(thing.side, SMALL / view.scale);
  outline(context, { ...thing, side: r });
  context.fillStyle = palette["person-soft"];
  context.fill();
  context.strokeStyle = palette.person;
  context.lineWidth = Math.max(0.02, 1.5 / view.scale);
  context.stroke();
  context.fillStyle = palette.person;
  context.beginPath();
  context.ellipse(0, 0, r * 0.36, r * 0.8, 0, 0, 2 * Math.PI);
  context.fill();
  if (thing.walks) {
    context.beginPath();
    context.moveTo(r * 1.55, 0);
    context.lineTo(r * 1.1, r * 0.42);
    context.lineTo(r * 1.1, -r * 0.42);
    context.closePath();
    context.fill();
  }
  context.beginPath();
  context.arc(r * 0.08, 0, r * 0.36, 0, 2 * Math.PI);
  context.fillStyle = palette["person-head"];
  context.fill();
}

/** A robot of the world as robots are drawn. */
function shapeOf(thing) {
  if (!shapes.has(thing)) {
    shapes.set(thing, {
      model: thing.model, length_front: thing.front, length_rear: thing.rear, width: 2 * thing.side,
      front_bumpers: 0, rear_bumpers: 0,
    });
  }
  return shapes.get(thing);
}

/** In CSS pixels, below each thing that has a name of its own. */
export function drawNames(context, view, palette, placed, sprites, ratio) {
  if (view.scale < LEGIBLE) return;
  const look = { font: "600 12px system-ui, sans-serif", size: 12, colour: palette.label, halo: palette.floor };
  for (const [thing, pose] of placed) {
    if (!thing.name || thing.own) continue;
    const { x, y } = view.toScreen(pose.x, pose.y);
    sprites.drawName(context, labelOf(thing), x, y + Math.max(thing.side, thing.rear) * view.scale + 5, look, ratio);
  }
}

/** The place of a thing's knob in the map [m]; null for a person, who looks ahead. */
export function knobOf({ front, kind }, { x, y, theta }, scale) {
  if (kind === "person") return null;
  const reach = front + KNOB / scale;
  return { x: x + reach * Math.cos(theta), y: y + reach * Math.sin(theta) };
}

/** In world coordinates. */
export function drawSelection(context, view, palette, thing, pose) {
  context.strokeStyle = context.fillStyle = palette.select;
  context.lineWidth = 2 / view.scale;
  context.save();
  context.translate(pose.x, pose.y);
  context.rotate(pose.theta);
  outline(context, thing, 4 / view.scale);
  context.stroke();
  context.restore();
  const knob = knobOf(thing, pose, view.scale);
  if (!knob) return;
  context.beginPath();
  context.moveTo(pose.x + thing.front * Math.cos(pose.theta), pose.y + thing.front * Math.sin(pose.theta));
  context.lineTo(knob.x, knob.y);
  context.stroke();
  context.beginPath();
  context.arc(knob.x, knob.y, KNOB_RADIUS / view.scale, 0, 2 * Math.PI);
  context.fill();
  context.strokeStyle = palette.floor;
  context.stroke();
}

/** The outline of a thing where it is dragged to, or of one that is being drawn. */
export function drawGhost(context, view, palette, { shape, pose, line }) {
  context.strokeStyle = palette.select;
  context.lineWidth = 2 / view.scale;
  context.setLineDash([6 / view.scale, 4 / view.scale]);
  if (line) {
    context.beginPath();
    context.moveTo(line[0].x, line[0].y);
    context.lineTo(line[1].x, line[1].y);
    context.stroke();
  }
  context.save();
  context.translate(pose.x, pose.y);
  context.rotate(pose.theta);
  outline(context, shape);
  context.stroke();
  context.restore();
  context.setLineDash([]);
}
