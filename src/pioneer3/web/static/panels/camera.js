// The view of a robot's camera. It asks for one picture after the other, so that a slow network shows fewer, and none
// that is old; while it is not seen, it asks for none. Loaded when it is opened.

import { make, put } from "../dom.js";

const RETRY = 2000; // ms after a failure
const WINDOW = 2000; // ms in which pictures are counted

export class CameraView {
  #picture = make("canvas", { class: "camera-picture", role: "img", "aria-label": "What the camera sees", hidden: "" });
  #words = make("p", { class: "words", role: "status" });
  #robot = null;
  #asking = null; // AbortController
  #times = [];

  constructor(container) {
    container.append(this.#picture, this.#words);
    document.addEventListener("visibilitychange", () => this.#restart());
  }

  /** @param robot number of the robot, or null for none */
  show(robot) {
    if (robot === this.#robot) return;
    this.#robot = robot;
    this.#picture.hidden = true;
    this.#restart();
  }

  #restart() {
    this.#asking?.abort();
    this.#asking = null;
    if (this.#robot === null || document.hidden) return;
    this.#asking = new AbortController();
    this.#times = [];
    this.#say("Waiting for the first picture …");
    this.#ask(this.#robot, this.#asking.signal);
  }

  async #ask(robot, signal) {
    while (!signal.aborted) {
      try {
        const response = await fetch(`/api/robots/${robot}/camera/image`, { signal });
        if (!response.ok) throw new Error((await response.json()).detail);
        const picture = await createImageBitmap(await response.blob());
        if (!signal.aborted) this.#draw(picture);
        picture.close();
      } catch (error) {
        if (signal.aborted) return;
        this.#picture.classList.add("old");
        this.#say(error instanceof TypeError ? "Not connected to the driver." : error.message);
        await new Promise((resume) => setTimeout(resume, RETRY));
      }
    }
  }

  #draw(picture) {
    const { width, height } = picture;
    if (this.#picture.width !== width || this.#picture.height !== height) Object.assign(this.#picture, { width, height });
    this.#picture.getContext("2d").drawImage(picture, 0, 0);
    this.#picture.hidden = false;
    this.#picture.classList.remove("old");
    const now = performance.now();
    this.#times = [...this.#times.filter((time) => now - time < WINDOW), now];
    const [first] = this.#times;
    const rate = now > first ? ((this.#times.length - 1) * 1000) / (now - first) : 0;
    this.#say(`${width} × ${height} pixels${rate ? `, ${Math.round(rate)} a second` : ""}`);
  }

  #say(words) {
    put(this.#words, words);
  }
}
