// Edit mode: whether it is on, and whether it edits the simulated world or the map.

import { byId, hasModifier, isTyping, set } from "../dom.js";

export class EditMode {
  open = false;
  #editors; // {world, map}
  #possible = { world: false, map: false };
  #what = "world";
  #toggled;

  /**
   * @param world, map the editors: setActive(active)
   * @param toggled    function(), after edit mode has begun, ended or changed
   */
  constructor({ world, map, toggled }) {
    this.#editors = { world, map };
    this.#toggled = toggled;
    byId("edit").addEventListener("click", () => this.set(!this.open));
    for (const what of ["world", "map"]) byId(`edit-${what}`).addEventListener("click", () => this.#choose(what));
    addEventListener("keydown", (event) => {
      if (event.key.toLowerCase() !== "e" || hasModifier(event) || isTyping(event) || byId("edit").hidden) return;
      this.set(!this.open);
    }, { capture: true });
  }

  /** Whether a world or a map is there that can be edited. */
  offer(what, possible) {
    if (this.#possible[what] === possible) return;
    this.#possible[what] = possible;
    const { world, map } = this.#possible;
    byId("edit").hidden = !world && !map;
    byId("edit-what").hidden = !world || !map;
    if (!this.#possible[this.#what]) this.#choose(world ? "world" : "map");
    if (!world && !map) this.set(false);
  }

  set(open) {
    if (open === this.open) return;
    this.open = open;
    document.body.classList.toggle("editing", open);
    byId("editor").hidden = !open;
    set(byId("edit"), "aria-pressed", String(open));
    this.#activate();
  }

  #choose(what) {
    this.#what = what;
    byId("editor").classList.toggle("maps", what === "map");
    for (const each of ["world", "map"]) set(byId(`edit-${each}`), "aria-pressed", String(each === what));
    this.#activate();
  }

  #activate() {
    for (const [what, editor] of Object.entries(this.#editors)) {
      const active = this.open && what === this.#what;
      if (editor.active !== active) editor.setActive(active);
    }
    this.#toggled();
  }
}
