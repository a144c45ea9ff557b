// The people at the page, the control of the selected robot, invitations and
// sessions.

import { byId, make, makeButton, put, set } from "../dom.js";
import { ask } from "../http.js";

const button = (text, label, act) => makeButton(text, { class: "choice", "aria-label": label }, act);

/** A row about somebody: a name, and more in small letters. */
const row = (name, more, ...buttons) => make("li", {}, make("span", {}, name), make("small", {}, more), ...buttons);

export class People {
  #send;
  #notify;
  #people = null;
  #robot = null; // {id, name} of the selected robot
  #drawn = "";

  /**
   * @param send   function(message)
   * @param notify function(text): shows an error
   */
  constructor({ send, notify }) {
    this.#send = (message) => send({ ...message, robot: this.#robot?.id });
    this.#notify = notify;
    byId("driver").addEventListener("click", () => this.#open(byId("people").hidden));
    byId("people-close").addEventListener("click", () => this.#open(false));
    byId("lease-take").addEventListener("click", () => this.#send({ type: "take_control" }));
    byId("lease-take-over").addEventListener("click", () => this.#send({ type: "take_over" }));
    byId("lease-release").addEventListener("click", () => this.#send({ type: "release_control" }));
    byId("invite-driver").addEventListener("click", () => this.#invite("driver"));
    byId("invite-viewer").addEventListener("click", () => this.#invite("viewer"));
    byId("token").addEventListener("click", () => this.#makeToken());
    addEventListener("keydown", (event) => event.key === "Escape" && this.#open(false));
  }

  get viewer() {
    return this.#people?.role === "viewer";
  }

  /** Shows the lease of this Robot, with its name if there are several. */
  show(robot, several) {
    this.#robot = robot && { id: robot.id, name: several ? robot.name : "" };
    if (this.#people) this.#draw();
  }

  /** The holder of the lease: "you", a name, or "" for nobody. */
  get holder() {
    return this.#lease === null ? "" : this.#mine ? "you" : this.#lease.name;
  }

  /** Takes the server's message about people. */
  receive(people) {
    this.#people = people;
    this.#draw();
  }

  get #lease() {
    return this.#people?.control.find(({ robot }) => robot === this.#robot?.id) ?? null;
  }

  get #mine() {
    return this.#lease?.id === this.#people.id;
  }

  #draw() {
    const { name, role, clients } = this.#people;
    const lease = this.#lease;
    const state = JSON.stringify([this.#people, this.#robot]);
    if (state === this.#drawn) return; // new buttons would lose the focus
    this.#drawn = state;
    put(byId("people-you"), `You are ${name}, a ${role}.${this.viewer ? " You may look, and stop the robots." : ""}`);
    const control = this.#robot?.name ? `control of ${this.#robot.name}` : "control";
    put(byId("people-lease"), `${this.#mine ? "You have" : lease ? `${lease.name} has` : "Nobody has"} ${control}.`);
    byId("lease-take").hidden = this.viewer || lease !== null;
    byId("lease-take-over").hidden = this.viewer || lease === null || this.#mine;
    byId("lease-release").hidden = !this.#mine;
    byId("people-list").replaceChildren(...clients.map((client) => this.#row(client)));
  }

  #row({ id, name, role }) {
    const you = id === this.#people.id ? " (you)" : "";
    const control = id === this.#lease?.id ? ", has control" : "";
    const handOver = () => button("Hand over", `Hand control to ${name}`, () => this.#send({ type: "hand_over", to: id }));
    return row(`${name}${you}`, `${role}${control}`, ...(this.#mine && !you && role === "driver" ? [handOver()] : []));
  }

  #open(open) {
    byId("people").hidden = !open;
    set(byId("driver"), "aria-expanded", String(open));
    byId("invitation").replaceChildren();
    byId("access").hidden = this.viewer;
    if (open && !this.viewer) this.#showSessions();
  }

  async #showSessions() {
    await this.#try(async () => {
      const me = await ask("GET", "me");
      byId("invite-driver").hidden = byId("invite-viewer").hidden = !me.invites;
      const sessions = await ask("GET", "sessions");
      byId("sessions-list").replaceChildren(...sessions.map((session) => this.#sessionRow(session)));
      byId("sessions-title").hidden = sessions.length === 0;
    });
  }

  #sessionRow({ id, name, role, kind, yours }) {
    const revoke = () => this.#try(async () => {
      await ask("DELETE", `sessions/${id}`);
      if (yours) location.replace("/pair");
      else await this.#showSessions();
    });
    return row(`${name}${yours ? " (you)" : ""}`, `${kind}, ${role}`, button(yours ? "Leave" : "Revoke", `Revoke ${name}`, revoke));
  }

  async #invite(role) {
    await this.#try(async () => {
      const { url, svg, seconds } = await ask("POST", "invitations", { role });
      const picture = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
      set(picture, "role", "img");
      set(picture, "aria-label", "QR code of the address below");
      const how = `Scan this with a phone, or open the address there. Good once, for ${Math.round(seconds / 60)} minutes.`;
      byId("invitation").replaceChildren(document.importNode(picture, true), make("code", {}, url), make("p", {}, how));
      byId("invitation").scrollIntoView({ block: "nearest" });
    });
  }

  async #makeToken() {
    await this.#try(async () => {
      const { token, name } = await ask("POST", "tokens", {});
      const how = `The token of ${name}, shown this once. Send it as "Authorization: Bearer …".`;
      byId("invitation").replaceChildren(make("code", {}, token), make("p", {}, how));
      byId("invitation").scrollIntoView({ block: "nearest" });
      await this.#showSessions();
    });
  }

  async #try(act) {
    try {
      await act();
    } catch (error) {
      this.#notify(error.message);
    }
  }
}
