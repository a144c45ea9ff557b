// How sure a robot is of its place on the map: an ellipse around it, and a notice while it is not sure.

import { byId, putHelp, sentence } from "../dom.js";

const APART = 0.3; // m between the drawn pose and the estimate, from which on both are drawn
const CROSS = 7; // px
const LOOKS = "look around"; // the mode

/** Draws where navigation believes the robot to be, with 95 %, in world coordinates. */
export function drawWhereabouts(context, view, palette, { robot_in_map: pose, ellipse, sure }, drawn) {
  if (!pose || !ellipse) return;
  const { x, y, theta: heading } = pose;
  const [long, short, angle] = ellipse;
  const k = 1 / view.scale;
  const colour = sure ? palette.target : palette.hit;
  context.save();
  context.translate(x, y);
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 1.5 * k;
  context.beginPath();
  context.ellipse(0, 0, Math.max(long, 2 * k), Math.max(short, 2 * k), angle, 0, 2 * Math.PI);
  context.globalAlpha = 0.2;
  context.fill();
  context.globalAlpha = 1;
  context.stroke();
  if (Math.hypot(x - drawn.x, y - drawn.y) > APART) {
    context.beginPath();
    context.moveTo(-CROSS * k, 0);
    context.lineTo(CROSS * k, 0);
    context.moveTo(0, -CROSS * k);
    context.lineTo(0, CROSS * k);
    context.moveTo(0, 0);
    context.lineTo(4 * CROSS * k * Math.cos(heading), 4 * CROSS * k * Math.sin(heading));
    context.stroke();
  }
  context.restore();
}

/** The notice over the map while the selected robot is not sure where it is. */
export class Whereabouts {
  #model;
  #send;
  #notify;
  #remarked = new Set(); // ids of robots

  /**
   * @param send function(message) @param place function(): begins to place the robot
   * @param notify function(text)
   */
  constructor({ model, send, place, notify }) {
    this.#model = model;
    this.#send = send;
    this.#notify = notify;
    byId("unsure-place").addEventListener("click", place);
    byId("unsure-look").addEventListener("click", () => this.#lookAround());
  }

  show() {
    const { selected, live, viewer, snapshot } = this.#model;
    const navigation = live ? selected?.navigation : null;
    if (navigation?.remark) this.#remark(selected.id, navigation.remark);
    const asked = selected?.mapping?.asks; // one question after the other
    byId("unsure").hidden = !navigation?.reason || navigation.sure || snapshot?.mode === LOOKS || asked;
    if (byId("unsure").hidden) return;
    const who = this.#model.several ? `${selected.name} is not sure` : "It is not sure";
    putHelp(byId("unsure-why"), `${who} where it is: ${navigation.reason}.`, "not-sure-where-it-is");
    for (const id of ["unsure-how", "unsure-place", "unsure-look"]) byId(id).hidden = viewer;
  }

  /** Shows once that the laser is mounted askew. */
  #remark(id, remark) {
    if (this.#remarked.has(id)) return;
    this.#remarked.add(id);
    this.#notify(sentence(remark));
  }

  #lookAround() {
    this.#send({ type: "look_around", robot: this.#model.selected.id });
  }
}
