// Selects one of several robots: a row in the top bar, and a list of all robots that can be searched. With one
// robot nothing is shown.

import { byId, hasModifier, isTyping, make, makeButton, makeSvg, number, put, set } from "../dom.js";

const LEAST_WIDTH = 94; // px, of a robot in the row
const GAP = 6;

export class Picker {
  #box = byId("robots");
  #all = byId("robots-all");
  #row = byId("robots-row");
  #search = make("input", { type: "search", id: "robots-search", class: "small", placeholder: "Name, state or driver", "aria-label": "Find a robot" });
  #count = make("p", { class: "words", role: "status" });
  #list = make("ul", { class: "robot-list", "aria-label": "All robots" });
  #several = makeButton("Choose several", { id: "robots-several", class: "choice", "aria-pressed": "false" }, () => this.#setSeveral(!this.#choosing));
  #choosing = false; // a click chooses one more or one less
  #model;
  #select;
  #toggle;
  #open;
  #first = 0; // of those in the row
  #capacity = 1; // of the row, in robots
  #listed = false;
  #inRow = new Map(); // id -> button of the row
  #inList = new Map(); // id -> button of the list

  /**
   * @param model
   * @param select function(id): selects a robot
   * @param toggle function(id): chooses one more, or one less
   * @param chooseAll function(): chooses all
   * @param open   function(): opens the list
   */
  constructor({ model, select, toggle, chooseAll, open }) {
    this.#model = model;
    this.#select = select;
    this.#toggle = toggle;
    this.#open = open;
    const all = makeButton("Choose all", { id: "robots-choose-all", class: "choice" }, () => {
      this.#setSeveral(true);
      chooseAll();
    });
    const row = make("div", { class: "row" }, this.#several, all);
    byId("view-robots").append(row, make("div", { class: "robot-search" }, this.#search, this.#count), this.#list);
    this.#search.addEventListener("input", () => this.show());
    this.#search.addEventListener("keydown", (event) => this.#inSearch(event));
    new ResizeObserver(([{ contentRect }]) => {
      this.#capacity = Math.max(1, Math.floor((contentRect.width + GAP) / (LEAST_WIDTH + GAP)));
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
    const { length } = this.#model.chosen;
    put(this.#all, length > 1 ? `${length} of ${robots.size}` : `All ${robots.size}`);
    set(this.#all, "aria-label", `All ${robots.size} robots`);
    for (const robot of robots.values()) this.#show(robot);
    this.#fit();
    if (this.#listed) this.#filter();
  }

  /** The list has been opened, or closed. */
  setListed(open) {
    const opened = open && !this.#listed;
    this.#listed = open;
    if (!opened) return;
    this.show();
    if (!matchMedia("(pointer: coarse)").matches) this.#search.focus(); // a phone's keyboard would cover half of it
  }

  #build(ids) {
    const choose = (id, event) => this.#choose(id, event);
    this.#inRow = new Map(ids.map((id) => [id, new Entry("robot", (event) => choose(id, event))]));
    this.#inList = new Map(ids.map((id) => [id, new Entry("robot in-list", (event) => choose(id, event))]));
    this.#row.replaceChildren(...[...this.#inRow.values()].map(({ button }) => button));
    this.#list.replaceChildren(...[...this.#inList.values()].map(({ button }) => make("li", {}, button)));
  }

  #choose(id, event) {
    if (this.#choosing || addsRobot(event)) this.#toggle(id);
    else this.#select(id);
  }

  #setSeveral(on) {
    this.#choosing = on;
    set(this.#several, "aria-pressed", String(on));
    if (!on) this.#select(this.#model.selected?.id);
  }

  #show(robot) {
    const { selected, chosen } = this.#model;
    const status = statusOf(robot, this.#model);
    const which = robot === selected ? "selected" : chosen.includes(robot) ? "also" : "";
    this.#inRow.get(robot.id).show(robot.name, status, status.text, which);
    if (!this.#listed) return;
    const entry = this.#inList.get(robot.id);
    entry.show(robot.name, status, [status.text, this.#holderOf(robot, status)].filter(Boolean).join(", "), which);
    put(entry.power, powerOf(robot));
  }

  /** The holder of its control lease, where its status does not name them. */
  #holderOf(robot, { text }) {
    const holder = this.#model.holderOf(robot);
    if (!holder || text.endsWith("drive") || text.endsWith("drives")) return "";
    return holder.id === this.#model.client ? "you have control" : `${holder.name} has control`;
  }

  /** Shows so many in the row as fit, the selected one among them. */
  #fit() {
    const entries = [...this.#inRow.values()];
    const capacity = this.#capacity;
    const at = [...this.#model.robots.values()].indexOf(this.#model.selected);
    this.#first = Math.max(0, Math.min(this.#first, at, entries.length - capacity));
    if (at >= this.#first + capacity) this.#first = at - capacity + 1;
    entries.forEach(({ button }, i) => (button.hidden = i < this.#first || i >= this.#first + capacity));
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

  /** 1 to 9 are the first nine, with Shift one more or one less; Page Up and Down the neighbours, / opens the list. */
  #key(event) {
    if (!this.#model.several || hasModifier(event) || isTyping(event)) return;
    const ids = [...this.#model.robots.keys()];
    const digit = /^Digit([1-9])$/.exec(event.code);
    if (event.shiftKey && digit && ids[digit[1] - 1] !== undefined) {
      event.preventDefault();
      this.#toggle(ids[digit[1] - 1]);
      return;
    }
    const step = { PageUp: -1, PageDown: 1 }[event.key];
    const at = step ? ids.indexOf(this.#model.selected.id) + step : Number(event.key) - 1;
    if (event.key !== "/" && !(at in ids)) return;
    event.preventDefault();
    if (event.key === "/") this.#open();
    else this.#select(ids[at]);
  }
}

/** Whether a click or a tap chooses one more robot, and leaves the others chosen. */
export const addsRobot = ({ shiftKey, ctrlKey, metaKey }) => shiftKey || ctrlKey || metaKey;

/** A button for one robot: an icon, its name and its status. */
class Entry {
  power = make("span", { class: "power-of" });
  #path = makeSvg("path");
  #name = make("strong");
  #status = make("small");

  constructor(className, act) {
    const icon = makeSvg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, this.#path);
    this.button = makeButton("", { class: className }, act);
    this.button.append(icon, this.#name, " ", this.#status, " ", this.power);
  }

  /** @param which "selected", "also" for one that is chosen beside it, or "" */
  show(name, { level, icon }, words, which) {
    put(this.#name, name);
    put(this.#status, words);
    set(this.#path, "d", icon);
    set(this.button, "data-level", level);
    set(this.button, "title", `${name}: ${words}`);
    set(this.button, "aria-pressed", String(which !== ""));
    set(this.button, "data-chosen", which || null);
  }
}

function powerOf({ snapshot }) {
  if (!snapshot) return "–";
  const { voltage, charge } = snapshot.battery;
  return `${number(voltage, 1)} V${charge === null ? "" : `, ${number(charge * 100, 0)} %`}`;
}

/** Returns the status of a robot, the most urgent: {text, level, icon: the path of a 24 by 24 picture}. */
function statusOf(robot, model) {
  const [text, level, icon] = judge(robot, model);
  return { text, level, icon: ICONS[icon] };
}

const ICONS = {
  gone: "M3 3l18 18M8 5a10 10 0 0 1 13 5M3 10a10 10 0 0 1 4-3M12 19h.01",
  wait: "M12 3a9 9 0 1 0 9 9M12 7v5l3 2",
  stop: "M8 3h8l5 5v8l-5 5H8l-5-5V8zM12 8v5M12 16h.01",
  battery: "M3 8h15v8H3zM21 11v2M6 11v2",
  drive: "M5 4l15 8-15 8 4-8z",
  ready: "M12 3a9 9 0 1 1 0 18 9 9 0 0 1 0-18M8 12l3 3 5-6",
};

function judge(robot, model) {
  const { status, snapshot } = robot;
  if (!model.socketOpen) return ["Not known", "idle", "gone"];
  if (status?.state === "lost") return ["Lost", "bad", "gone"];
  if (status?.state === "connecting") return ["Connecting", "warn", "wait"];
  if (!model.isLive(robot)) return ["No news", "warn", "wait"];
  if (snapshot.emergency_stop) return ["E-stop", "bad", "stop"];
  if (snapshot.motors.stop_button) return ["Stop button", "bad", "stop"];
  if (snapshot.motors.stalled) return ["Stalled", "bad", "stop"];
  if (snapshot.battery.low) return ["Battery low", "bad", "battery"];
  if (snapshot.driver && snapshot.driver.id !== null && snapshot.driver.id === model.client) return ["You drive", "you", "drive"];
  if (snapshot.driver) return [`${snapshot.driver.name} drives`, "warn", "drive"];
  return ["Ready", "good", "ready"];
}
