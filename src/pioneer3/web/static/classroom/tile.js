// One robot of the class on the teacher's page: a small map, its student, who drives it, and what can be done about it.

import { make, makeButton, makeSvg, number, put, putItems, set } from "../dom.js";
import { SmallMap } from "./small_map.js";

const ICONS = {
  back: "M4 10a8 8 0 1 1 1 7M4 4v6h6",
  free: "M9 11a4 4 0 1 0 0-8 4 4 0 0 0 0 8M2 21c0-5 3-7 7-7 2 0 4 .5 5.500 2M16 11l6 6M22 11l-6 6",
};
const MOVING = 0.01; // m/s

/** What a button of a tile asks for; `label` is completed by the name. */
const ACTS = {
  take: { text: "Take over", label: "Take over, and drive here:" },
  pause: { text: "Pause", label: "Pause" },
  back: { text: "Put back", label: "Put back where it began:", icon: ICONS.back },
  free: { text: "Free seat", label: "Free the seat of", icon: ICONS.free },
};

export class Tile {
  element = make("article", { class: "tile" });
  #name = make("h2");
  #who = make("span", { class: "who-drives" });
  #marks = make("ul", { class: "marks", "aria-label": "Marks" });
  #open = make("a", { class: "open", target: "_blank" });
  #speed = make("span");
  #battery = make("span");
  #buttons;
  #map;

  /**
   * @param id    number of the robot
   * @param floor SharedFloor
   * @param act   function(name, id): "take", "pause", "back" or "free" was pressed
   * @param changed function(): the picture has to be drawn anew
   */
  constructor(id, { floor, act, changed }) {
    this.id = id;
    this.#map = new SmallMap(floor, changed);
    this.#buttons = Object.fromEntries(Object.keys(ACTS).map((name) => [name, actButton(name, () => act(name, id))]));
    set(this.#open, "href", `/?robot=${id}`);
    set(this.#open, "title", "Open this robot's own page");
    this.#open.append(this.#map.canvas, this.#marks, make("span", { class: "open-word", "aria-hidden": "true" }, "Open ↗"));
    this.element.append(
      make("header", {}, make("span", { class: "robot-number", "aria-hidden": "true" }, String(id)), this.#name, this.#who),
      this.#open,
      make("p", { class: "figures" }, this.#battery, this.#speed),
      make("div", { class: "acts" }, ...Object.values(this.#buttons)),
    );
  }

  /** Draws the picture. */
  draw(robot, pose, placed, isLive) {
    this.#map.draw(robot, pose, placed, isLive);
  }

  /**
   * Shows the seat and the newest snapshot.
   * @param {import("../messages.d.ts").Seat} seat
   * @param {import("../messages.d.ts").SmallSnapshot | null} snapshot
   * @param all whether all robots are paused
   * @param live whether the snapshot is fresh
   */
  show(seat, snapshot, { all, live }) {
    const name = seat.name ?? "free";
    const called = seat.name ?? `robot ${seat.robot}`;
    const [words, kind] = driverOf(seat, snapshot, live);
    const paused = seat.paused || all;
    put(this.#name, name);
    put(this.#who, words);
    set(this.element, "data-by", kind);
    set(this.element, "aria-label", `Robot ${seat.robot}, ${name}, ${words}`);
    this.element.classList.toggle("is-free", seat.name === null);
    this.element.classList.toggle("is-paused", paused);
    set(this.#open, "aria-label", `Open robot ${seat.robot}, ${name}, in a new tab`);
    put(this.#battery, snapshot ? `${number(snapshot.battery, 1)} V` : "–");
    put(this.#speed, live && Math.abs(snapshot.v) >= MOVING ? `${number(snapshot.v, 2)} m/s` : live ? "stands" : "");
    const marks = marksOf(seat, snapshot, live, paused);
    putItems(this.#marks, JSON.stringify(marks), () => marks.map(([text, level]) => make("li", { "data-level": level }, text)));
    this.#marks.hidden = marks.length === 0;
    for (const [act, button] of Object.entries(this.#buttons)) set(button, "aria-label", `${ACTS[act].label} ${called}`);
    put(this.#buttons.pause, seat.paused ? "Go on" : "Pause");
    set(this.#buttons.pause, "aria-label", `${seat.paused ? "Let go on" : "Pause"} ${called}`);
    set(this.#buttons.pause, "aria-pressed", String(seat.paused));
    this.#buttons.free.disabled = seat.name === null;
  }
}

function actButton(name, act) {
  const { text, icon } = ACTS[name];
  const button = makeButton(icon ? "" : text, { class: `small act-${name}`, title: text }, act);
  if (icon) button.append(makeSvg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, makeSvg("path", { d: icon })), make("span", {}, text));
  return button;
}

/** Who drives, in words, and its kind for the colour. */
function driverOf({ name, program }, snapshot, live) {
  if (!live) return ["no news", "none"];
  const { by, driver } = snapshot;
  if (by === "student") return [name && driver === name ? "drives" : `${driver} drives`, "student"];
  if (by === "teacher") return ["teacher drives", "teacher"];
  if (by === "program" || program) return ["program drives", "program"];
  if (by === "mode") return [driver ?? "mode", "mode"];
  return ["nobody drives", "none"];
}

/** Returns what is worth a mark, [text, level], the most urgent first. */
function marksOf(seat, snapshot, live, paused) {
  const marks = [];
  if (live && snapshot.emergency_stop) marks.push(["E-STOP", "bad"]);
  if (snapshot && !snapshot.connected) marks.push(["NO ROBOT", "bad"]);
  if (live && snapshot.stalled) marks.push(["STALLED", "bad"]);
  if (paused) marks.push(["PAUSED", "warn"]);
  if (seat.recording && seat.recording.seconds === null) marks.push(["● REC", "rec"]);
  if (seat.name !== null && seat.online === 0) marks.push([seat.program ? "PAGE CLOSED" : "OFFLINE", "idle"]);
  return marks;
}
