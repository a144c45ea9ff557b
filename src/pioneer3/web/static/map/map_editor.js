// Editing the map with pointers and keys, as requests to the server. The server keeps the draft: nothing is
// changed here, and robots keep to their map until the draft is saved.

import { kindOf } from "./gestures.js";

const STILL = { mouse: 3, touch: 8 }; // px; a smaller movement is no drag
const NEAR = { mouse: 12, touch: 26 }; // px to an object that a tap selects
const LENGTH = 1; // m, of what is added by keyboard
const ROUND = Math.PI / 36; // headings that are dragged are multiples of it
const MARK = 9; // px
const ARM = 34; // px

/** The tools that need two points, and the requests that they make. */
const BETWEEN = {
  erase: (ends) => ({ type: "erase_walls", ...ends }),
  wall: (ends) => ({ type: "draw_wall", ...ends }),
  line: (ends, name) => ({ type: "forbid", shape: "line", ...ends, name }),
  area: (ends, name) => ({ type: "forbid", shape: "area", ...ends, name }),
};

export class MapEditor {
  active = false;
  /** "select", or what the next drag makes: "erase", "wall", "place", "line", "area". */
  tool = "select";
  /** Number of the selected object in the draft, or null. */
  selected = null;
  /** @type {import("../messages.d.ts").MapDraft} */
  draft = { type: "map_draft", map: null, version: 0, steps: 0 };
  #map = null;
  #view;
  #send;
  #notify;
  #naming;
  #changed;
  #drag = null; // {tool, from, to, moved, start: CSS px, type}

  /**
   * @param view
   * @param send    function(message): returns whether it was sent
   * @param notify  function(text)
   * @param naming  function(): {role, name} for what is added, or null after asking for a name
   * @param changed function(), after tool, selection or sketch have changed
   */
  constructor({ view, send, notify, naming, changed }) {
    [this.#view, this.#send, this.#notify] = [view, send, notify];
    [this.#naming, this.#changed] = [naming, changed];
  }

  /** The map that is edited: the draft, or the map in use before the first edit. */
  get map() {
    return this.draft.map ?? this.#map;
  }

  get object() {
    return this.map?.objects[this.selected];
  }

  /** What a drag would make: {tool, from, to}, or null. */
  get sketch() {
    const drag = this.#drag;
    return drag && (drag.moved || drag.tool === "place") ? drag : null;
  }

  /** Takes the map in use. */
  adopt(map) {
    this.#map = map;
    this.selected = null;
    this.#changed();
  }

  takeDraft(draft) {
    const kept = this.object && draft.map?.objects[this.selected]?.kind === this.object.kind;
    this.draft = draft;
    if (!kept) this.selected = null;
    this.#changed();
  }

  setActive(active) {
    this.active = active;
    this.selected = this.#drag = null;
    this.setTool("select");
  }

  setTool(tool) {
    this.tool = tool;
    if (tool !== "select") this.selected = null;
    this.#changed();
  }

  select(number) {
    this.selected = number;
    this.#changed();
  }

  // pointers on the canvas, in CSS pixels

  take(point, type) {
    if (!this.active) return false;
    const at = this.#view.toWorld(point.x, point.y);
    if (this.tool === "select") return this.#selectAt(at, NEAR[kindOf(type)] / this.#view.scale);
    if (this.tool === "place" && !this.#naming()) return true; // asked for a name
    this.#drag = { tool: this.tool, start: point, type, from: at, to: at, moved: false };
    if (this.#view.mode !== "free") this.#view.setMode("free"); // else the floor would slip away
    this.#changed();
    return true;
  }

  drag(point) {
    const drag = this.#drag;
    if (!drag) return;
    const way = Math.hypot(point.x - drag.start.x, point.y - drag.start.y);
    if (!drag.moved && way < STILL[kindOf(drag.type)]) return;
    drag.moved = true;
    drag.to = this.#view.toWorld(point.x, point.y);
    this.#changed();
  }

  drop() {
    const drag = this.#drag;
    this.#drag = null;
    if (drag?.tool === "place") this.#place(drag.from, drag.moved ? headingOf(drag) : null);
    else if (drag?.moved) this.#make(drag.tool, drag.from, drag.to);
    else if (drag) this.#notify("Drag from one end to the other.");
    this.#changed();
  }

  /** The pointer is lost, to the system or to a pinch. */
  cancel() {
    this.#drag = null;
    this.#changed();
  }

  hovers(point) {
    if (!this.active || this.tool !== "select") return false;
    return this.#at(this.#view.toWorld(point.x, point.y), NEAR.mouse / this.#view.scale) >= 0;
  }

  // keys and buttons

  /** Makes what a tool makes in the middle of the picture: for use without a pointer. */
  makeInMiddle(tool) {
    const { x, y } = this.#view;
    const [from, to] = [{ x: x - LENGTH / 2, y: y - LENGTH / 2 }, { x: x + LENGTH / 2, y: y + LENGTH / 2 }];
    if (tool === "place") this.#place({ x, y }, null);
    else this.#make(tool, from, tool === "erase" || tool === "area" ? to : { x: to.x, y: from.y });
  }

  rename(name) {
    if (this.object && this.object.name !== name) this.#ask({ type: "rename_object", ...this.#which(), name });
  }

  remove() {
    if (this.object) this.#ask({ type: "remove_object", ...this.#which() });
  }

  undo() {
    this.#ask({ type: "undo_map_edit" });
  }

  discard() {
    this.#ask({ type: "discard_map_edits" });
  }

  save(name, format) {
    this.#ask({ type: "save_map", name, format });
  }

  #which() {
    return { number: this.selected, version: this.draft.version };
  }

  #make(tool, from, to) {
    const ends = { x0: from.x, y0: from.y, x1: to.x, y1: to.y };
    const named = tool === "line" || tool === "area" ? this.#naming(false) : null;
    this.#ask(BETWEEN[tool](ends, named?.name ?? ""));
  }

  #place({ x, y }, heading) {
    const named = this.#naming();
    if (named) this.#ask({ type: "name_place", ...named, x, y, heading });
  }

  #ask(message) {
    if (!this.#send(message)) this.#notify("Not connected: nothing was changed.");
  }

  #selectAt(at, slack) {
    const found = this.#at(at, slack);
    this.select(found < 0 ? null : found);
    return found >= 0;
  }

  /** The number of the object nearest to a point, at most `slack` [m] away; -1 without one. */
  #at(point, slack) {
    const far = (this.map?.objects ?? []).map((item) => distance(item, point));
    const least = Math.min(Infinity, ...far);
    return least <= slack ? far.indexOf(least) : -1;
  }
}

const headingOf = ({ from, to }) => ROUND * Math.round(Math.atan2(to.y - from.y, to.x - from.x) / ROUND);

/** How far a point is from a place, or from the sides of a line or area [m]. */
function distance({ x, y, points }, at) {
  if (points.length === 0) return Math.hypot(at.x - x, at.y - y);
  const sides = points.map((start, n) => [start, points[(n + 1) % points.length]]);
  return Math.min(...sides.map(([start, end]) => toSegment(at, start, end)));
}

function toSegment({ x, y }, [x0, y0], [x1, y1]) {
  const [dx, dy] = [x1 - x0, y1 - y0];
  const share = Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - x0 - share * dx, y - y0 - share * dy);
}

/** The selected object, and what a drag would make, in world coordinates. */
export function drawMapEdit(context, view, palette, { object, sketch }) {
  context.strokeStyle = palette.select;
  context.lineWidth = 2 / view.scale;
  if (object) outlineObject(context, view, object);
  if (!sketch) return;
  const { tool, from, to, moved } = sketch;
  context.strokeStyle = tool === "wall" ? palette.wall : tool === "place" ? palette.select : palette.forbidden;
  context.setLineDash(tool === "wall" ? [] : [6 / view.scale, 4 / view.scale]);
  context.beginPath();
  if (tool === "erase" || tool === "area") context.rect(from.x, from.y, to.x - from.x, to.y - from.y);
  else if (tool !== "place") (context.moveTo(from.x, from.y), context.lineTo(to.x, to.y));
  else markPlace(context, view, from, moved ? headingOf(sketch) : null);
  context.stroke();
  context.setLineDash([]);
}

function markPlace(context, view, { x, y }, heading) {
  context.arc(x, y, MARK / view.scale, 0, 2 * Math.PI);
  if (heading === null) return;
  const arm = ARM / view.scale;
  context.moveTo(x, y);
  context.lineTo(x + arm * Math.cos(heading), y + arm * Math.sin(heading));
}

function outlineObject(context, view, { x, y, points }) {
  context.beginPath();
  if (points.length === 0) context.arc(x, y, (MARK + 6) / view.scale, 0, 2 * Math.PI);
  for (const [px, py] of points) context.lineTo(px, py);
  if (points.length > 2) context.closePath();
  context.stroke();
}
