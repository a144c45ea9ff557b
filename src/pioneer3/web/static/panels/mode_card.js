// On the map, while a mode runs: what it is, where it goes, what decides, and the way to end it.

import { make, put } from "./dom.js";
import { howItEnded, named } from "./modes_view.js";

const byId = (id) => document.getElementById(id);
const GOING = { goto: "Looks for the way", follow: "Looks for somebody to follow" }; // while there is no target

export class ModeCard {
  #tell;
  #mode = null;

  /**
   * @param end  function(): ends the mode
   * @param tell function(text): shows news
   */
  constructor({ end, tell }) {
    this.#tell = tell;
    byId("card-end").addEventListener("click", end);
  }

  /** @param starter "you" or a name; @param going where it goes, in words, or "" */
  show({ mode, decided, ended, emergency_stop: latched }, starter, going) {
    byId("mode-card").hidden = mode === null;
    if (mode !== null) {
      put(byId("card-title"), `${named(mode)}${starter ? `, started by ${starter}` : ""}`);
      put(byId("card-end"), `End ${mode}`);
      byId("card-going").hidden = !(mode in GOING);
      put(byId("card-going"), going || GOING[mode] || "");
    }
    this.#list(mode === null ? [] : decided);
    const news = this.#mode !== null && mode === null && ended && !latched; // else the banner says why
    if (news) this.#tell(howItEnded(ended));
    this.#mode = mode;
  }

  /** Another robot is shown: what its mode did before is no news. */
  forget() {
    this.#mode = null;
  }

  #list(lines) {
    const list = byId("decided");
    const key = lines.join("\n");
    if (list.dataset.key === key) return;
    list.dataset.key = key;
    list.replaceChildren(...lines.map((line) => make("li", { title: line }, line)));
  }
}
