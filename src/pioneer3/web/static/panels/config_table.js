// CONFIG, asked for when somebody opens it: every field by name, with its unit and what it means.

import { make, put } from "./dom.js";

const NOT_SENT = "not sent";

export class ConfigTable {
  element;
  #note = make("p", { class: "words", role: "status" });
  #body = make("div", { class: "config" });
  #again = make("button", { type: "button", class: "choice", id: "config-again" }, "Ask again");
  #ask;

  /** @param ask function() */
  constructor(ask) {
    this.#ask = ask;
    const summary = make("summary", { id: "config-open" }, "Configuration (CONFIG)");
    this.element = make("details", { class: "part", id: "config" }, summary, this.#note, this.#body, this.#again);
    this.element.addEventListener("toggle", () => this.element.open && this.#request());
    this.#again.addEventListener("click", () => this.#request());
  }

  clear() {
    this.element.open = false;
    this.#body.replaceChildren();
    put(this.#note, "");
  }

  show({ rows, error }) {
    const missing = rows.length ? error : error ?? "The robot did not send its configuration.";
    put(this.#note, missing ? `${missing}${rows.length ? " These are the values of before." : ""}` : `${rows.length} fields.`);
    const groups = grouped(rows);
    this.#body.replaceChildren(...[...groups].map(([group, members]) => table(group, members)));
  }

  #request() {
    put(this.#note, "Asking the robot …");
    if (!this.#ask()) put(this.#note, "Not connected to the driver.");
  }
}

function grouped(rows) {
  const groups = new Map();
  for (const row of rows) groups.set(row.group, [...(groups.get(row.group) ?? []), row]);
  return groups;
}

function table(group, rows) {
  const head = ["Field", "Value", "Meaning"].map((title) => make("th", { scope: "col" }, title));
  const lines = rows.map(({ field, value, unit, meaning }) => make("tr", value === NOT_SENT ? { class: "absent" } : {},
    make("th", { scope: "row" }, field), make("td", {}, `${value} ${unit}`.trim()), make("td", {}, meaning)));
  return make("table", {}, make("caption", {}, group), make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...lines));
}
