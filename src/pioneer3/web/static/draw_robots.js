// The page's robots, with all that belongs to each; the ring around the selected one; their names.

import { drawLaser } from "./draw_laser.js";
import { drawPath } from "./draw_motion.js";
import { drawRobot } from "./draw_robot.js";
import { drawSonar } from "./draw_sonar.js";

const OLD = 0.45; // opacity of what is not heard of
const RING = 7; // px beside the robot
const LEGIBLE = 8; // px per m; smaller pictures have no names, but the selected one's
const SIZE = 0.3; // m, of a robot whose shape is not known

/**
 * What robots see and where they will be, below all robots. In world coordinates.
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
export function drawRobots(context, view, palette, placed, { selected, several, isLive, shown, sprites, scale }) {
  const one = (robot, pose, colours) => {
    context.save();
    context.translate(pose.x, pose.y);
    context.rotate(pose.theta);
    if (robot !== selected && !isLive(robot)) context.globalAlpha = OLD;
    const bumpers = shown("bumpers") ? robot.snapshot?.bumpers : null;
    drawRobot(context, view, colours, { robot: robot.shape, bumpers }, sprites, scale);
    context.restore();
  };
  for (const [robot, pose] of placed) if (robot !== selected) one(robot, pose, palette.mates);
  for (const [robot, pose] of placed) {
    if (robot !== selected) continue;
    if (several) drawRing(context, view, palette, robot, pose);
    one(robot, pose, palette);
  }
}

function drawRing(context, view, palette, robot, pose) {
  context.beginPath();
  context.arc(pose.x, pose.y, reach(robot) + RING / view.scale, 0, 2 * Math.PI);
  context.strokeStyle = palette.nose;
  context.lineWidth = 2 / view.scale;
  context.stroke();
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
