// Sonar cones in the robot's frame: each from its transducer to what it measured.

import { mix } from "./palette.js";

const HALF = 0.2; // rad, half of the drawn cone
const NEAR = 0.4; // m and below: fully warm
const MIDDLE = 1.2;
const FAR = 2.5; // m and above: fully cool

export function drawSonar(context, view, palette, { robot, sonar }) {
  if (!robot || !sonar?.enabled) return;
  // The far ones first, so that the near ones, which matter, lie on top.
  const order = robot.sonars
    .map((mount, index) => ({ mount, range: sonar.ranges[index] ?? null }))
    .sort((a, b) => (b.range ?? Infinity) - (a.range ?? Infinity));
  for (const { mount, range } of order) {
    context.save();
    context.translate(mount.x, mount.y);
    context.rotate(mount.theta);
    if (range === null) drawNothing(context, palette, robot.sonar_max ?? 5);
    else drawEcho(context, view, colourOf(range, palette), range);
    context.restore();
  }
}

function cone(context, range) {
  context.beginPath();
  context.moveTo(0, 0);
  context.arc(0, 0, range, -HALF, HALF);
  context.closePath();
}

function drawNothing(context, palette, range) {
  cone(context, range);
  const colour = mix(palette["sonar-none"], palette["sonar-none"], 0);
  shade(context, colour, range, 0.12, 0.02);
}

function drawEcho(context, view, colour, range) {
  cone(context, range);
  shade(context, colour, range, 0.04, 0.3);
  context.beginPath();
  context.arc(0, 0, range, -HALF, HALF);
  context.strokeStyle = colour;
  context.lineWidth = 2.5 / view.scale;
  context.lineCap = "round";
  context.stroke();
}

/** Fills the cone from one opacity at the transducer to another at its end. */
function shade(context, colour, range, inner, outer) {
  const fill = context.createRadialGradient(0, 0, 0, 0, 0, Math.max(range, 0.01));
  fill.addColorStop(0, colour.replace(")", ` / ${inner})`));
  fill.addColorStop(1, colour.replace(")", ` / ${outer})`));
  context.fillStyle = fill;
  context.fill();
}

function colourOf(range, palette) {
  if (range < MIDDLE) return mix(palette["sonar-near"], palette["sonar-mid"], (range - NEAR) / (MIDDLE - NEAR));
  return mix(palette["sonar-mid"], palette["sonar-far"], (range - MIDDLE) / (FAR - MIDDLE));
}
