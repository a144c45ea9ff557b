// Sending the selected robot somewhere: a tap on the map offers it, a button starts it.
// Nothing drives before that button; the server says where it must not.

import { placeAt } from "./draw_places.js";
import { KNOB, knobOf } from "./draw_target.js";

const byId = (id) => document.getElementById(id);
const SNAP = { mouse: 14, touch: 26 }; // px to a goal of the map
const SLACK = { mouse: 4, touch: 16 }; // px beside the knob
const NEAR = 0.15; // m from a place of the map to what is still it: odometry drifts
const ROUND = Math.PI / 36; // headings that are dragged are multiples of it
const TURN = Math.PI / 12;
const STEP = 0.1; // m
const ARROWS = { ArrowUp: [0, STEP], ArrowDown: [0, -STEP], ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0] };

const finger = (type) => (type === "mouse" ? "mouse" : "touch");

export class Errand {
  /** {x, y, heading or null, toward, name} of where the robot may be sent, or null. */
  offer = null;
  #view;
  #scene;
  #model;
  #send;
  #speed;
  #changed;
  #turning = false;
  #listed = "";

  /**
   * @param view, scene, model
   * @param send    function(message)
   * @param speed   function(): the user's [m/s]
   * @param driving function(): whether keys drive now
   * @param changed function(), after the offer has changed
   */
  constructor({ view, scene, model, send, speed, driving, changed }) {
    this.#view = view;
    this.#scene = scene;
    this.#model = model;
    this.#send = send;
    this.#speed = speed;
    this.#changed = changed;
    byId("errand-go").addEventListener("click", () => this.#go());
    byId("errand-close").addEventListener("click", () => this.withdraw());
    byId("errand-any").addEventListener("click", () => this.#turn(null));
    byId("errand-place").addEventListener("change", ({ target }) => this.#pick(Number(target.value)));
    byId("goto").addEventListener("click", () => (this.offer ? this.withdraw() : this.#offerMiddle()));
    addEventListener("keydown", (event) => this.#key(event, driving), { capture: true });
  }

  /** Whether the selected robot may be sent anywhere from here. */
  get possible() {
    return this.#model.live && !this.#model.viewer;
  }

  // pointers on the canvas, in CSS pixels

  /** A tap of the mouse, or a finger that stays: offers the place. */
  propose(point, type) {
    if (!this.possible) return false;
    const at = this.#view.toWorld(point.x, point.y);
    const place = placeAt(this.#scene.places, at, SNAP[finger(type)] / this.#view.scale);
    if (place) this.#set(place, place.heads ? place.theta : null, place.name);
    else this.#set(at, null, "");
    return true;
  }

  /** A finger comes down; it is taken if it grips the knob. */
  take(point, type) {
    if (!this.offer) return false;
    const knob = knobOf(this.offer, this.#view.scale);
    const at = this.#view.toScreen(knob.x, knob.y);
    this.#turning = Math.hypot(point.x - at.x, point.y - at.y) <= KNOB + SLACK[finger(type)];
    return this.#turning;
  }

  drag(point) {
    if (!this.offer) return;
    const { x, y } = this.#view.toWorld(point.x, point.y);
    const heading = Math.atan2(y - this.offer.y, x - this.offer.x);
    if (Math.hypot(x - this.offer.x, y - this.offer.y) * this.#view.scale > 12) this.#turn(ROUND * Math.round(heading / ROUND));
  }

  drop() {
    this.#turning = false;
  }

  cancel() {
    this.#turning = false;
  }

  hovers(point) {
    const before = this.#turning;
    const over = this.take(point, "mouse");
    this.#turning = before;
    return over;
  }

  withdraw() {
    if (!this.offer) return;
    const inside = byId("errand").contains(document.activeElement);
    this.offer = null;
    this.#changed();
    if (inside) byId("goto").focus();
  }

  /** Shows the offer. */
  show() {
    if (this.offer && !this.possible) this.offer = null;
    this.#aim();
    byId("errand").hidden = !this.offer;
    byId("goto").hidden = this.#model.viewer;
    byId("goto").disabled = !this.possible;
    byId("goto").setAttribute("aria-expanded", String(Boolean(this.offer)));
    if (this.offer) this.#showOffer();
  }

  /** Without a heading it arrives as it comes from where it is. */
  #aim() {
    const [offer, from] = [this.offer, this.#scene.pose];
    if (offer && offer.heading === null && from) offer.toward = Math.atan2(offer.y - from.y, offer.x - from.x);
  }

  #showOffer() {
    const { x, y, heading, name } = this.offer;
    const turned = heading === null ? "" : `, heading ${degrees(heading)}`;
    const go = this.#model.several ? `${this.#model.selected.name}: go` : "Go";
    put("errand-where", `${go} to ${name || `${x.toFixed(2)}, ${y.toFixed(2)} m`}${turned}?`);
    byId("errand-any").hidden = heading === null;
    this.#list();
  }

  /** Where the selected robot is going, in words, or "". */
  get going() {
    const { live, snapshot } = this.#model;
    const target = live ? snapshot?.target : null;
    if (!target) return "";
    const left = Math.hypot(target.x - snapshot.pose.x, target.y - snapshot.pose.y).toFixed(1);
    if (target.person) return `Follows somebody ${left} m away`;
    const place = placeAt(this.#scene.places, target, NEAR)?.name || `${target.x.toFixed(2)}, ${target.y.toFixed(2)}`;
    return `To ${place}: ${left} m left`;
  }

  /** The goals of the map, for who has no pointer. */
  #list() {
    const places = this.#named();
    const key = places.map(({ name }) => name).join("\n");
    const select = byId("errand-place");
    select.hidden = places.length === 0;
    if (key !== this.#listed) {
      this.#listed = key;
      select.replaceChildren(new Option("A place …", "-1"), ...places.map(({ name }, at) => new Option(name, String(at))));
    }
    const chosen = String(places.findIndex(({ name, x }) => name === this.offer.name && x === this.offer.x));
    if (select.value !== chosen) select.value = chosen;
  }

  #named() {
    return this.#scene.places.filter(({ name, role }) => name && ["goal", "dock", "home"].includes(role));
  }

  #pick(number) {
    const place = this.#named()[number];
    if (place) this.#set(place, place.heads ? place.theta : null, place.name);
  }

  #set({ x, y }, heading, name) {
    this.offer = { x, y, heading, toward: heading ?? 0, name };
    this.#aim();
    this.#changed();
  }

  #turn(heading) {
    if (!this.offer) return;
    this.offer.heading = heading;
    if (heading !== null) this.offer.toward = heading;
    this.#changed();
  }

  #offerMiddle() {
    if (!this.possible) return;
    this.#set(this.#view, null, "");
    byId("errand-go").focus();
  }

  #go() {
    const { x, y, heading } = this.offer;
    const request = { type: "goto", robot: this.#model.selected.id, x, y, speed: this.#speed() };
    this.#send(heading === null ? request : { ...request, heading });
    this.withdraw();
  }

  #key(event, driving) {
    if (event.ctrlKey || event.altKey || event.metaKey || isTyping(event.target)) return;
    if (event.key === "g") this.#offerMiddle();
    else if (!this.offer) return;
    else if (event.key === "Escape") this.withdraw();
    else if (event.shiftKey && event.code in ARROWS && !driving()) this.#nudge(...ARROWS[event.code]);
    else if (event.key === "[" || event.key === "]") this.#turn(this.offer.toward + (event.key === "[" ? TURN : -TURN));
    else return;
    event.preventDefault();
    event.stopImmediatePropagation(); // these keys do not drive
  }

  #nudge(dx, dy) {
    const { x, y, heading } = this.offer;
    this.#set({ x: x + dx, y: y + dy }, heading, "");
  }
}

function degrees(angle) {
  return `${Math.round((angle * 180) / Math.PI)}°`.replace("-", "−");
}

function put(id, text) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
}

function isTyping(target) {
  return target instanceof Element && target.matches("input, select, textarea");
}
