// A class on the page of one robot: the port for the student's own programs, recordings, and banners that say who
// keeps the robot from being driven.

import { byId, make, makeButton, put, putItems, sentence, set } from "../dom.js";
import { ask } from "../http.js";
import { part } from "../panels/widgets.js";
import { askForInstallation, bookLink, installationSteps } from "./installation.js";
import { copy } from "./invitation.js";
import { duration } from "./runs.js";
import { isToTakeOver } from "./take_over.js";

const WORDS = "Programs reach the robot at this port, from this computer and from others. While one is connected it drives the robot; this page goes on showing it, and stops it.";
const exampleOf = (url) => `from pioneer3 import connect
with connect("${url}") as robot:
    robot.move(0.3)  # m
    robot.turn(1.57)  # rad, to the left`;

export class OwnRobot {
  #send;
  #notify;
  #prefer;
  /** The part of this page in the class. @type {import("../messages.d.ts").ClassMember | null} */
  #member = null;
  /** @type {import("../messages.d.ts").Class | null} */
  #class = null;
  #seat = null;
  #url = make("code", { class: "own-url", id: "own-url" });
  #example = make("pre", { class: "own-example", id: "own-example", tabindex: "0", "aria-label": "A program for this robot" });
  #program = make("p", { class: "mode-state", id: "own-program", role: "status" });
  #state = make("p", { class: "mode-state", id: "recording-state", role: "status" });
  #steps;
  #runs = make("ul", { class: "lines-of-text", id: "own-runs", "aria-label": "Handed in" });
  #leave;
  #install = make("div", { id: "own-install" });

  /**
   * @param send   function(message): returns whether it was sent
   * @param notify function(text)
   * @param prefer function(): the view of programs is what a student looks for first
   */
  constructor({ send, notify, prefer }) {
    this.#send = send;
    this.#notify = notify;
    this.#prefer = prefer;
    const copying = (id, label, text) => makeButton("Copy", { class: "choice", id, "aria-label": label }, () => copy(text(), notify));
    const step = (text, name) => [name, makeButton(text, { class: "choice", id: `recording-${name}` }, () => this.#record(name))];
    this.#steps = Object.fromEntries([step("Record", "begin"), step("End", "end"), step("Hand in", "hand_in"), step("Drop it", "discard")]);
    const leave = makeButton("Leave the class", { class: "choice", id: "leave-class" }, () => this.#askToLeave());
    this.#leave = part("Leave", make("p", { class: "words" }, "The robot is free for somebody else then."), leave);
    byId("view-program").append(
      part("Your program", this.#program, make("p", { class: "words" }, WORDS),
        make("div", { class: "own-port" }, this.#url, copying("copy-url", "Copy the robot's address", () => this.#seat.url)),
        this.#example, make("div", { class: "row" }, copying("copy-example", "Copy the program", () => exampleOf(this.#seat.url)))),
      part("pioneer3 on your computer", this.#install),
      part("Record a run", this.#state, make("div", { class: "row" }, ...Object.values(this.#steps)), this.#runs),
      this.#leave,
    );
  }

  get isStudent() {
    return this.#member?.teacher === false;
  }

  get isTeacher() {
    return this.#member?.teacher === true;
  }

  /** @param {import("../messages.d.ts").Hello} hello */
  takeHello({ class: member }) {
    // shown out, on the class's own computer, which is the teacher's
    if (this.isStudent && member?.teacher) return location.replace("/join");
    if (this.#member === null && member?.teacher === false) this.#prefer();
    this.#member = member ?? null;
    document.body.classList.toggle("student", this.isStudent);
    for (const button of document.querySelectorAll('[data-view="program"]')) button.hidden = member === null;
    byId("class-link").hidden = !this.isTeacher;
    this.#leave.hidden = !this.isStudent;
    this.#install.parentElement.hidden = !this.isStudent;
    if (this.isStudent && !this.#install.hasChildNodes()) this.#showInstallation();
  }

  async #showInstallation() {
    const told = await askForInstallation();
    this.#install.parentElement.hidden = told === null;
    if (told) this.#install.replaceChildren(installationSteps(told, true, this.#notify), ...bookLink(told));
  }

  /** @param {import("../messages.d.ts").Class} message */
  takeClass(message) {
    this.#class = message;
  }

  /** Takes over the selected robot, if this page was opened to do that. */
  takeOver({ selected }) {
    if (this.isTeacher && isToTakeOver(selected?.id)) this.#send({ type: "take_over", robot: selected.id });
  }

  /**
   * Shows the seat of the selected robot, and tells the model what it means for driving.
   * @param model Model
   * @param holder of control: "you", a name, or ""
   */
  show(model, holder) {
    const id = model.selected?.id;
    const seat = (this.#seat = this.#class?.seats.find(({ robot }) => robot === id) ?? null);
    model.program = Boolean(seat?.program);
    model.denial = this.isStudent ? seat?.refusal ?? "" : "";
    document.body.classList.toggle("denied", model.denial !== "");
    this.#showNews(holder);
    if (seat) this.#showSeat(seat);
  }

  #showSeat(seat) {
    put(this.#url, seat.url);
    put(this.#example, exampleOf(seat.url));
    put(this.#program, seat.program ? `A program drives the robot, from ${seat.program}.` : "No program is connected.");
    this.#showRecording(seat.recording);
    const runs = this.#class.handed_in.filter(({ robot }) => robot === seat.robot);
    putItems(this.#runs, JSON.stringify(runs), () => runs.map(({ file, seconds }) => make("li", {}, `✓ Handed in: ${file}, ${duration(seconds)}`)));
  }

  /** Shows the banner: the reason why this page cannot drive. */
  #showNews(holder) {
    const [words, kind] = this.#seat ? this.#news(holder) : ["", ""];
    put(byId("class-news"), words);
    set(byId("class-news"), "data-kind", kind);
    const recording = this.#seat?.recording;
    put(byId("recording"), recording?.seconds === null ? stateOf(recording) : "");
  }

  #news(holder) {
    const { paused, program, refusal } = this.#seat;
    const kind = paused ? "paused" : program ? "program" : "teacher";
    if (this.isStudent) {
      const words = refusal || (holder && holder !== "you" ? "the teacher drives your robot" : "");
      return [words && sentence(words), kind];
    }
    if (paused) return [this.#class.paused ? "You have paused all robots." : "You have paused this robot.", kind];
    return [program ? "A program drives this robot: take over to drive from here." : "", kind];
  }

  #showRecording(recording) {
    const goesOn = recording !== null && recording.seconds === null;
    put(this.#state, stateOf(recording));
    this.#state.classList.toggle("goes-on", goesOn);
    const { begin, end, hand_in: handIn, discard } = this.#steps;
    begin.hidden = recording !== null;
    end.hidden = !goesOn;
    handIn.hidden = discard.hidden = recording === null;
  }

  #record(step) {
    if (!this.#send({ type: "record_run", step, robot: this.#seat?.robot })) this.#notify("Not connected: nothing was changed.");
  }

  #askToLeave() {
    const yes = makeButton("Yes, leave", { class: "choice", id: "leave-yes" }, () => this.#depart());
    const no = makeButton("Stay", { class: "choice", id: "leave-no" }, () => row.remove());
    const row = make("div", { class: "row", role: "group", "aria-label": "Leave the class?" }, yes, no);
    this.#leave.querySelector(".row")?.remove();
    this.#leave.append(row);
    no.focus();
  }

  async #depart() {
    try {
      await ask("DELETE", "me");
      location.replace("/join");
    } catch (error) {
      this.#notify(error.message);
    }
  }
}


function stateOf(recording) {
  if (recording === null) return "Nothing is recorded now.";
  if (recording.seconds === null) return `● Recording, ${duration(Date.now() / 1000 - recording.began)}`;
  const why = recording.ended ? ` It ended: ${recording.ended}.` : "";
  return `A run of ${duration(recording.seconds)} is recorded, and not handed in.${why}`;
}
