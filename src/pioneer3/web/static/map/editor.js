// Editing the simulated world with pointers and keys, as requests to the server. Nothing is moved here:
// a dragged thing is a dashed outline, and the server moves the thing as far as it can.

import { kindOf } from "./gestures.js";
import { KNOB_RADIUS, knobOf } from "./things.js";

const PERIOD = 66; // ms between the requests of a drag
const SLACK = { mouse: 6, touch: 22 }; // px beside a thing that still select it
const STILL = { mouse: 3, touch: 8 }; // px; a smaller movement is no drag
const BOX = 0.5; // m, sides of a box that is not drawn but tapped
const [LEAST, MOST] = [0.1, 20]; // m, sides of any box
const WALK = 2; // m, path of a walker that is added by keyboard
const RECENT = 500; // ms in which the next step begins at the last one, not at the shown pose
const ROUND = Math.PI / 12; // headings that are dragged are multiples of it

const angle = (from, to) => Math.atan2(to.y - from.y, to.x - from.x);
const clamp = (value) => Math.min(MOST, Math.max(LEAST, value));

export class Editor {
  active = false;
  /** "move", or the thing that the next tap adds: "box", "person", "walker", "robot". */
  tool = "move";
  /** Id of the selected thing, or null. */
  selected = null;
  /** Name of the model that is added. */
  model = "";
  #view;
  #world;
  #send;
  #lift;
  #changed;
  #drag = null; // {mode, from, to, moved, start: CSS px, type, thing, ...}
  #begun = null; // the first end of a walker's path that is tapped
  #hover = null; // where the mouse is since then
  #aim = null; // {id, pose, at}: the last step by keyboard
  #pending = null;
  #timer = 0;

  /**
   * @param view, world
   * @param send    function(message)
   * @param lift    function(lifted): the page's own robot is lifted, or put down again
   * @param changed function(), after tool, selection or ghost have changed
   */
  constructor({ view, world, send, lift, changed }) {
    this.#view = view;
    this.#world = world;
    this.#send = send;
    this.#lift = lift;
    this.#changed = changed;
  }

  /** The selected thing, or undefined. */
  get thing() {
    return this.#world.things.get(this.selected);
  }

  /** Whether a walker waits for the second end of the path. */
  get begun() {
    return this.#begun !== null;
  }

  /** {shape, pose, line} of the thing that is dragged or drawn, or null. */
  get ghost() {
    const drag = this.#drag;
    if (drag?.thing && drag.moved) return { shape: drag.thing, pose: drag.pose };
    if (drag?.mode === "add") return sketch(this.tool, drag);
    if (this.#begun) return sketch("walker", { from: this.#begun, to: this.#hover ?? this.#begun });
    return null;
  }

  setActive(active) {
    this.active = active;
    this.cancel();
    this.setTool("move");
    this.select(null);
  }

  setTool(tool) {
    this.tool = tool;
    this.#begun = null;
    if (tool !== "move") this.selected = null;
    this.#changed();
  }

  select(id) {
    this.selected = id;
    this.#aim = null;
    this.#changed();
  }

  /** The world has changed: a thing that is gone is not selected any more. */
  catchUp() {
    if (this.selected === null || this.thing) return;
    this.cancel();
    this.select(null);
  }

  // pointers on the canvas, in CSS pixels

  /** A pointer is pressed; returns whether it is taken, or left to the view. */
  take(point, type) {
    if (!this.active) return false;
    const at = this.#view.toWorld(point.x, point.y);
    const drag = { start: point, type, from: at, to: at, moved: false };
    if (this.tool !== "move") return this.#begin({ ...drag, mode: "add" });
    const slack = SLACK[kindOf(type)] / this.#view.scale;
    if (this.#turns(at, slack)) {
      return this.#begin({ ...drag, mode: "turn", thing: this.thing, pose: this.thing.pose });
    }
    const thing = this.#world.at(at, slack);
    if (!thing) return false;
    this.select(thing.id);
    return this.#begin({ ...drag, mode: "move", thing, pose: thing.pose, grip: thing.pose });
  }

  drag(point) {
    const drag = this.#drag;
    if (!drag) return;
    const way = Math.hypot(point.x - drag.start.x, point.y - drag.start.y);
    if (!drag.moved && way < STILL[kindOf(drag.type)]) return;
    if (!drag.moved && drag.thing?.own) this.#lift(true);
    drag.moved = true;
    drag.to = this.#view.toWorld(point.x, point.y);
    if (drag.mode === "move") {
      const { x, y, theta } = drag.grip;
      drag.pose = { x: x + drag.to.x - drag.from.x, y: y + drag.to.y - drag.from.y, theta };
    } else if (drag.mode === "turn") {
      drag.pose = { ...drag.pose, theta: ROUND * Math.round(angle(drag.pose, drag.to) / ROUND) };
    }
    if (drag.thing) this.#move(drag.thing.id, drag.pose);
    this.#changed();
  }

  drop() {
    const drag = this.#drag;
    if (!drag) return;
    this.#drag = null;
    if (drag.mode === "add") this.#add(drag);
    else if (drag.moved) this.#flush();
    if (drag.thing?.own && drag.moved) this.#lift(false);
    this.#changed();
  }

  /** The pointer is lost, to the system or to a pinch. */
  cancel() {
    if (this.#drag?.thing?.own) this.#lift(false);
    this.#drag = this.#pending = this.#begun = null;
    this.#changed();
  }

  /** The mouse is there, not pressed; returns whether a press would take something. */
  hovers(point) {
    if (!this.active) return false;
    this.#hover = this.#view.toWorld(point.x, point.y);
    if (this.#begun) this.#changed();
    return this.tool === "move" && this.#world.at(this.#hover, SLACK.mouse / this.#view.scale) !== null;
  }

  // keys and buttons

  /** Adds the tool's thing in the middle of the picture: for use without a pointer. */
  addInMiddle(tool) {
    const { x, y } = this.#view;
    this.tool = tool;
    const to = { x: x + WALK, y };
    this.#add(tool === "walker" ? { from: { x, y }, to, moved: true } : { from: { x, y }, to: { x, y }, moved: false });
  }

  /** Moves the selected thing by dx, dy [m] and turns it by dtheta [rad]. */
  nudge(dx, dy, dtheta) {
    const thing = this.thing;
    if (!thing) return;
    const now = performance.now();
    const fresh = this.#aim?.id === thing.id && now - this.#aim.at < RECENT;
    const from = fresh ? this.#aim.pose : thing.pose;
    const pose = { x: from.x + dx, y: from.y + dy, theta: from.theta + dtheta };
    this.#aim = { id: thing.id, pose, at: now };
    this.#send({ type: "move", id: thing.id, ...pose });
  }

  /** The server has refused a request: steps begin at the shown pose again. */
  refused() {
    this.#aim = null;
  }

  remove() {
    if (this.thing) this.#send({ type: "remove", id: this.selected });
  }

  /** Whether a point is on the knob, and not rather on the thing itself. */
  #turns(at, slack) {
    const knob = this.thing && knobOf(this.thing, this.thing.pose, this.#view.scale);
    if (!knob) return false;
    const [toKnob, toThing] = [knob, this.thing.pose].map(({ x, y }) => Math.hypot(at.x - x, at.y - y));
    return toKnob < KNOB_RADIUS / this.#view.scale + slack && toKnob < toThing;
  }

  #begin(drag) {
    this.#drag = drag;
    if (this.#view.mode === "follow") this.#view.setMode("free"); // else the floor would slip away
    this.#changed();
    return true;
  }

  #add(drag) {
    if (this.tool === "walker" && !drag.moved && !this.#begun) {
      this.#begun = drag.from;
      this.#hover = null;
      return this.#changed();
    }
    this.#send(this.#request(drag));
    this.setTool("move");
  }

  #request({ from, to, moved }) {
    if (this.tool === "person") return { type: "add_person", path: [[to.x, to.y]] };
    if (this.tool === "walker") {
      const start = this.#begun ?? from;
      return { type: "add_person", path: [[start.x, start.y], [to.x, to.y]] };
    }
    const { shape, pose } = sketch(this.tool, { from, to, moved });
    if (this.tool === "robot") return { type: "add_robot", model: this.model, ...pose };
    return { type: "add_box", ...pose, length: 2 * shape.front, width: 2 * shape.side };
  }

  /** Sends the newest place of a drag, not more often than PERIOD. */
  #move(id, pose) {
    this.#pending = { type: "move", id, ...pose };
    if (this.#timer) return;
    this.#flush();
    this.#timer = setInterval(() => {
      if (this.#pending) return this.#flush();
      clearInterval(this.#timer);
      this.#timer = 0;
    }, PERIOD);
  }

  #flush() {
    if (this.#pending) this.#send(this.#pending);
    this.#pending = null;
  }
}

/** The thing that a drag with a tool would add: its outline and pose, and for a walker the path. */
function sketch(tool, { from, to, moved }) {
  if (tool === "box") {
    const [length, width] = moved ? [clamp(Math.abs(to.x - from.x)), clamp(Math.abs(to.y - from.y))] : [BOX, BOX];
    const pose = moved ? { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2, theta: 0 } : { ...from, theta: 0 };
    return { shape: { kind: "box", front: length / 2, rear: length / 2, side: width / 2 }, pose };
  }
  if (tool === "robot") {
    const pose = { ...from, theta: moved ? angle(from, to) : 0 };
    return { shape: { kind: "robot", front: 0.25, rear: 0.25, side: 0.22 }, pose, line: [from, to] };
  }
  const shape = { kind: "person", front: 0.25, rear: 0.25, side: 0.25 };
  return { shape, pose: { ...to, theta: 0 }, line: tool === "walker" ? [from, to] : undefined };
}
