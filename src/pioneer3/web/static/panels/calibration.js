// The calibration of a robot: a step at a time is driven, and its end is measured by a laser or by a tape.

import { degrees, make, put, putItems, putLines, putProse, sentence } from "../dom.js";
import { button, choice } from "./fields.js";
import { part } from "./widgets.js";

const IDLE = "Measures how wrong the wheels are, by a laser, or by a tape: turns, squares both ways, and a line. It takes two by two metres of free floor "
  + "and a quarter of an hour. The robot MOVES, and stops before what its sensors see.";

/** Drives the steps of a calibration, takes what somebody measured, and has it written into the robot's own file. */
export class CalibrationForm {
  element;
  #notify;
  #state = make("p", { class: "words", id: "calibration-state", role: "status" });
  #needs = make("p", { class: "words" });
  #asks = make("div", { class: "fields" });
  #note = make("p", { class: "words", id: "calibration-note", role: "status" });
  #lines = make("ul", { class: "lines-of-text", "aria-label": "What was measured" });
  #by;
  #byField;
  #buttons;

  /** @param send function(message): returns whether it was sent @param notify function(text) */
  constructor({ send, notify }) {
    this.#notify = notify;
    [this.#by, this.#byField] = choice("calibration-by", "Measured by", [["scans", "its scans"], ["tape", "a tape"]]);
    const ask = (step, rest = {}) => send({ type: "calibrate", step, ...rest }) || notify("Not connected: nothing was started.");
    const measure = () => {
      const answers = this.#answers();
      if (answers) ask("measure", { answers });
    };
    this.#buttons = {
      begin: button("calibration-begin", "Calibrate", () => ask("begin", { by_tape: this.#by.value === "tape" })),
      measure: button("calibration-measure", "Keep these numbers", measure),
      drive: button("calibration-drive", "Drive this step", () => ask("drive")),
      skip: button("calibration-skip", "Skip it", () => ask("skip")),
      undo: button("calibration-undo", "Forget the last", () => ask("undo")),
      write: button("calibration-write", "Write the robot's file", () => ask("write")),
      end: button("calibration-end", "End the calibration", () => ask("end")),
    };
    const row = make("div", { class: "row" }, ...Object.values(this.#buttons));
    this.element = part("Calibrate", this.#state, this.#needs, this.#asks, this.#byField, row, this.#note, this.#lines);
  }

  /** @param {import("../messages.d.ts").CalibrationState | null} calibration @param usable whether this page may drive @param laser whether the robot has one */
  show(calibration, usable, laser) {
    this.element.hidden = !calibration;
    if (!calibration) return;
    const { going, number, steps, title, needs, asks, waits, note, lines } = calibration;
    const last = going && !title;
    put(this.#state, !going ? IDLE : last ? "All steps are done." : `Step ${number} of ${steps}: ${title}.`);
    putProse(this.#needs, waits ? sentence(`Please wait: it ${waits}`) : asks.length ? "Measure where it stands now:" : needs);
    putItems(this.#asks, JSON.stringify([number, asks]), () => asks.map(field));
    this.#byField.hidden = going || !laser;
    const there = { begin: !going, drive: going && title, measure: asks.length, skip: going && title, undo: lines.length && going, write: last && lines.length, end: going };
    for (const [name, shown] of Object.entries(there)) {
      this.#buttons[name].hidden = !shown;
      this.#buttons[name].disabled = !usable || Boolean(waits);
    }
    put(this.#buttons.drive, asks.length ? "Drive it again" : "Drive this step");
    putProse(this.#note, note ? sentence(note) : "");
    putLines(this.#lines, lines.map(sentence));
  }

  /** The numbers that are filled in [m, rad]; null where one is missing or wrong, which is said. */
  #answers() {
    const inputs = [...this.#asks.querySelectorAll("input")];
    const wrong = inputs.find(({ validity }) => validity.badInput || validity.valueMissing);
    if (wrong) {
      wrong.focus();
      this.#notify(wrong.validationMessage);
      return null;
    }
    const filled = inputs.filter(({ value }) => value !== "");
    return Object.fromEntries(filled.map(({ name, valueAsNumber, dataset }) => [name, valueAsNumber * (dataset.angle ? 1 / degrees(1) : 0.01)]));
  }
}

/** A question, and its answer in the units of a tape and of people. */
function field({ name, text, angle, optional }) {
  const input = make("input", { id: `calibration-${name}`, name, type: "number", step: "any", class: "small", ...(angle ? { "data-angle": "1" } : {}), ...(optional ? {} : { required: "" }) });
  const unit = `${angle ? "°" : "cm"}${optional ? ", may be empty" : ""}`;
  return make("label", { class: "field" }, make("span", {}, `${text} `, make("small", {}, unit)), input);
}
