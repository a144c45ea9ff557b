// The sheet with its views, and the card of the mode that runs: joined with the page here.

import { History } from "./history.js";
import { ModeCard } from "./mode_card.js";
import { ModesView } from "./modes_view.js";
import { Plots } from "./plots.js";
import { RobotView } from "./robot_view.js";
import { Sheet } from "./sheet.js";

const byId = (id) => document.getElementById(id);

export class Panels {
  #send;
  #histories = new Map();
  #selected = null;
  #starter = "";
  #sheet;
  #view;
  #plots;
  #modes;
  #card;

  /**
   * @param send     function(message): says whether it was sent
   * @param complain function(text)
   * @param remark   function(text): tells of what has happened
   * @param opened   function(view or null), after the sheet has changed
   */
  constructor({ send, complain, remark, opened }) {
    this.#send = send;
    // who did not start it may end it by a stop, as everybody may
    const end = () => send({ type: this.#starter === "you" ? "end_mode" : "stop" }) || complain("Not connected: press the stop button on the robot.");
    const motors = (on) => send({ type: "motors", on });
    this.#view = new RobotView(byId("view-robot"), { askConfig: () => send({ type: "ask_config" }) });
    this.#plots = new Plots(byId("view-plots"));
    this.#modes = new ModesView(byId("view-modes"), { send, complain, end, motors });
    this.#card = new ModeCard({ end, tell: remark });
    this.#sheet = new Sheet((view) => (this.#attend(), opened(view)));
  }

  get view() {
    return this.#sheet.view;
  }

  /** Opens a view; null closes the sheet. */
  open(view) {
    this.#sheet.open(view);
  }

  /** Tells the server again what is open: the connection is new. */
  attend() {
    this.#attend();
  }

  /** @param robot the Robot that is selected, or null */
  select(robot) {
    const changed = robot?.id !== this.#selected?.id;
    this.#selected = robot;
    if (!changed) return;
    this.#view.clear();
    this.#card.forget();
    this.#plots.adopt(this.#history(robot?.id), robot?.name ?? "");
    this.#attend();
  }

  /** Notes a snapshot of any Robot. */
  note(snapshot, robot) {
    if (robot) this.#history(robot.id).add(snapshot, robot.shape ?? undefined, Date.now() / 1000);
  }

  /** Shows the newest snapshot of the robot that is selected. */
  show(snapshot, { usable, starter, going, roundTrip }) {
    this.#starter = starter;
    this.#card.show(snapshot, starter, going);
    if (this.view === "modes") this.#modes.show(snapshot, usable, starter);
    if (this.view !== "robot") return;
    this.#view.showSnapshot(snapshot, roundTrip);
    this.#view.showBattery(this.#history(this.#selected?.id).battery);
  }

  receive(message) {
    if (message.robot !== this.#selected?.id) return;
    if (message.type === "details") this.#view.showDetails(message);
    else if (message.type === "config") this.#view.showConfig(message);
  }

  #attend() {
    this.#plots.setOpen(this.view === "plots");
    this.#send({ type: "watch_details", on: this.view === "robot" });
  }

  #history(number) {
    if (!this.#histories.has(number)) this.#histories.set(number, new History());
    return this.#histories.get(number);
  }
}
