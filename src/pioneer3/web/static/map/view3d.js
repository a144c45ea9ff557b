// The switch between the flat map and the three-dimensional view, whose modules come only when it is opened.

import { byId, recall, remember } from "../dom.js";

const KEY = "pioneer3.view";

export class View3d {
  #scene;
  #options;
  #notify;
  #opening = false;

  /** @param options of Scene3d, but `invalidate` and `lost`; changed function(), after the view has changed */
  constructor({ scene, notify, changed, ...options }) {
    Object.assign(this, { changed });
    this.#scene = scene;
    this.#notify = notify;
    this.#options = options;
    byId("in-3d").addEventListener("click", () => (this.open ? this.close() : this.#open()));
    if (recall(KEY) === "3d") this.#open();
  }

  get open() {
    return this.#scene.solid !== null;
  }

  close() {
    remember(KEY, "2d");
    this.#opening = false;
    this.#show(null);
  }

  async #open() {
    if (this.#opening) return;
    remember(KEY, "3d");
    this.#opening = true;
    try {
      if (!document.createElement("canvas").getContext("webgl2")) throw new Error("This browser has no WebGL 2, which the 3-D view needs.");
      const { Scene3d } = await import("../view3d/scene3d.js");
      if (!this.#opening) return; // closed meanwhile
      const lost = () => this.open && (this.close(), this.#notify("The 3-D view has ended: the graphics system took its memory."));
      this.#show(new Scene3d({ ...this.#options, invalidate: () => this.#scene.invalidate(), lost }));
    } catch (error) {
      remember(KEY, "2d");
      this.#notify(error instanceof TypeError ? "The 3-D view could not be loaded." : error.message);
    }
    this.#opening = false;
  }

  #show(solid) {
    const before = this.#scene.solid;
    this.#scene.solid = solid;
    before?.dispose();
    byId("canvas").hidden = solid !== null;
    document.body.classList.toggle("solid", solid !== null);
    byId("in-3d").setAttribute("aria-pressed", String(solid !== null));
    this.changed();
  }
}
