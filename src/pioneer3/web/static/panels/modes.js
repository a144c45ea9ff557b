// The modes in which the robot drives by itself: the view that starts them, and the card of the running one.

import { byId, degrees, make, makeButton, put, putLines, set } from "../dom.js";
import { part } from "./widgets.js";

const PRESETS = [
  ["lab", "Lab", "Slow, 0.15 m/s."],
  ["aria", "ARIA", "As ARIA's wander, 0.4 m/s."],
  ["explore", "Explore", "Seeks new ground, 0.3 m/s."],
];
const RULES = [
  ["tracking", "Tracking", "Remembers whom it follows."],
  ["lab", "Lab", "Goes to the nearest echo."],
];
const TIMES = [["60", "1 minute"], ["300", "5 minutes"], ["900", "15 minutes"], ["3600", "1 hour"]];
const GOING = { goto: "Looks for the way", follow: "Looks for somebody to follow" }; // while there is no target
const LEAVE = "A mode runs for as long as this page is connected: close it, lose the connection or lock the phone, "
  + "and the robot stops within 5 seconds. Another tab in front does not end it. STOP and E-STOP end it at once, for everybody.";

function choice(id, label, options) {
  const select = make("select", { id, class: "small" }, ...options.map(([value, text]) => new Option(text, value)));
  const field = make("label", { class: "field" }, make("span", {}, label), select);
  if (!options[0][2]) return [select, field];
  const meaning = make("p", { class: "words meaning", role: "status" });
  const tell = () => put(meaning, options[select.selectedIndex][2]);
  select.addEventListener("change", tell);
  tell();
  return [select, make("div", {}, field, meaning)];
}

function figure(id, label, unit, attributes) {
  const input = make("input", { id, type: "number", class: "small", step: "0.05", ...attributes });
  return [input, make("label", { class: "field" }, make("span", {}, `${label} `, make("small", {}, unit)), input)];
}

const button = (id, text, act, extra = "") => makeButton(text, { id, class: `choice ${extra}`.trim() }, act);

export class ModesView {
  #send;
  #notify;
  #pose = null;
  #running = make("p", { class: "mode-state", role: "status" });
  #decided = make("ul", { class: "lines-of-text" });
  #end;
  #motors;
  #starts;

  /**
   * @param send     function(message)
   * @param notify function(text)
   * @param end      function(): ends the mode
   * @param motors   function(on): switches the motors
   */
  constructor(container, { send, notify, end, motors }) {
    [this.#send, this.#notify] = [send, notify];
    const [preset, presetField] = choice("wander-preset", "Manner", PRESETS);
    const [rule, ruleField] = choice("follow-rule", "Rule", RULES);
    const [keep, keepField] = figure("follow-keep", "Distance to keep", "m", { min: 0.1, max: 3, value: 0.3 });
    const [time, timeField] = choice("mode-time", "For at most", TIMES);
    time.value = "300";
    const [x, xField] = figure("goto-x", "x", "m", { value: 0 });
    const [y, yField] = figure("goto-y", "y", "m", { value: 0 });
    const [heading, headingField] = figure("goto-heading", "Heading", "°, empty for any", { step: 5, min: -360, max: 360 });
    const seconds = () => Number(time.value);
    this.#end = button("mode-end", "End", end, "danger wide");
    this.#motors = button("motors-switch", "Switch the motors on", () => motors(this.#motors.dataset.on !== "true"));
    const wander = button("wander-start", "Start wandering", () => this.#start({ mode: "wander", preset: preset.value, seconds: seconds() }));
    const follow = button("follow-start", "Start following", () => this.#check([keep]) && this.#start({ mode: "follow", rule: rule.value, keep: keep.valueAsNumber, seconds: seconds() }));
    const go = button("goto-start", "Drive there", () => this.#goto(x, y, heading));
    const here = button("goto-here", "Where it is now", () => this.#fill(x, y, heading));
    this.#starts = [wander, follow, go];
    container.append(
      part("Now", this.#running, this.#decided, this.#end),
      make("div", { class: "for-drivers" },
        part("Motors", this.#motors, make("p", { class: "words" }, "A mode switches them on by itself.")),
        part("Before you start", make("p", { class: "words", id: "mode-note" }, LEAVE), timeField),
        part("Wander", make("p", { class: "words" }, "Drives about and keeps clear of what is in the way."), presetField, wander),
        part("Follow", make("p", { class: "words" }, "Follows the person in front, with the front sonars. Stand 0.6 m before it, then walk slowly."), ruleField, keepField, follow),
        part("Go to", make("p", { class: "words" }, "Drives to a point of the map, and around what is small."), make("div", { class: "fields" }, xField, yField, headingField), make("div", { class: "row" }, go, here)),
      ),
    );
    for (const start of this.#starts) start.setAttribute("aria-describedby", "mode-note");
  }

  /** @param usable whether this page may drive; @param startedBy who started the mode, "you" or a name */
  show(snapshot, usable, startedBy) {
    const { mode, ended, decided, motors, emergency_stop: latched } = snapshot;
    this.#pose = snapshot.pose;
    const runs = mode !== null;
    put(this.#running, runs ? `${named(mode)} runs${startedBy ? `, started by ${startedBy}` : ""}.` : howItEnded(ended));
    putLines(this.#decided, runs ? decided : []);
    this.#end.hidden = !runs;
    if (runs) put(this.#end, `End ${mode}`);
    for (const start of this.#starts) start.disabled = !usable || latched;
    this.#motors.disabled = !usable || (latched && !motors.enabled);
    set(this.#motors, "data-on", String(motors.enabled));
    put(this.#motors, motors.enabled ? "Switch the motors off" : "Switch the motors on");
  }

  #start(mode) {
    if (!this.#send({ type: "start_mode", mode })) this.#notify("Not connected: nothing was started.");
  }

  #goto(x, y, heading) {
    if (!this.#check([x, y, heading])) return;
    const radians = heading.value === "" ? null : (heading.valueAsNumber * Math.PI) / 180;
    const message = { type: "goto", x: x.valueAsNumber, y: y.valueAsNumber, ...(radians === null ? {} : { heading: radians }) };
    if (!this.#send(message)) this.#notify("Not connected: nothing was started.");
  }

  #fill(x, y, heading) {
    if (!this.#pose) return;
    x.value = this.#pose.x.toFixed(2);
    y.value = this.#pose.y.toFixed(2);
    heading.value = String(Math.round(degrees(this.#pose.theta)));
  }

  #check(inputs) {
    const wrong = inputs.find((input) => !input.checkValidity() || (input.value === "" && input.id !== "goto-heading"));
    if (wrong) {
      wrong.focus();
      this.#notify(wrong.validationMessage || "A number is missing.");
    }
    return wrong === undefined;
  }
}

/** A mode's name where a sentence begins. */
const named = (mode) => mode[0].toUpperCase() + mode.slice(1);

/** How the last mode ended, in words. */
function howItEnded(ended) {
  if (!ended) return "No mode runs.";
  return ended.done ? `${named(ended.mode)} has done what it was for.` : `${named(ended.mode)} ended: ${ended.why}.`;
}

/** On the map, while a mode runs: its name, its target, its decisions, and the button that ends it. */
export class ModeCard {
  #tell;
  #mode = null;

  /**
   * @param end  function(): ends the mode
   * @param tell function(text): shows news
   */
  constructor({ end, tell }) {
    this.#tell = tell;
    byId("card-end").addEventListener("click", end);
  }

  /** @param startedBy "you" or a name; @param going its target in words, or "" */
  show({ mode, decided, ended, emergency_stop: latched }, startedBy, going) {
    byId("mode-card").hidden = mode === null;
    if (mode !== null) {
      put(byId("card-title"), `${named(mode)}${startedBy ? `, started by ${startedBy}` : ""}`);
      put(byId("card-end"), `End ${mode}`);
      byId("card-going").hidden = !(mode in GOING);
      put(byId("card-going"), going || GOING[mode] || "");
    }
    putLines(byId("decided"), mode === null ? [] : decided, (line) => make("li", { title: line }, line));
    const news = this.#mode !== null && mode === null && ended && !latched; // the alarm tells of an emergency stop
    if (news) this.#tell(howItEnded(ended));
    this.#mode = mode;
  }

  /** Another robot is shown: the end of its mode is no news. */
  forget() {
    this.#mode = null;
  }
}
