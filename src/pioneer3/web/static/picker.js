// Which of several robots is driven, stopped and shown: a row of them in the top bar, and a list of
// all that can be searched. With one robot there is nothing to pick.

import { make, number, put, set } from "./panels/dom.js";
import { stateOf } from "./state.js";

const SVG = "http://www.w3.org/2000/svg";
const LEAST = 94; // px, of a robot in the row
const GAP = 6;

export class Picker {
  #box = document.getElementById("robots");
  #all = document.getElementById("robots-all");
  #row = document.getElementById("robots-row");
  #search = make("input", { type: "search", id: "robots-search", class: "small", placeholder: "Name, state or driver", "aria-label": "Find a robot" });
  #count = make("p", { class: "words", role: "status" });
  #list = make("ul", { class: "robot-list", "aria-label": "All robots" });
  #model;
  #select;
  #open;
  #first = 0; // of those in the row
  #room = 1; // robots
  #listed = false;
  #inRow = new Map(); // id -> button of the row
  #inList = new Map(); // id -> button of the list

  /**
   * @param model
   * @param select function(id): the user wants this robot
   * @param open   function(): opens the list
   */
  constructor({ model, select, open }) {
    this.#model = model;
    this.#select = select;
    this.#open = open;
    document.getElementById("view-robots").append(make("div", { class: "robot-search" }, this.#search, this.#count), this.#list);
    this.#search.addEventListener("input", () => this.show());
    this.#search.addEventListener("keydown", (event) => this.#inSearch(event));
    new ResizeObserver(([{ contentRect }]) => {
      this.#room = Math.max(1, Math.floor((contentRect.width + GAP) / (LEAST + GAP)));
      this.show();
    }).observe(this.#row);
    addEventListener("keydown", (event) => this.#key(event));
  }

  /** Shows the robots as they are now. */
  show() {
    const { robots, several } = this.#model;
    this.#box.hidden = !several;
    document.body.classList.toggle("several", several);
    if (!several) return;
    if ([...robots.keys()].join() !== [...this.#inRow.keys()].join()) this.#build([...robots.keys()]);
    put(this.#all, `All ${robots.size}`);
    set(this.#all, "aria-label", `All ${robots.size} robots`);
    for (const robot of robots.values()) this.#show(robot);
    this.#fit();
    if (this.#listed) this.#filter();
  }

  /** The list has been opened, or closed. */
  listed(open) {
    const opened = open && !this.#listed;
    this.#listed = open;
    if (!opened) return;
    this.show();
    if (!matchMedia("(pointer: coarse)").matches) this.#search.focus(); // a phone's keyboard would cover half of it
  }

  #build(ids) {
    const select = (id) => this.#select(id);
    this.#inRow = new Map(ids.map((id) => [id, new Entry("robot", () => select(id))]));
    this.#inList = new Map(ids.map((id) => [id, new Entry("robot in-list", () => select(id))]));
    this.#row.replaceChildren(...[...this.#inRow.values()].map(({ button }) => button));
    this.#list.replaceChildren(...[...this.#inList.values()].map(({ button }) => make("li", {}, button)));
  }

  #show(robot) {
    const state = stateOf(robot, this.#model);
    const chosen = robot === this.#model.selected;
    this.#inRow.get(robot.id).show(robot.name, state, state.text, chosen);
    if (!this.#listed) return;
    const entry = this.#inList.get(robot.id);
    entry.show(robot.name, state, [state.text, this.#driverOf(robot, state)].filter(Boolean).join(", "), chosen);
    put(entry.power, powerOf(robot));
  }

  /** Who has its wheel, where the state does not say so. */
  #driverOf(robot, { text }) {
    const holder = this.#model.holderOf(robot);
    if (!holder || text.endsWith("drive") || text.endsWith("drives")) return "";
    return holder.id === this.#model.guest ? "you have the wheel" : `${holder.name} has the wheel`;
  }

  /** Shows so many in the row as fit, the selected one among them. */
  #fit() {
    const entries = [...this.#inRow.values()];
    const room = this.#room;
    const at = [...this.#model.robots.values()].indexOf(this.#model.selected);
    this.#first = Math.max(0, Math.min(this.#first, at, entries.length - room));
    if (at >= this.#first + room) this.#first = at - room + 1;
    entries.forEach(({ button }, i) => (button.hidden = i < this.#first || i >= this.#first + room));
  }

  #filter() {
    const words = this.#search.value.trim().toLowerCase().split(/\s+/);
    let found = 0;
    for (const { button } of this.#inList.values()) {
      const text = button.textContent.toLowerCase();
      const here = words.every((word) => text.includes(word));
      button.parentElement.hidden = !here;
      found += Number(here);
    }
    const all = this.#inList.size;
    put(this.#count, found === all ? `${all} robots` : found ? `${found} of ${all} robots` : "No robot is like that.");
  }

  #inSearch(event) {
    if (event.key === "Escape" && this.#search.value !== "") event.stopPropagation(); // it empties the field
    const first = [...this.#list.children].find((row) => !row.hidden)?.firstElementChild;
    if (event.key !== "Enter" || !first) return;
    first.click();
    first.focus(); // where arrows drive and space stops
  }

  /** 1 to 9 are the first nine, Page Up and Down the neighbours, / opens the list. */
  #key(event) {
    if (!this.#model.several || event.ctrlKey || event.altKey || event.metaKey || isTyping(event.target)) return;
    const ids = [...this.#model.robots.keys()];
    const step = { PageUp: -1, PageDown: 1 }[event.key];
    const at = step ? ids.indexOf(this.#model.selected.id) + step : Number(event.key) - 1;
    if (event.key !== "/" && !(at in ids)) return;
    event.preventDefault();
    if (event.key === "/") this.#open();
    else this.#select(ids[at]);
  }
}

/** A button for one robot: a picture, its name and how it is. */
class Entry {
  power = make("span", { class: "power-of" });
  #path = document.createElementNS(SVG, "path");
  #name = make("strong");
  #state = make("small");

  constructor(className, act) {
    const icon = document.createElementNS(SVG, "svg");
    icon.setAttribute("viewBox", "0 0 24 24");
    icon.setAttribute("aria-hidden", "true");
    icon.append(this.#path);
    this.button = make("button", { type: "button", class: className }, icon, this.#name, " ", this.#state, " ", this.power);
    this.button.addEventListener("click", act);
  }

  show(name, { level, icon }, words, chosen) {
    put(this.#name, name);
    put(this.#state, words);
    set(this.#path, "d", icon);
    set(this.button, "data-level", level);
    set(this.button, "title", `${name}: ${words}`);
    set(this.button, "aria-pressed", String(chosen));
  }
}

function powerOf({ snapshot }) {
  if (!snapshot) return "–";
  const { voltage, charge } = snapshot.battery;
  return `${number(voltage, 1)} V${charge === null ? "" : `, ${number(charge * 100, 0)} %`}`;
}

function isTyping(target) {
  return target instanceof Element && target.matches("input, textarea, select, [contenteditable]");
}
