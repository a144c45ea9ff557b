// Which of several robots is driven, stopped and shown. With one there is nothing to pick.

import { stateOf } from "./state.js";

const SVG = "http://www.w3.org/2000/svg";

export class Picker {
  #element = document.getElementById("robots");
  #model;
  #select;
  #buttons = new Map(); // id -> {button, name, state, path}

  /**
   * @param model
   * @param select function(id): the user wants this robot
   */
  constructor({ model, select }) {
    this.#model = model;
    this.#select = select;
    addEventListener("keydown", (event) => this.#key(event));
  }

  /** Shows the robots as they are now. */
  show() {
    const { robots, several, selected } = this.#model;
    this.#element.hidden = !several;
    document.body.classList.toggle("several", several);
    if (!several) return;
    if ([...robots.keys()].join() !== [...this.#buttons.keys()].join()) this.#build([...robots.keys()]);
    for (const robot of robots.values()) this.#show(robot, robot === selected);
  }

  #build(ids) {
    this.#buttons = new Map(ids.map((id) => [id, this.#make(id)]));
    this.#element.replaceChildren(...[...this.#buttons.values()].map(({ button }) => button));
  }

  #make(id) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "robot";
    const icon = document.createElementNS(SVG, "svg");
    icon.setAttribute("viewBox", "0 0 24 24");
    icon.setAttribute("aria-hidden", "true");
    const path = document.createElementNS(SVG, "path");
    icon.append(path);
    const [name, state] = [document.createElement("strong"), document.createElement("small")];
    button.append(icon, name, state);
    button.addEventListener("click", () => this.#select(id));
    return { button, name, state, path };
  }

  #show(robot, chosen) {
    const { button, name, state, path } = this.#buttons.get(robot.id);
    const { text, level, icon } = stateOf(robot, this.#model);
    if (name.textContent !== robot.name) name.textContent = robot.name;
    if (state.textContent !== text) state.textContent = text;
    if (path.getAttribute("d") !== icon) path.setAttribute("d", icon);
    button.dataset.level = level;
    if (button.getAttribute("aria-pressed") === String(chosen)) return;
    button.setAttribute("aria-pressed", String(chosen));
    if (chosen) button.scrollIntoView({ block: "nearest", inline: "nearest" });
  }

  /** 1 to 9 are the first nine, Page Up and Down the neighbours. */
  #key(event) {
    if (!this.#model.several || event.ctrlKey || event.altKey || event.metaKey || isTyping(event.target)) return;
    const ids = [...this.#model.robots.keys()];
    const step = { PageUp: -1, PageDown: 1 }[event.key];
    const at = step ? ids.indexOf(this.#model.selected.id) + step : Number(event.key) - 1;
    if (!(at in ids)) return;
    event.preventDefault();
    this.#select(ids[at]);
  }
}

function isTyping(target) {
  return target instanceof Element && target.matches("input, textarea, select, [contenteditable]");
}
