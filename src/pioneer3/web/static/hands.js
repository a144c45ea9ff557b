// What hands do to the robot by any input: press, let go, stop. A press is refused where something is
// in the way, and every doubt about the hands lets go.

export class Hands {
  #drive;
  #model;
  #post;
  #connection;
  #complain;
  #changed;

  /**
   * @param drive      what is held
   * @param post       sends stops until they have arrived
   * @param complain   function(text)
   * @param changed    function(), after a stop
   */
  constructor({ drive, model, post, connection, complain, changed }) {
    this.#drive = drive;
    this.#model = model;
    this.#post = post;
    this.#connection = connection;
    this.#complain = complain;
    this.#changed = changed;
  }

  /** Begins to hold; says whether it does. */
  press = (source, input, wish) => {
    if (this.#model.obstacle === null) return this.#drive.press(source, input, wish);
    this.#complain(this.#model.obstacle);
    return false;
  };

  move = (input, wish) => this.#drive.move(input, wish);
  release = (input) => this.#drive.release(input);
  letGo = () => this.#drive.releaseAll();
  complain = (text) => this.#complain(text);

  /**
   * The user may have lost hold of the page. Leaves a robot alone that somebody else drives, and a
   * mode that was started here: that goes on while this page is there.
   * @param why in words, or nothing where the user knows
   */
  abandon = (why) => {
    const drive = this.#drive;
    if (!drive.active && (this.#model.driver !== "you" || this.#model.snapshot.mode)) return;
    if (drive.holding && why) this.#complain(`Let go: ${why}.`);
    drive.stop();
  };

  /** Stops the selected robot, whoever drives it, and all others that the user drives; their modes end. */
  stop = () => {
    const robots = new Set([this.#model.selected, ...this.#model.mine]);
    this.#stop(...[...robots].map((robot) => ({ type: "stop", robot: robot?.id })));
  };

  /** Stops all robots: who sees danger must not have to pick first. */
  emergencyStop = () => this.#stop({ type: "emergency_stop" });

  /** Resets the selected robot. */
  reset = () => this.#reset([this.#model.selected]);

  /** Resets every robot that is latched. */
  resetAll = () => this.#reset([...this.#model.robots.values()].filter((robot) => robot.snapshot?.emergency_stop));

  #stop(...messages) {
    this.#drive.forget();
    for (const message of messages) this.#post.press(message);
    this.#connection.hurry();
    this.#changed();
  }

  #reset(robots) {
    for (const robot of robots) this.#connection.send({ type: "reset_emergency_stop", robot: robot?.id });
  }
}
