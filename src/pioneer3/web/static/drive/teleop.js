// Driving by hand, with any input: press, release, stop. A press does not drive while the model has a refusal,
// and the robot stops when the page may no longer notice a release.

export class Teleop {
  #drive;
  #model;
  #stops;
  #connection;
  #notify;
  #changed;

  /**
   * @param drive   Drive, which has the held inputs
   * @param stops   StopQueue, which sends stops until they have arrived
   * @param notify  function(text)
   * @param changed function(), after a stop
   */
  constructor({ drive, model, stops, connection, notify, changed }) {
    this.#drive = drive;
    this.#model = model;
    this.#stops = stops;
    this.#connection = connection;
    this.#notify = notify;
    this.#changed = changed;
  }

  /** An input is pressed; returns whether it is held now. */
  press = (source, input, command) => {
    if (this.#model.refusal === null) return this.#drive.press(source, input, command);
    this.#notify(this.#model.refusal);
    return false;
  };

  move = (input, command) => this.#drive.move(input, command);
  release = (input) => this.#drive.release(input);
  releaseAll = () => this.#drive.releaseAll();
  notify = (text) => this.#notify(text);

  /**
   * The page may not notice a release any more: stops the robot. It leaves alone a robot that somebody else
   * drives, and a mode that was started here, which runs while this page is connected.
   * @param why in words, or nothing where the user knows
   */
  abandon = (why) => {
    const drive = this.#drive;
    if (!drive.active && (this.#model.driver !== "you" || this.#model.snapshot.mode)) return;
    if (drive.holding && why) this.#notify(`Let go: ${why}.`);
    drive.stop();
  };

  /** Stops the chosen robots, whoever drives them, and all others that the user drives; their modes end. */
  stop = () => {
    const { selected, chosen, mine } = this.#model;
    const robots = new Set([selected, ...chosen, ...mine]);
    this.#stop(...[...robots].map((robot) => ({ type: "stop", robot: robot?.id })));
  };

  /** Stops all robots: in danger nobody should have to select one first. */
  emergencyStop = () => this.#stop({ type: "emergency_stop" });

  /** Resets the selected robot. */
  reset = () => this.#reset([this.#model.selected]);

  /** Resets every robot that is latched. */
  resetAll = () => this.#reset([...this.#model.robots.values()].filter((robot) => robot.snapshot?.emergency_stop));

  #stop(...messages) {
    if (this.#model.replayed) return this.#notify(this.#model.refusal);
    this.#drive.forget();
    for (const message of messages) this.#stops.add(message);
    this.#connection.retryNow();
    this.#changed();
  }

  #reset(robots) {
    for (const robot of robots) this.#connection.send({ type: "reset_emergency_stop", robot: robot?.id });
  }
}

/** Events after which the page may not notice that the user lets go. Each must stop the robot. */
const EVENTS = {
  blur: "the window lost the focus",
  pagehide: "the page was left",
  orientationchange: "the screen turned",
  touchcancel: "the touch was taken away",
  offline: "this device has no network",
};

/** Calls `abandon` with the reason whenever the page may no longer notice that the user lets go. */
export function watchForLoss(abandon) {
  for (const [name, why] of Object.entries(EVENTS)) addEventListener(name, () => abandon(why));
  addEventListener("pointercancel", ({ target }) => {
    // the browser also cancels a second finger that scrolls elsewhere, and that holds nothing
    if (!(target instanceof Element) || target.closest(".pad")) abandon("the touch was taken away");
  });
  document.addEventListener("visibilitychange", () => document.hidden && abandon("the page was hidden"));
  document.addEventListener("freeze", () => abandon("the page was put to sleep"));
  screen.orientation?.addEventListener?.("change", () => abandon("the screen turned"));
  addEventListener("contextmenu", (event) => {
    event.preventDefault();
    abandon("a menu opened");
  });
}
