// The toolbar of the editor under the map, and the editor's keys.

import { byId, hasModifier, isTyping, put, set } from "../dom.js";
import { labelOf } from "../model/world.js";
import { STEPS, TURN } from "./gestures.js";

const TOOLS = ["move", "box", "person", "walker", "robot"];
const HINTS = {
  move: "Tap a thing to select it, drag it to move it.",
  box: "Tap where a box goes, or drag from corner to corner.",
  person: "Tap where somebody stands.",
  walker: "Drag along the way, or tap its two ends.",
  robot: "Tap where the robot goes; drag to point it.",
};
const CYCLE = 0.1; // s, one report of the robot

export class EditorToolbar {
  #editor;
  #world;
  #list = "";

  /**
   * @param editor, world
   * @param send    function(message)
   * @param driving function(): whether keys drive now
   */
  constructor({ editor, world, send, driving }) {
    this.#editor = editor;
    this.#world = world;
    for (const tool of TOOLS) byId(`tool-${tool}`).addEventListener("click", (event) => this.#pick(tool, event));
    byId("model").addEventListener("change", ({ target }) => (editor.model = target.value));
    byId("thing").addEventListener("change", ({ target }) => {
      editor.select(target.value ? Number(target.value) : null);
    });
    byId("turn-left").addEventListener("click", () => editor.nudge(0, 0, TURN));
    byId("turn-right").addEventListener("click", () => editor.nudge(0, 0, -TURN));
    byId("remove").addEventListener("click", () => editor.remove());
    byId("press").addEventListener("click", () => {
      send({ type: "stop_button", id: editor.selected, pressed: !editor.thing.stop_button });
    });
    byId("cable").addEventListener("click", () => {
      send({ type: "cable", id: editor.selected, plugged: !editor.thing.plugged });
    });
    byId("battery-charge").addEventListener("change", ({ target }) => {
      send({ type: "charge", id: editor.selected, charge: Number(target.value) });
      target.blur();
    });
    byId("pause").addEventListener("click", () => send({ type: "pause", paused: !world.paused }));
    byId("single").addEventListener("click", () => send({ type: "step", seconds: CYCLE }));
    byId("world-speed").addEventListener("change", ({ target }) => {
      send({ type: "speed", speed: Number(target.value) });
      target.blur(); // gives the arrow keys back to driving
    });
    addEventListener("keydown", (event) => this.#key(event, driving), { capture: true });
  }

  /** Takes the models that can be added. */
  adopt(models) {
    if (!models) return;
    const select = byId("model");
    if (select.options.length === models.length) return;
    select.replaceChildren(...models.map(({ name, title }) => new Option(`${title} (${name})`, name)));
    select.value = models.find(({ name }) => name === "p3dx-sh")?.name ?? models[0].name;
    this.#editor.model = select.value;
  }

  /** Shows tool, selection and time as they are now. */
  show() {
    const editor = this.#editor;
    if (!editor.active) return;
    for (const tool of TOOLS) set(byId(`tool-${tool}`), "aria-pressed", String(editor.tool === tool));
    byId("canvas").dataset.tool = editor.tool;
    byId("model-row").hidden = editor.tool !== "robot";
    byId("thing-row").hidden = editor.tool === "robot";
    this.#showThings();
    this.#showThing(editor.thing);
    this.#showClock(this.#world.clock);
    put(byId("hint"), this.#hint());
  }

  #pick(tool, { detail }) {
    if (tool !== "move" && detail === 0) this.#editor.addInMiddle(tool); // Enter: there is no pointer to tap with
    else this.#editor.setTool(tool);
  }

  #showThings() {
    const things = [...this.#world.things.values()];
    const key = things.map((thing) => `${thing.id} ${labelOf(thing)}`).join("\n");
    const select = byId("thing");
    if (key !== this.#list) {
      this.#list = key;
      const options = things.map((thing) => new Option(labelOf(thing) + (thing.own ? " (yours)" : ""), thing.id));
      select.replaceChildren(new Option("Nothing selected", ""), ...options);
    }
    const chosen = String(this.#editor.selected ?? "");
    if (select.value !== chosen) select.value = chosen;
  }

  #showThing(thing) {
    const robot = thing?.kind === "robot";
    for (const id of ["turn-left", "turn-right"]) byId(id).disabled = !thing || thing.kind === "person";
    byId("remove").disabled = !thing || thing.own;
    for (const id of ["press", "cable", "battery-charge"]) byId(id).disabled = !robot;
    this.#showCharge(robot ? thing.charge : null);
    set(byId("press"), "aria-pressed", String(robot && thing.stop_button));
    set(byId("cable"), "aria-pressed", String(robot && !thing.plugged));
  }

  /** The remaining charge is the text of an option that cannot be chosen. */
  #showCharge(charge) {
    const select = byId("battery-charge");
    const text = charge === null ? "Battery" : `Battery ${Math.round(charge * 100)} %`;
    if (select.options[0].text !== text) select.options[0].text = text;
    if (document.activeElement !== select && select.value !== "") select.value = "";
  }

  #showClock(clock) {
    if (!clock) return;
    set(byId("pause"), "aria-pressed", String(clock.paused));
    put(byId("pause-text"), clock.paused ? "Resume" : "Pause");
    const speed = byId("world-speed");
    const value = [...speed.options].find((option) => Number(option.value) === clock.speed)?.value ?? "";
    if (speed.value !== value && document.activeElement !== speed) speed.value = value;
    put(byId("clock"), clock.paused ? `${clock.time.toFixed(1)} s` : `${clock.factor.toFixed(1)}×`);
  }

  #hint() {
    const { tool, thing, begun } = this.#editor;
    if (tool === "walker" && begun) return "Now tap where they turn back.";
    if (tool !== "move" || !thing) return HINTS[tool];
    if (thing.kind === "box") return `A box, ${(thing.front + thing.rear).toFixed(2)} m by ${(2 * thing.side).toFixed(2)} m.`;
    if (thing.kind === "person") return thing.walks ? "Somebody who walks." : "Somebody who stands.";
    const host = thing.own ? "driven from here" : thing.connected ? "a program drives it" : "no program drives it";
    return `${thing.title} at ${thing.url}, ${thing.plugged ? host : "unplugged"}.`;
  }

  #key(event, driving) {
    const editor = this.#editor;
    if (hasModifier(event) || isTyping(event)) return;
    if (!editor.active) return;
    if (event.key === "Escape") {
      editor.cancel();
      if (editor.tool === "move") editor.select(null);
      else editor.setTool("move");
      return;
    }
    if (!editor.thing) return;
    if (event.shiftKey && event.code in STEPS && !driving()) editor.nudge(...STEPS[event.code], 0);
    else if (event.key === "[" || event.key === "]") editor.nudge(0, 0, event.key === "[" ? TURN : -TURN);
    else if (event.key === "Delete" || event.key === "Backspace") editor.remove();
    else return;
    event.preventDefault();
    event.stopImmediatePropagation(); // these keys do not drive
  }
}
