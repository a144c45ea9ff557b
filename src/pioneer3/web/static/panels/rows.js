// Lists of names and values, made once and filled again and again.

import { make, put, set } from "./dom.js";

export class Rows {
  element = make("dl", { class: "rows" });
  #values = new Map();

  /** @param names in order, each {id, name} */
  constructor(names) {
    for (const [id, name] of Object.entries(names)) {
      const value = make("dd", {}, "–");
      this.#values.set(id, value);
      this.element.append(make("dt", {}, name), value);
    }
  }

  /** @param level "bad", "warn" or nothing: never the only sign */
  show(id, text, level = null) {
    put(this.#values.get(id), text);
    set(this.#values.get(id), "data-level", level);
  }
}

/** A titled part of a view. */
export function part(title, ...children) {
  return make("section", { class: "part" }, make("h3", {}, title), ...children);
}
