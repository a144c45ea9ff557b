// The logs of this computer's user: the last minutes are saved with a note, others replayed and downloaded.

import { make, makeButton, number, put } from "../dom.js";
import { ask } from "../http.js";

const NOTE = 200; // letters

export class Logs {
  element;
  #list = make("ul", { class: "lines-of-text logs-list", "aria-label": "Logs, the newest first" });
  #none = make("p", { class: "words", role: "status" }, "");
  #note = make("input", { id: "log-note", type: "text", class: "small", maxlength: NOTE, placeholder: "Why", "aria-label": "A note to what is saved" });
  #save = makeButton("Save the last five minutes", { class: "choice", id: "log-save" }, () => this.#keep());
  #notify;

  /** @param notify function(text) */
  constructor(notify) {
    this.#notify = notify;
    this.element = make("details", { class: "part for-drivers logs", id: "logs" },
      make("summary", {}, "Logs: save, replay, download"),
      make("div", { class: "row" }, this.#note, this.#save),
      make("p", { class: "words" }, "What is saved stays until you remove it. A replay opens beside this page; nothing in it can be driven."),
      this.#none, this.#list);
    this.element.addEventListener("toggle", () => this.element.open && this.#show());
  }

  async #show() {
    try {
      const logs = await ask("GET", "logs");
      put(this.#none, logs.length ? "" : "There are no logs yet.");
      this.#list.replaceChildren(...logs.map(row));
    } catch ({ message }) {
      put(this.#none, message);
    }
  }

  async #keep() {
    this.#save.disabled = true;
    try {
      const { file } = await ask("POST", "logs", { note: this.#note.value.trim() });
      this.#note.value = "";
      this.#notify(`Saved as ${file}.`);
      await this.#show();
    } catch ({ message }) {
      this.#notify(message);
    }
    this.#save.disabled = false;
  }
}

function row({ file, more, began, seconds, size, robot, end, note, pinned, goes_on: goesOn }) {
  const name = file.replace(/\.mcap$/, "");
  const when = new Date(began * 1000).toLocaleString("en-GB", { dateStyle: "short", timeStyle: "short" });
  const facts = [robot, duration(seconds), inWords(size), end, ...(pinned ? ["kept"] : [])].filter(Boolean).join(", ");
  const path = encodeURIComponent(file);
  const replay = make("a", { class: "choice", href: `/?replay=${path}`, target: "_blank", "aria-label": `Replay ${name}` }, "Replay");
  const files = goesOn ? [file, ...more].slice(0, -1) : [file, ...more];
  const downloads = files.map((each, at) => make("a", { class: "choice", href: `/api/logs/${encodeURIComponent(each)}`, download: each, "aria-label": `Download ${each.replace(/\.mcap$/, "")}` }, files.length > 1 ? `Download ${at + 1}` : "Download"));
  return make("li", {}, make("b", {}, note || name.replace(/^[^Z]*Z-/, "")), make("span", {}, `${when}: ${facts}`), make("span", { class: "row" }, replay, ...downloads));
}

function duration(seconds) {
  const minutes = Math.floor(seconds / 60);
  return minutes < 60 ? `${minutes}:${String(Math.floor(seconds % 60)).padStart(2, "0")} min` : `${number(minutes / 60, 1)} h`;
}

const inWords = (bytes) => (bytes < 1e6 ? `${number(bytes / 1e3, 0)} kB` : `${number(bytes / 1e6, 1)} MB`);
