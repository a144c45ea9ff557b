// Sensors and motion of a robot: sonar cones, laser points, and the predicted path.

export const HALF = 0.2; // rad, half of the drawn cone
const NEAR = 0.4; // m and below: fully warm
const MIDDLE = 1.2;
const FAR = 2.5; // m and above: fully cool
const SHADES = 24; // colours from near to far
const POINT = 3; // px, of the laser
const AHEAD = 1.5; // s, of the predicted path
const paints = new WeakMap(); // palette -> {none, echoes: [{colour, fill}]}
const orders = new WeakMap(); // sonar of a snapshot -> numbers of transducers

/**
 * Cones in the robot's frame, each from its transducer to the echo.
 * @param faint for a robot that is not selected: only arcs of echoes
 */
export function drawSonar(context, view, palette, { robot, sonar, faint = false }) {
  if (!robot || !sonar?.enabled) return;
  const { none, echoes } = paintsOf(context, palette);
  context.lineCap = "round";
  for (const number of orderOf(sonar)) {
    const mount = robot.sonars[number];
    const range = sonar.ranges[number];
    if (!mount || (range === null && faint)) continue;
    const reach = Math.max(range ?? robot.sonar_max ?? 5, 0.01);
    context.save();
    context.translate(mount.x, mount.y);
    context.rotate(mount.theta);
    context.scale(reach, reach);
    if (range === null) fillCone(context, none);
    else drawEcho(context, echoes[shadeOf(range)], 2.5 / view.scale / reach, faint);
    context.restore();
  }
}

/** A cone of length 1. */
function fillCone(context, fill) {
  context.beginPath();
  context.moveTo(0, 0);
  context.arc(0, 0, 1, -HALF, HALF);
  context.closePath();
  context.fillStyle = fill;
  context.fill();
}

function drawEcho(context, { colour, fill }, width, faint) {
  if (!faint) fillCone(context, fill);
  context.beginPath();
  context.arc(0, 0, 1, -HALF, HALF);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
}

/** The far ones first, so that the near ones, which matter, lie on top. */
function orderOf(sonar) {
  let order = orders.get(sonar);
  if (!order) {
    order = sonar.ranges.map((_, number) => number);
    order.sort((a, b) => (sonar.ranges[b] ?? Infinity) - (sonar.ranges[a] ?? Infinity));
    orders.set(sonar, order);
  }
  return order;
}

/** The colours of a theme, made once. */
function paintsOf(context, palette) {
  let made = paints.get(palette);
  if (!made) {
    const echoes = Array.from({ length: SHADES }, (_, shade) => {
      const colour = colourOf(NEAR + ((FAR - NEAR) * shade) / (SHADES - 1), palette);
      return { colour, fill: fade(context, colour, 0.04, 0.3) };
    });
    const grey = mix(palette["sonar-none"], palette["sonar-none"], 0);
    made = { none: fade(context, grey, 0.12, 0.02), echoes };
    paints.set(palette, made);
  }
  return made;
}

/** From one opacity at the transducer to another at distance 1. */
function fade(context, colour, inner, outer) {
  const fill = context.createRadialGradient(0, 0, 0, 0, 0, 1);
  fill.addColorStop(0, colour.replace(")", ` / ${inner})`));
  fill.addColorStop(1, colour.replace(")", ` / ${outer})`));
  return fill;
}

function shadeOf(range) {
  const share = (range - NEAR) / (FAR - NEAR);
  return Math.round(Math.min(1, Math.max(0, share)) * (SHADES - 1));
}

/** The colour of a range, from near to far: rgb(r g b). */
export function colourOf(range, palette) {
  if (range < MIDDLE) return mix(palette["sonar-near"], palette["sonar-mid"], (range - NEAR) / (MIDDLE - NEAR));
  return mix(palette["sonar-mid"], palette["sonar-far"], (range - MIDDLE) / (FAR - MIDDLE));
}

/** In world coordinates. @param points [x, y, x, y, ...] of the map [m], or null without a scan */
export function drawLaser(context, view, palette, points) {
  if (!points) return;
  const size = POINT / view.scale;
  const { left, right, bottom, top } = view.window;
  context.fillStyle = palette.laser;
  for (let at = 0; at < points.length; at += 2) {
    const [x, y] = [points[at], points[at + 1]];
    if (x < left || x > right || y < bottom || y > top) continue;
    context.fillRect(x - size / 2, y - size / 2, size, size);
  }
}

/** In the robot's frame: the arc that it drives next at this velocity. */
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

/** Between two #rrggbb colours, k from 0 to 1. */
function mix(a, b, k) {
  const channel = (at) => {
    const [from, to] = [a, b].map((colour) => parseInt(colour.slice(at, at + 2), 16));
    return Math.round(from + (to - from) * Math.min(1, Math.max(0, k)));
  };
  return `rgb(${channel(1)} ${channel(3)} ${channel(5)})`;
}
