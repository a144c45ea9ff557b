// Where the robot was and, at this velocity, will be.

const AHEAD = 1.5; // s
const PIECES = 10; // shades from old to new

/** In world coordinates. */
export function drawTrail(context, view, palette, trail, pose) {
  if (trail.length === 0) return;
  context.strokeStyle = palette.trail;
  context.lineWidth = 2.5 / view.scale;
  context.lineCap = "butt";
  context.lineJoin = "round";
  const points = pose ? [...trail, [pose.x, pose.y]] : trail;
  const size = Math.ceil(points.length / PIECES);
  for (let first = 0; first < points.length; first += size) {
    context.globalAlpha = 0.12 + (0.78 * Math.min(points.length, first + size)) / points.length;
    strokePiece(context, points, first, Math.min(points.length - 1, first + size));
  }
  context.globalAlpha = 1;
}

function strokePiece(context, points, first, last) {
  context.beginPath();
  let drawing = false;
  for (let index = first; index <= last; index += 1) {
    const point = points[index];
    if (point && drawing) context.lineTo(...point);
    else if (point) context.moveTo(...point);
    drawing = point !== null;
  }
  context.stroke();
}

/** In the robot's frame: the arc it would drive in the next moment. */
export function drawPath(context, view, palette, { v, w }, start) {
  if (Math.abs(v) < 0.02) return;
  context.beginPath();
  const nose = v > 0 ? start.front : -start.rear;
  for (let step = 0; step <= 16; step += 1) {
    const t = (step / 16) * AHEAD;
    const turn = w * t;
    const arc = Math.abs(w) < 1e-3
      ? { x: v * t, y: 0 }
      : { x: (v / w) * Math.sin(turn), y: (v / w) * (1 - Math.cos(turn)) };
    context.lineTo(arc.x + nose * Math.cos(turn), arc.y + nose * Math.sin(turn));
  }
  context.strokeStyle = palette.path;
  context.lineWidth = 2.5 / view.scale;
  context.lineCap = "round";
  context.setLineDash([1 / view.scale, 7 / view.scale]);
  context.stroke();
  context.setLineDash([]);
}
