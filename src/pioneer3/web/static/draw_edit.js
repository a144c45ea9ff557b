// What editing adds to the picture: what is selected, its knob, and what would be if it were let go.

import { outline } from "./draw_things.js";

const KNOB = 30; // px from a thing's front to the knob that turns it
export const KNOB_RADIUS = 9; // px

/** Where the knob of a thing is [m, in the map]. */
export function knobOf({ front, kind }, { x, y, theta }, scale) {
  if (kind === "person") return null; // looks where it walks
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
