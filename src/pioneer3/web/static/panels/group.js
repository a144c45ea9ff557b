// The modes of several robots: the chosen robots, their leader, and a form for each mode.

import { make, put, putItems } from "../dom.js";
import { button, choice, figure, isWrong } from "./modes.js";
import { part } from "./widgets.js";

const RETRY = 2000; // [ms]
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
    this.#load();
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

  /** Asks for the forms until they come: the server may be away, or this browser not paired yet. */
  async #load() {
    try {
      const answer = await fetch("/api/group_modes");
      if (!answer.ok) throw new Error(answer.statusText);
      this.#forms.replaceChildren(...(await answer.json()).map((form) => this.#form(form)));
    } catch {
      setTimeout(() => this.#load(), RETRY);
    }
  }

  #form({ name, title, summary, advice, start, led, fields }) {
    const made = fields.map((field) => {
      const id = `${name}-${field.name}`;
      return field.choices.length ? choice(id, field.title, field.choices.map((one) => [one.name, one.title, `${one.hint}.`])) : figure(id, field);
    });
    made.forEach(([input], i) => {
      if (fields[i].choices.length === 0) return;
      input.value = fields[i].default;
      input.dispatchEvent(new Event("change"));
    });
    const inputs = made.map(([input]) => input);
    const begin = button(`${name}-start`, start, () => this.#start(name, led, fields, inputs));
    begin.setAttribute("aria-describedby", "mode-note");
    this.#starts.push(begin);
    const words = make("p", { class: "words" }, `${summary} ${advice}`.trim());
    return make("div", { class: "group-form" }, make("h4", {}, title), words, ...made.map(([, element]) => element), make("div", { class: "row" }, begin));
  }

  #start(name, led, fields, inputs) {
    const wrong = inputs.find((input, i) => isWrong(input) || (input.value === "" && fields[i].required));
    if (wrong) {
      wrong.focus();
      this.#notify(wrong.validationMessage || "A number is missing.");
      return;
    }
    const values = fields.map((field, i) => [field.name, field.choices.length ? inputs[i].value : inputs[i].valueAsNumber * field.scale]);
    const given = Object.fromEntries(values.filter((_, i) => inputs[i].value !== ""));
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
