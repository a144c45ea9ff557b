// Where the robot will be at this velocity.

const AHEAD = 1.5; // s

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
