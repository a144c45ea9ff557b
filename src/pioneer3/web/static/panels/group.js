// The modes of several robots: the chosen robots, their leader, and a form for each mode.

import { make, put, putItems } from "../dom.js";
import { Fields, button, loadForms } from "./fields.js";
import { part } from "./widgets.js";

const HOW = "To drive several robots at once, choose them: click with Shift held on their names or on the map, or open the list "
  + "of all robots and press Choose several. Arrows and stick drive all of them.";

export class GroupView {
  element;
  #send;
  #notify;
  #seconds;
  #who = make("p", { class: "words", id: "group-who", role: "status" });
  #leader = make("select", { id: "group-leader", class: "small" });
  #leads = make("label", { class: "field" }, make("span", {}, "Leader"), this.#leader);
  #end = button("group-end", "End the modes of these robots", () => this.#endAll(), "danger wide");
  #forms = make("div", {});
  #starts = [];
  #robots = [];
  #begun = null; // a mode that was asked for: {name, leader, follower}, until its robots run it
  #lead;

  /**
   * @param send    function(message): returns whether it was sent
   * @param notify  function(text)
   * @param seconds function(): the longest time of a mode [s]
   * @param lead    function(id): selects the leader of a mode that has begun, which the keys drive then
   */
  constructor({ send, notify, seconds, lead }) {
    [this.#send, this.#notify, this.#seconds, this.#lead] = [send, notify, seconds, lead];
    this.element = part("Together", this.#who, this.#leads, this.#forms, this.#end);
    this.element.hidden = true;
    loadForms("/api/group_modes", (forms) => this.#forms.replaceChildren(...forms.map((form) => this.#form(form))));
  }

  /** @param model Model @param usable whether this page may drive */
  show(model, usable) {
    this.#selectLeader(model);
    const { several, chosen } = model;
    this.element.hidden = !several;
    const together = chosen.length > 1;
    this.#robots = chosen;
    for (const one of [this.#leads, this.#forms]) one.hidden = !together;
    this.#end.hidden = !together || !chosen.some(({ snapshot }) => snapshot?.mode);
    put(this.#who, together ? about(model) : HOW);
    for (const start of this.#starts) start.disabled = !usable;
    const before = this.#leader.value;
    putItems(this.#leader, chosen.map(({ id, name }) => `${id} ${name}`).join("\n"), () => chosen.map(({ id, name }) => new Option(name, id)));
    if (chosen.some(({ id }) => String(id) === before)) this.#leader.value = before;
  }

  #form({ name, title, summary, advice, start, led, fields }) {
    const made = new Fields(name, fields);
    const begin = button(`${name}-start`, start, () => this.#start(name, led, made));
    begin.setAttribute("aria-describedby", "mode-note");
    this.#starts.push(begin);
    const words = make("p", { class: "words" }, `${summary} ${advice}`.trim());
    return make("div", { class: "group-form" }, make("h4", {}, title), words, ...made.choices, ...made.numbers, make("div", { class: "row" }, begin));
  }

  #start(name, led, made) {
    const given = made.read(this.#notify);
    if (!given) return;
    const mode = { mode: name, ...given, seconds: this.#seconds() };
    const robots = this.#robots.map(({ id }) => id);
    const leader = led ? Number(this.#leader.value) : null;
    if (!this.#send({ type: "start_group_mode", robots, leader, mode })) this.#notify("Not connected: nothing was started.");
    else if (led) this.#begun = { name, leader, follower: robots.find((id) => id !== leader) };
  }

  /** The keys must not overrule the followers: once these have begun, only the leader is selected. */
  #selectLeader(model) {
    if (!this.#begun || model.robots.get(this.#begun.follower)?.snapshot?.mode !== this.#begun.name) return;
    const { leader } = this.#begun;
    this.#begun = null;
    this.#lead(leader);
  }

  #endAll() {
    const sent = this.#robots.map(({ id, snapshot }) => !snapshot?.mode || this.#send({ type: "end_mode", robot: id }));
    if (sent.includes(false)) this.#notify("Not connected: press the stop button on the robots.");
  }
}

/** The names of the chosen robots, and those that somebody else has control of. */
function about(model) {
  const { chosen } = model;
  const names = chosen.map(({ name }) => name).join(", ");
  const others = chosen.flatMap((robot) => {
    const holder = model.holderOf(robot);
    return holder && holder.id !== model.client ? [`${holder.name} has control of ${robot.name}.`] : [];
  });
  return [`${chosen.length} robots: ${names}.`, ...others].join(" ");
}
