// Who is here and who has the wheel; letting others in and showing them out.

import { ask } from "./access.js";

const byId = (id) => document.getElementById(id);

function put(id, text) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
}

function make(tag, text, attributes = {}) {
  const element = document.createElement(tag);
  element.textContent = text;
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

function button(text, label, act) {
  const element = make("button", text, { type: "button", class: "choice", "aria-label": label });
  element.addEventListener("click", act);
  return element;
}

export class People {
  #send;
  #complain;
  #people = null;
  #robot = null; // whose wheel it is about
  #drawn = "";

  /**
   * @param send     function(message)
   * @param complain function(text): shows what went wrong
   */
  constructor({ send, complain }) {
    this.#send = (message) => send({ ...message, robot: this.#robot?.id });
    this.#complain = complain;
    byId("driver").addEventListener("click", () => this.#open(byId("people").hidden));
    byId("people-close").addEventListener("click", () => this.#open(false));
    byId("wheel-take").addEventListener("click", () => this.#send({ type: "take_wheel" }));
    byId("wheel-over").addEventListener("click", () => this.#send({ type: "take_over" }));
    byId("wheel-leave").addEventListener("click", () => this.#send({ type: "give_up_wheel" }));
    byId("invite-driver").addEventListener("click", () => this.#invite("driver"));
    byId("invite-viewer").addEventListener("click", () => this.#invite("viewer"));
    byId("token").addEventListener("click", () => this.#makeToken());
    addEventListener("keydown", (event) => event.key === "Escape" && this.#open(false));
  }

  get viewer() {
    return this.#people?.role === "viewer";
  }

  /** The wheel of this Robot is shown, by its name if there are several. */
  show(robot, several) {
    this.#robot = robot && { id: robot.id, name: several ? robot.name : "" };
    if (this.#people) this.#draw();
  }

  /** Who has the wheel, as the user is told: "you", a name, or "" for nobody. */
  get holder() {
    return this.#wheel === null ? "" : this.#mine ? "you" : this.#wheel.name;
  }

  /** Takes in the server's message about people. */
  receive(people) {
    this.#people = people;
    document.body.classList.toggle("viewer", this.viewer);
    this.#draw();
  }

  get #wheel() {
    return this.#people?.wheels.find(({ robot }) => robot === this.#robot?.id) ?? null;
  }

  get #mine() {
    return this.#wheel?.id === this.#people.id;
  }

  #draw() {
    const { name, role, guests } = this.#people;
    const wheel = this.#wheel;
    const state = JSON.stringify([this.#people, this.#robot]);
    if (state === this.#drawn) return; // else it would take the focus away
    this.#drawn = state;
    put("people-you", `You are ${name}, a ${role}.${this.viewer ? " You may look, and stop the robots." : ""}`);
    const which = this.#robot?.name ? `the wheel of ${this.#robot.name}` : "the wheel";
    put("people-wheel", this.#mine ? `You have ${which}.` : wheel ? `${wheel.name} has ${which}.` : `T${which.slice(1)} is free.`);
    byId("wheel-take").hidden = this.viewer || wheel !== null;
    byId("wheel-over").hidden = this.viewer || wheel === null || this.#mine;
    byId("wheel-leave").hidden = !this.#mine;
    byId("people-list").replaceChildren(...guests.map((guest) => this.#row(guest)));
  }

  #row({ id, name, role }) {
    const row = document.createElement("li");
    const you = id === this.#people.id ? " (you)" : "";
    const wheel = id === this.#wheel?.id ? ", has the wheel" : "";
    row.append(make("span", `${name}${you}`), make("small", `${role}${wheel}`));
    if (this.#mine && !you && role === "driver") {
      row.append(button("Hand over", `Hand the wheel to ${name}`, () => this.#send({ type: "hand_over", to: id })));
    }
    return row;
  }

  #open(open) {
    byId("people").hidden = !open;
    byId("driver").setAttribute("aria-expanded", String(open));
    byId("invitation").replaceChildren();
    byId("doors").hidden = this.viewer;
    if (open && !this.viewer) this.#showSessions();
  }

  async #showSessions() {
    await this.#try(async () => {
      const me = await ask("GET", "me");
      byId("invite-driver").hidden = byId("invite-viewer").hidden = !me.invites;
      const sessions = await ask("GET", "sessions");
      byId("doors-list").replaceChildren(...sessions.map((session) => this.#sessionRow(session)));
      byId("doors-title").hidden = sessions.length === 0;
    });
  }

  #sessionRow({ id, name, role, kind, yours }) {
    const row = document.createElement("li");
    row.append(make("span", `${name}${yours ? " (you)" : ""}`), make("small", `${kind}, ${role}`));
    row.append(button(yours ? "Leave" : "Revoke", `Revoke ${name}`, () => this.#try(async () => {
      await ask("DELETE", `sessions/${id}`);
      if (yours) location.replace("/pair");
      else await this.#showSessions();
    })));
    return row;
  }

  async #invite(role) {
    await this.#try(async () => {
      const { url, svg, seconds } = await ask("POST", "invitations", { role });
      const picture = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
      picture.setAttribute("role", "img");
      picture.setAttribute("aria-label", "QR code of the address below");
      const how = `Scan this with a phone, or open the address there. Good once, for ${Math.round(seconds / 60)} minutes.`;
      byId("invitation").replaceChildren(document.importNode(picture, true), make("code", url), make("p", how));
      byId("invitation").scrollIntoView({ block: "nearest" });
    });
  }

  async #makeToken() {
    await this.#try(async () => {
      const { token, name } = await ask("POST", "tokens", {});
      const how = `The token of ${name}, shown this once. Send it as "Authorization: Bearer …".`;
      byId("invitation").replaceChildren(make("code", token), make("p", how));
      byId("invitation").scrollIntoView({ block: "nearest" });
      await this.#showSessions();
    });
  }

  async #try(act) {
    try {
      await act();
    } catch (error) {
      this.#complain(error.message);
    }
  }
}
