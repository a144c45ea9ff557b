// What has come and gone on a map that is updated: known by colour, by a ring that is whole or dashed, and by a sign.

const LEAST = 3; // px, of a cell
const CELL = 0.03; // m
const ROOM = 8; // px between cells and ring
const SIGN = 9; // px, radius
const ARM = 4.5; // px

/** In world coordinates. @param changes [{gone, x, y, cells}] */
export function drawChanges(context, camera, palette, changes) {
  const side = Math.max(CELL, LEAST / camera.scale);
  for (const { gone, x, y, cells } of changes) {
    const colour = gone ? palette.gone : palette.come;
    context.save();
    context.translate(x, y);
    context.fillStyle = context.strokeStyle = colour;
    for (const [cx, cy] of cells) context.fillRect(cx - x - side / 2, cy - y - side / 2, side, side);
    const reach = Math.max(0, ...cells.map(([cx, cy]) => Math.hypot(cx - x, cy - y))) * camera.scale + ROOM;
    context.scale(1 / camera.scale, 1 / camera.scale);
    context.lineWidth = 2;
    context.setLineDash(gone ? [5, 4] : []);
    context.beginPath();
    context.arc(0, 0, reach, 0, 2 * Math.PI);
    context.stroke();
    context.setLineDash([]);
    drawSign(context, palette, colour, gone, Math.max(reach, ROOM + SIGN) * Math.SQRT1_2);
    context.restore();
  }
}

/** Minus or plus in a disk at a corner of the ring. */
function drawSign(context, palette, colour, gone, at) {
  context.translate(at, at);
  context.beginPath();
  context.arc(0, 0, SIGN, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.fill();
  context.beginPath();
  context.moveTo(-ARM, 0);
  context.lineTo(ARM, 0);
  if (!gone) (context.moveTo(0, -ARM), context.lineTo(0, ARM));
  context.strokeStyle = palette.floor;
  context.lineWidth = 2.5;
  context.stroke();
}
