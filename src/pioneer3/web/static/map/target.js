// The targets of robots, and the goal that is proposed for one. In world coordinates.

const SIZE = 9; // px
const ARM = 46; // px from a place to the knob that turns the heading
export const KNOB = 8; // px

/** @param target {x, y, heading, person} of a snapshot, `pose` of the robot, `way` the points of its way, null for straight on */
export function drawTarget(context, view, palette, target, pose, way) {
  const colour = target.person ? palette.person : palette.target;
  drawWay(context, view, colour, way ? [pose, ...way.slice(1).map(pointOf)] : [pose, target]);
  if (target.person) drawSomebody(context, view, palette, target);
  else drawPlace(context, view, palette, target, true);
}

const pointOf = ([x, y]) => ({ x, y });

/** A goal that is proposed, with a knob for the heading, and the way there if it is known. */
export function drawProposal(context, view, palette, goal, pose) {
  if (goal.way?.length) drawWay(context, view, palette.target, goal.way.map(pointOf));
  else if (pose && goal.straight) drawWay(context, view, palette.target, [pose, goal]);
  drawPlace(context, view, palette, goal, false);
  const knob = knobOf(goal, view.scale);
  context.strokeStyle = context.fillStyle = palette.target;
  context.lineWidth = 2 / view.scale;
  context.beginPath();
  context.moveTo(goal.x + (SIZE / view.scale) * Math.cos(goal.toward), goal.y + (SIZE / view.scale) * Math.sin(goal.toward));
  context.lineTo(knob.x, knob.y);
  if (goal.heading === null) context.setLineDash([3 / view.scale, 3 / view.scale]);
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.arc(knob.x, knob.y, KNOB / view.scale, 0, 2 * Math.PI);
  if (goal.heading === null) context.fillStyle = palette.floor;
  context.fill();
  context.stroke();
}

/** A stop of a patrol that is being put together, with its number. */
export function drawStop(context, view, palette, { x, y }, number) {
  const k = 1 / view.scale;
  context.save();
  context.translate(x, y);
  context.scale(k, -k);
  context.fillStyle = palette.target;
  context.beginPath();
  context.arc(0, 0, SIZE + 2, 0, 2 * Math.PI);
  context.fill();
  context.fillStyle = palette.floor;
  context.font = "700 13px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(String(number), 0, 1);
  context.restore();
}

/** Where the knob of a goal is: where it heads, or would by itself [m]. */
export function knobOf({ x, y, toward }, scale) {
  return { x: x + (ARM / scale) * Math.cos(toward), y: y + (ARM / scale) * Math.sin(toward) };
}

function drawWay(context, view, colour, points) {
  context.beginPath();
  for (const { x, y } of points) context.lineTo(x, y);
  context.strokeStyle = colour;
  context.lineWidth = 1.5 / view.scale;
  context.setLineDash([6 / view.scale, 6 / view.scale]);
  context.stroke();
  context.setLineDash([]);
}

function drawPlace(context, view, palette, { x, y, heading }, going) {
  const k = 1 / view.scale;
  context.save();
  context.translate(x, y);
  context.scale(k, k);
  context.strokeStyle = context.fillStyle = palette.target;
  context.lineWidth = 2.5;
  context.beginPath();
  context.arc(0, 0, SIZE, 0, 2 * Math.PI);
  context.moveTo(-SIZE - 5, 0);
  context.lineTo(-SIZE + 4, 0);
  context.moveTo(SIZE + 5, 0);
  context.lineTo(SIZE - 4, 0);
  context.moveTo(0, -SIZE - 5);
  context.lineTo(0, -SIZE + 4);
  context.moveTo(0, SIZE + 5);
  context.lineTo(0, SIZE - 4);
  context.stroke();
  context.beginPath();
  context.arc(0, 0, going ? 4 : 2, 0, 2 * Math.PI);
  context.fill();
  if (going && heading !== null) {
    context.rotate(heading);
    context.beginPath();
    context.moveTo(SIZE + 16, 0);
    context.lineTo(SIZE + 5, 6);
    context.lineTo(SIZE + 5, -6);
    context.closePath();
    context.fill();
  }
  context.restore();
}

/** The estimated place of a person, dashed. */
function drawSomebody(context, view, palette, { x, y }) {
  const k = 1 / view.scale;
  context.strokeStyle = palette.person;
  context.lineWidth = 2 * k;
  context.setLineDash([4 * k, 3 * k]);
  context.beginPath();
  context.arc(x, y, Math.max(0.25, 10 * k), 0, 2 * Math.PI);
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.arc(x, y, 3 * k, 0, 2 * Math.PI);
  context.fillStyle = palette.person;
  context.fill();
}
