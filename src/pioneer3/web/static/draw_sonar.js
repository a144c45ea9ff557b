// Sonar cones in the robot's frame: each from its transducer to what it measured.

import { mix } from "./palette.js";

const HALF = 0.2; // rad, half of the drawn cone
const NEAR = 0.4; // m and below: fully warm
const MIDDLE = 1.2;
const FAR = 2.5; // m and above: fully cool
const SHADES = 24; // colours from near to far
const paints = new WeakMap(); // palette -> {none, echoes: [{colour, fill}]}
const orders = new WeakMap(); // sonar of a snapshot -> numbers of transducers

/** @param faint of a robot that is not selected: only what echoes, and less of that */
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

function colourOf(range, palette) {
  if (range < MIDDLE) return mix(palette["sonar-near"], palette["sonar-mid"], (range - NEAR) / (MIDDLE - NEAR));
  return mix(palette["sonar-mid"], palette["sonar-far"], (range - MIDDLE) / (FAR - MIDDLE));
}
