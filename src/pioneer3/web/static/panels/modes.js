// The modes in which the robot drives by itself: a form for each, and the card of the running one.

import { byId, degrees, make, put, putLines, putProse, sentence, set } from "../dom.js";
import { CalibrationForm } from "./calibration.js";
import { Fields, button, choice, loadForms } from "./fields.js";
import { MapMaking } from "./map_making.js";
import { part } from "./widgets.js";

const TIMES = [["60", "1 minute"], ["300", "5 minutes"], ["900", "15 minutes"], ["3600", "1 hour"]];
const WORDS = { // for modes that people name otherwise; `going`: while there is no target; `quiet`: its end is no news
  explore: { doing: "Exploring", noun: "exploring", going: "Looks where the map ends", done: "Explored: no edge of the map is left." },
  goto: { doing: "On the way", noun: "the drive", going: "Looks for the way" },
  patrol: { doing: "On patrol", noun: "the patrol", going: "Stands at a place of its patrol" },
  "look around": { doing: "Looking around", noun: "looking around", going: "Drives until it knows where it is", done: "It knows where it is." },
  calibration: { doing: "Calibrating", noun: "the calibration", done: "It has driven its leg.", quiet: true },
  follow: { doing: "Following", noun: "following", going: "Looks for somebody to follow" },
};
const LEAVE = "A mode, a goal or a patrol goes on while this page is heard of: close it, lose the connection or lock the phone, "
  + "and the robot stops after 2 seconds. Another tab in front does not end it. STOP and E-STOP end it at once, for everybody.";

export class ModesView {
  #send;
  #notify;
  #pose = null;
  #running = make("p", { class: "mode-state", role: "status" });
  #decided = make("ul", { class: "lines-of-text" });
  #end;
  #motors;
  #time;
  #forms = make("div", {});
  #map;
  #calibration;
  #starts = [];
  #toPlaces = []; // of forms of modes that go to places of the map: {form, reason: why it is not there}

  /**
   * @param send     function(message)
   * @param notify function(text)
   * @param end      function(): ends the mode
   * @param motors   function(on): switches the motors
   * @param group    element for the modes of several robots
   */
  constructor(container, { send, notify, end, motors, group }) {
    [this.#send, this.#notify] = [send, notify];
    const [time, timeField] = choice("mode-time", "For at most", TIMES);
    this.#time = time;
    time.value = "300";
    this.#end = button("mode-end", "End", end, "danger wide");
    this.#map = new MapMaking({ send, notify });
    this.#calibration = new CalibrationForm({ send, notify });
    this.#motors = button("motors-switch", "Switch the motors on", () => motors(this.#motors.dataset.on !== "true"));
    container.append(
      part("Now", this.#running, this.#decided, this.#end),
      make("div", { class: "for-drivers" },
        part("Motors", this.#motors, make("p", { class: "words" }, "A mode switches them on by itself.")),
        part("Before you start", make("p", { class: "words", id: "mode-note" }, LEAVE), timeField),
        group,
        this.#map.element,
        this.#calibration.element,
        this.#forms,
      ),
    );
    loadForms("/api/modes", (forms) => this.#forms.replaceChildren(...forms.map((form) => this.#form(form))));
  }

  /** The longest time of a mode that is started [s]. */
  get seconds() {
    return Number(this.#time.value);
  }

  /** @param usable whether this page may drive; @param startedBy who started the mode, "you" or a name; @param robot the Robot */
  show(snapshot, usable, startedBy, robot) {
    const free = usable && !snapshot.emergency_stop;
    this.#map.show(robot?.mapping ?? null, free);
    this.#calibration.show(robot?.calibration ?? null, free, Boolean(robot?.hello.laser));
    for (const { form, reason } of this.#toPlaces) {
      putProse(reason, robot?.hello.forbids ? sentence(robot.hello.forbids) : "");
      form.hidden = reason.textContent !== "";
    }
    const { mode, ended, decided, motors, emergency_stop: latched } = snapshot;
    this.#pose = snapshot.robot_in_map;
    const runs = mode !== null;
    put(this.#running, runs ? `${doing(mode, startedBy)}.` : howItEnded(ended));
    putLines(this.#decided, runs ? decided : []);
    this.#end.hidden = !runs;
    if (runs) put(this.#end, `End ${noun(mode)}`);
    for (const start of this.#starts) start.disabled = !usable || latched;
    this.#motors.disabled = !usable || (latched && !motors.enabled);
    set(this.#motors, "data-on", String(motors.enabled));
    put(this.#motors, motors.enabled ? "Switch the motors off" : "Switch the motors on");
  }

  #form({ name, title, summary, advice, start, goes_to_place: goesToPlace, fields }) {
    const made = new Fields(name, fields);
    const begin = button(`${name}-start`, start, () => this.#start(name, goesToPlace, made));
    begin.setAttribute("aria-describedby", "mode-note");
    this.#starts.push(begin);
    const here = goesToPlace ? [button(`${name}-here`, "Where it is now", () => this.#fill(made))] : [];
    const words = goesToPlace ? `${summary} The place is in the map.` : `${summary} ${advice}`.trim();
    const form = make("div", {}, make("p", { class: "words" }, words), ...made.choices, make("div", { class: "fields" }, ...made.numbers), make("div", { class: "row" }, begin, ...here));
    const reason = make("p", { class: "words" });
    if (goesToPlace) this.#toPlaces.push({ form, reason });
    return part(title, form, reason);
  }

  #start(name, goesToPlace, made) {
    const given = made.read(this.#notify);
    if (!given) return;
    const mode = { mode: name, ...given, seconds: Number(this.#time.value) };
    const message = goesToPlace ? { type: "goto", ...given } : { type: "start_mode", mode };
    if (!this.#send(message)) this.#notify("Not connected: nothing was started.");
  }

  #fill(made) {
    if (!this.#pose) return;
    const { x, y, theta } = this.#pose;
    made.fill({ x: x.toFixed(2), y: y.toFixed(2), heading: String(Math.round(degrees(theta))) });
  }
}

/** Words where a sentence begins. */
const capital = (text) => text[0].toUpperCase() + text.slice(1);
const noun = (mode) => WORDS[mode]?.noun ?? mode;
const doing = (mode, startedBy) => (WORDS[mode]?.doing ?? capital(mode)) + (startedBy ? `, started by ${startedBy}` : "");

/** How the last mode ended, in words. */
function howItEnded(ended) {
  if (!ended) return "No mode runs.";
  const { mode, done, why, place } = ended;
  if (!done) return `${capital(noun(mode))} ended: ${why}.`;
  if (mode === "goto" || mode === "patrol") return place ? `Arrived: ${place}` : "Arrived.";
  return WORDS[mode]?.done ?? `${capital(noun(mode))}: done.`;
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
      put(byId("card-title"), doing(mode, startedBy));
      put(byId("card-end"), `End ${noun(mode)}`);
      const still = WORDS[mode]?.going;
      byId("card-going").hidden = !still;
      put(byId("card-going"), going || still || "");
    }
    putLines(byId("decided"), mode === null ? [] : decided, (line) => make("li", { title: line }, line));
    const quiet = latched || (ended?.done && WORDS[ended.mode]?.quiet); // the alarm tells of an emergency stop
    const news = this.#mode !== null && mode === null && ended && !quiet;
    if (news) this.#tell(howItEnded(ended));
    this.#mode = mode;
  }

  /** Another robot is shown: the end of its mode is no news. */
  forget() {
    this.#mode = null;
  }
}
