// On the map, while a mode runs: what it is, what decides, and the way to end it.

import { make, put } from "./dom.js";
import { howItEnded } from "./modes_view.js";

const byId = (id) => document.getElementById(id);

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

  show({ mode, decided, ended }, starter) {
    byId("mode-card").hidden = mode === null;
    if (mode !== null) {
      put(byId("card-title"), `${mode[0].toUpperCase()}${mode.slice(1)}${starter ? `, started by ${starter}` : ""}`);
      put(byId("card-end"), `${starter === "you" ? "End" : "Stop"} ${mode}`);
    }
    this.#list(mode === null ? [] : decided);
    if (this.#mode !== null && mode === null && ended) this.#tell(howItEnded(ended));
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
    list.replaceChildren(...lines.map((line) => make("li", {}, line)));
  }
}
