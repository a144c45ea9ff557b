// The sheet beside the map, or below it on a phone, with its views; and the card of the running mode.

import { byId, isTyping, put, set } from "../dom.js";
import { GroupView } from "./group.js";
import { History } from "./history.js";
import { Logs } from "./logs.js";
import { ModeCard, ModesView } from "./modes.js";
import { Plots } from "./plots.js";
import { RobotView } from "./robot_view.js";

const VIEWS = { robot: "Robot", plots: "Plots", modes: "Modes", camera: "Camera", program: "Program", robots: "All robots", help: "Help" };
const OF_ONE = ["robot", "plots", "modes", "camera", "program"]; // the button beside a phone's numbers opens the last of them

export class Panels {
  #send;
  #model;
  #group;
  #histories = new Map();
  #selected = null;
  #startedBy = "";
  #sheet;
  #view;
  #plots;
  #modes;
  #card;
  #camera = null;
  #now;

  /**
   * @param send   function(message): returns whether it was sent to the selected robot
   * @param sendToAll function(message): returns whether it was sent, as it is
   * @param lead   function(id): selects a robot
   * @param notify function(text)
   * @param tell   function(text): like `notify`, for news that may follow from a message of the server
   * @param opened function(view or null), after the sheet has changed
   * @param now    function(): the time of what is shown [s since 1970]
   */
  constructor({ model, send, sendToAll, lead, notify, tell, opened, now }) {
    this.#now = now;
    this.#send = send;
    this.#model = model;
    // a mode that somebody else started is ended by a stop, which everybody may send
    const end = () => send({ type: this.#startedBy === "you" ? "end_mode" : "stop" }) || notify("Not connected: press the stop button on the robot.");
    const motors = (on) => send({ type: "motors", on });
    this.#view = new RobotView(byId("view-robot"), { requestConfig: () => send({ type: "ask_config" }) });
    this.#plots = new Plots(byId("view-plots"), now, new Logs(notify).element);
    this.#group = new GroupView({ send: sendToAll, notify, seconds: () => this.#modes.seconds, lead });
    this.#modes = new ModesView(byId("view-modes"), { send, notify, end, motors, group: this.#group.element });
    this.#card = new ModeCard({ end, tell });
    this.#sheet = new Sheet((view) => (this.subscribe(), opened(view)));
  }

  get view() {
    return this.#sheet.view;
  }

  /** Says which view the button beside a phone's numbers opens first. */
  prefer(view) {
    this.#sheet.last = view;
  }

  /** Opens a view; null closes the sheet. */
  open(view) {
    this.#sheet.open(view);
  }

  /** @param robot the Robot that is selected, or null */
  select(robot) {
    const changed = robot?.id !== this.#selected?.id;
    this.#selected = robot;
    for (const button of document.querySelectorAll('[data-view="camera"]')) button.hidden = !robot?.hello.camera;
    if (this.view === "camera" && !robot?.hello.camera) this.open(null);
    if (!changed) return;
    this.#view.clear();
    this.#card.forget();
    this.#plots.adopt(this.#history(robot?.id), robot?.name ?? "");
    this.subscribe();
  }

  /** Records a snapshot of any Robot. */
  record(snapshot, robot) {
    if (robot) this.#history(robot.id).add(snapshot, robot.shape ?? undefined, this.#now());
  }

  /** Forgets what was recorded. */
  forget() {
    this.#histories.clear();
    this.#plots.adopt(this.#history(this.#selected?.id), this.#selected?.name ?? "");
  }

  /** Shows the newest snapshot of the robot that is selected. */
  show(snapshot, { usable, startedBy, going, roundTrip }) {
    this.#startedBy = startedBy;
    this.#card.show(snapshot, startedBy, going);
    if (this.view === "modes") this.#group.show(this.#model, usable);
    if (this.view === "modes") this.#modes.show(snapshot, usable, startedBy, this.#selected);
    if (this.view !== "robot") return;
    this.#view.showSnapshot(snapshot, roundTrip);
    this.#view.showBattery(this.#history(this.#selected?.id).battery);
  }

  receive(message) {
    if (message.robot !== this.#selected?.id) return;
    if (message.type === "details") this.#view.showDetails(message, this.#selected.hello.url);
    else if (message.type === "config") this.#view.showConfig(message);
  }

  /** Tells the server whether the details are shown, also after a new connection. */
  subscribe() {
    this.#plots.setOpen(this.view === "plots");
    this.#look();
    this.#send({ type: "watch_details", on: this.view === "robot" });
  }

  /** Shows the camera's pictures while its view is open; the module comes with the first time. */
  async #look() {
    if (this.view === "camera") {
      this.#camera ??= import("./camera.js").then(
        ({ CameraView }) => new CameraView(byId("view-camera")),
        (error) => {
          this.#camera = null; // it is asked for again when the view is opened again
          throw error;
        },
      );
    }
    (await this.#camera)?.show(this.view === "camera" ? this.#selected.id : null);
  }

  #history(number) {
    if (!this.#histories.has(number)) this.#histories.set(number, new History());
    return this.#histories.get(number);
  }
}

/** Shows one view at a time. */
class Sheet {
  #changed;
  /** The view that the button beside a phone's numbers opens. */
  last = "robot";
  /** The view that is open, or null. */
  view = null;

  /** @param changed function(view or null), after another one is shown */
  constructor(changed) {
    this.#changed = changed;
    for (const button of document.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => {
        const { view } = button.dataset;
        this.open(view === this.view && !button.closest("#sheet") ? null : view);
      });
    }
    byId("details").addEventListener("click", () => this.open(this.view ? null : this.last));
    byId("sheet-close").addEventListener("click", () => this.open(null));
    addEventListener("keydown", (event) => this.#key(event));
  }

  /** Shows a view; null closes the sheet, and returns the focus to the button that opened it. */
  open(view) {
    if (view === this.view) return;
    const inside = byId("sheet").contains(document.activeElement);
    const closed = this.view;
    this.view = view;
    if (OF_ONE.includes(view)) this.last = view;
    document.body.classList.toggle("sheet-open", view !== null);
    byId("sheet").hidden = view === null;
    put(byId("sheet-title"), VIEWS[view] ?? "");
    set(byId("sheet"), "aria-label", VIEWS[view] ?? "");
    byId("sheet").classList.toggle("of-one", OF_ONE.includes(view));
    set(byId("details"), "aria-expanded", String(view !== null));
    for (const name of Object.keys(VIEWS)) byId(`view-${name}`).hidden = name !== view;
    for (const button of document.querySelectorAll("[data-view]")) {
      set(button, "aria-pressed", String(button.dataset.view === view));
    }
    byId("sheet-body").scrollTop = 0;
    this.#changed(view);
    if (view === null && inside) this.#returnFocus(closed);
  }

  #key(event) {
    if (event.key === "Escape" && this.view) this.open(null);
    else if (event.key === "?" && !isTyping(event)) this.open(this.view === "help" ? null : "help");
  }

  #returnFocus(closed) {
    const openers = [document.querySelector(`.bar [data-view="${closed}"]`), byId("details")];
    openers.find((button) => button?.offsetParent)?.focus();
  }
}
