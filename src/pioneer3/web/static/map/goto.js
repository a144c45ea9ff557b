// Sending the selected robot to a goal: a tap on the map proposes it, a button starts the drive.
// Nothing drives before that button; the server refuses goals that the map forbids.

import { PHONE, byId, degrees, hasModifier, isTyping, number, put, putProse, sentence } from "../dom.js";
import { STEPS, TURN, kindOf } from "./gestures.js";
import { placeAt } from "./places.js";
import { KNOB, knobOf } from "./target.js";

const SNAP = { mouse: 14, touch: 26 }; // px to a goal of the map
const SLACK = { mouse: 4, touch: 16 }; // px beside the knob
const NEAR = 0.15; // m between a target and the place of the map that it means: odometry drifts
const MOST = 19; // stops before the last one
const ROUND = Math.PI / 36; // headings that are dragged are multiples of it

const ELSEWHERE = 0.5; // m; a place that is nearer is where the robot is

const STOPS = "It stops when this page is closed or silent for 2 s.";
const PLACING = "Put the mark where it stands, turn the knob to where it looks, and press “It is here”.";

const timeOf = (seconds) => (seconds < 90 ? `${seconds} s` : `${Math.round(seconds / 60)} min`);

const pointOf = ({ x, y, heading, name }) => ({ x, y, name, ...(heading !== null && { heading }) });

export class GotoTool {
  /**
   * The goal that is proposed, {x, y, heading or null, toward, name}, or null. Once it has been sent
   * to a robot that plans its way, `sent` is the number of that; it stays until the robot sets out.
   */
  proposal = null;
  /** The first places of a patrol that is being put together, {x, y, heading, name}. */
  stops = [];
  #view;
  #scene;
  #model;
  #send;
  #speed;
  #changed;
  #turning = false;
  #listed = "";
  #statuses = new Map(); // of the newest goal of each robot
  #waits = { text: "", since: 0 };
  /** The place of the map under the mouse, or null. */
  hovered = null;
  #notify;
  #offered = false;

  /**
   * @param view, scene, model
   * @param send    function(message)
   * @param speed   function(): the user's [m/s]
   * @param driving function(): whether keys drive now
   * @param changed function(), after the proposal has changed
   * @param notify  function(text)
   */
  constructor({ view, scene, model, send, speed, driving, changed, notify }) {
    this.#view = view;
    this.#scene = scene;
    this.#model = model;
    this.#send = send;
    this.#speed = speed;
    this.#changed = changed;
    this.#notify = notify;
    byId("goto-go").addEventListener("click", () => this.#go());
    byId("goto-close").addEventListener("click", () => this.#callOff());
    byId("goto-any").addEventListener("click", () => this.#turn(null));
    byId("goto-tell").addEventListener("click", () => this.#place());
    byId("goto-add").addEventListener("click", () => this.#add());
    byId("goto-place").addEventListener("change", ({ target }) => this.#pick(Number(target.value)));
    byId("goto-look").addEventListener("click", () => this.#lookAround());
    byId("goto").addEventListener("click", () => this.begin());
    addEventListener("keydown", (event) => this.#key(event, driving), { capture: true });
  }

  /** Whether the selected robot may be sent anywhere from here. */
  get possible() {
    return this.#model.live && this.offers;
  }

  /** Whether places are offered to go to: to drivers of a robot that can. */
  get offers() {
    const { viewer, selected } = this.#model;
    return !viewer && selected !== null && !selected.hello.forbids;
  }

  /** The reason that the selected robot is not sure where it is, or "": then it is placed, and sent nowhere. */
  get unsure() {
    const navigation = this.#model.selected?.navigation;
    return navigation?.reason && !navigation.sure ? navigation.reason : "";
  }

  // pointers on the canvas, in CSS pixels

  /** A click, or a tap: proposes the place. Returns whether that is possible. */
  propose(point, type) {
    const place = this.placeAt(point, type);
    if (place && !this.possible) this.#tellWhyNot();
    if (!this.possible) return false;
    if (place) this.#set(place, place.heads ? place.theta : null, place.name);
    else this.#set(this.#view.toWorld(point.x, point.y), this.unsure && this.proposal ? this.proposal.heading : null, "");
    return true;
  }

  /** A finger is held down: proposes the place, and turns its heading as long as it stays. */
  hold(point, type) {
    this.#turning = true; // before the picture would move under the finger
    this.#turning = this.propose(point, type);
    return this.#turning;
  }

  /** The place of the map at a point, to which robots can be sent, or null. */
  placeAt(point, type) {
    return placeAt(this.#scene.places, this.#view, point, SNAP[kindOf(type)]);
  }

  /** A pointer is pressed; returns whether it is taken: if it is on the knob. */
  take(point, type) {
    if (!this.proposal) return false;
    const knob = knobOf(this.proposal, this.#view.scale);
    const at = this.#view.toScreen(knob.x, knob.y);
    this.#turning = Math.hypot(point.x - at.x, point.y - at.y) <= KNOB + SLACK[kindOf(type)];
    return this.#turning;
  }

  drag(point) {
    if (!this.proposal) return;
    const { x, y } = this.#view.toWorld(point.x, point.y);
    const heading = Math.atan2(y - this.proposal.y, x - this.proposal.x);
    if (Math.hypot(x - this.proposal.x, y - this.proposal.y) * this.#view.scale > 12) this.#turn(ROUND * Math.round(heading / ROUND));
  }

  drop() {
    this.#turning = false;
    this.#changed();
  }

  cancel() {
    this.drop();
  }

  hovers(point) {
    const place = this.possible && !this.#scene.mapEditor.active && !this.#scene.editor.active ? this.placeAt(point, "mouse") : null;
    if (place !== this.hovered) {
      this.hovered = place;
      this.#changed();
    }
    const before = this.#turning;
    const over = this.take(point, "mouse");
    this.#turning = before;
    return over || place !== null;
  }

  /** Takes the proposal away; one that has been sent stays until the server answers. */
  withdraw() {
    if (this.proposal && !this.proposal.sent) this.#close();
  }

  #callOff() {
    if (!this.proposal) return;
    if (this.proposal.sent) this.#send({ type: "end_mode", robot: this.proposal.sent });
    this.#close();
  }

  #close() {
    const inside = byId("goto-card").contains(document.activeElement);
    this.proposal = null;
    this.stops = [];
    this.#changed();
    if (inside) [byId("goto"), byId("unsure-place")].find((button) => button.offsetParent)?.focus();
  }

  /** Shows the proposal. It outlives moments without news from the robot, in which nothing is sent. */
  show() {
    const { offers } = this;
    const { live } = this.#model;
    if (this.proposal && !offers) [this.proposal, this.stops] = [null, []];
    if (this.proposal?.sent && !live) this.proposal.sent = null;
    this.#aim();
    this.#ask();
    byId("goto-card").hidden = !this.proposal;
    document.body.classList.toggle("choosing", this.proposal !== null);
    byId("goto").hidden = !offers || this.proposal !== null || this.unsure !== "";
    byId("goto").disabled = !live;
    if (this.proposal) this.#showProposal();
    this.#frame();
    if (offers !== this.#offered) this.#scene.renew(); // places look like buttons
    this.#offered = offers;
  }

  /** On a phone the picture shows the way while the card is open, or all of the map to place the robot on. */
  #frame() {
    if (this.#turning) return; // the finger stays where it is
    const [goal, from] = [this.proposal, this.#scene.pose];
    if (!goal || !PHONE.matches || this.#scene.solid) return this.#view.frame(null);
    const whole = this.unsure ? this.#scene.bounds : null;
    const points = [[goal.x, goal.y], ...(from ? [[from.x, from.y]] : []), ...(goal.way ?? [])];
    const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
    const box = { left: Math.min(...xs), right: Math.max(...xs), bottom: Math.min(...ys), top: Math.max(...ys) };
    const [stage, card, notices] = ["canvas", "goto-card", "notices"].map((id) => byId(id).getBoundingClientRect());
    return this.#view.frame(whole ?? box, { around: whole ? 16 : 60, top: notices.height ? notices.bottom - stage.top : 0, bottom: stage.bottom - card.top });
  }

  /** Asks for the way to the proposed place, once, and as soon as the robot is sure where it is. */
  #ask() {
    const [goal, robot] = [this.proposal, this.#model.selected];
    if (!goal || goal.asked || !this.possible || this.unsure || !robot.hello.plans) return;
    goal.asked = true;
    this.#send({ type: "plan_way", robot: robot.id, x: goal.x, y: goal.y, name: goal.name, speed: this.#speed() });
  }

  /** Without a heading, the robot arrives in the direction in which it comes. */
  #aim() {
    const [goal, from] = [this.proposal, this.#scene.pose];
    if (goal && goal.heading === null && from) goal.toward = Math.atan2(goal.y - from.y, goal.x - from.x);
  }

  #showProposal() {
    const { x, y, heading, name } = this.proposal;
    const turned = heading === null ? "" : `, heading ${number(degrees(heading), 0)}°`;
    const go = this.#model.several ? `${this.#model.selected.name}: go` : "Go";
    const { way, length, seconds, refusal, closed, sent, failure } = this.proposal;
    const waits = closed ? ` ${sentence(`${closed}; it waits before it`)}` : "";
    const far = way?.length ? ` ${length.toFixed(1)} m, about ${timeOf(seconds)}.${waits}` : "";
    const where = name || `${x.toFixed(2)}, ${y.toFixed(2)} m`;
    const before = this.stops.map((stop) => `${stop.name || `${stop.x.toFixed(1)}, ${stop.y.toFixed(1)}`}, then `).join("");
    const last = this.stops.at(-1);
    const added = last !== undefined && last.x === x && last.y === y;
    const unsure = sent ? "" : this.unsure;
    const who = this.#model.several ? `${this.#model.selected.name} is not sure` : "It is not sure";
    const question = added ? `${go} to ${before}where? Choose the next place.` : `${go} to ${before}${where}${turned}${before && ", again and again"}?${far}`;
    const said = refusal ? `No way to ${where}: ${refusal}.` : failure ? `It does not go to ${where}: ${failure}.` : question;
    putProse(byId("goto-where"), unsure ? `${who} where it is: ${unsure}.` : sent ? `It goes to ${before}${where} as soon as it knows the way.` : said);
    put(byId("goto-go"), before ? "Patrol" : "Go");
    byId("goto-go").hidden = unsure !== "";
    byId("goto-go").disabled = !this.possible || Boolean(refusal || sent) || (added && this.stops.length < 2);
    byId("goto-note").hidden = Boolean(refusal) && !unsure;
    put(byId("goto-note"), unsure ? PLACING : this.#preparation() || STOPS);
    byId("goto-any").hidden = heading === null || Boolean(sent);
    const { plans } = this.#model.selected.hello;
    byId("goto-tell").hidden = !plans || before !== "" || Boolean(sent);
    byId("goto-tell").disabled = !this.possible;
    byId("goto-tell").classList.toggle("go", unsure !== "");
    byId("goto-card").classList.toggle("placing", unsure !== "");
    byId("goto-look").hidden = !unsure;
    byId("goto-add").hidden = !plans || unsure !== "" || this.stops.length >= MOST || Boolean(sent);
    byId("goto-add").disabled = Boolean(refusal) || added;
    this.#list();
  }

  /** The reason why no way can be planned yet, and for how long that has been so, or "". */
  #preparation() {
    const { navigation } = this.#model.selected;
    const text = navigation && !navigation.reason ? navigation.problem : "";
    if (text !== this.#waits.text) this.#waits = { text, since: performance.now() };
    return text && `${sentence(text)} ${Math.round((performance.now() - this.#waits.since) / 1000)} s so far.`;
  }

  /** The server's news of a goal; returns what is to be shown of it elsewhere, or "". */
  takeGoal({ robot, status, text }) {
    const [before, mine] = [this.#statuses.get(robot), this.proposal?.sent === robot];
    this.#statuses.set(robot, status);
    const ended = status === "aborted" || status === "canceled";
    if (mine && ended) {
      Object.assign(this.proposal, { sent: null, failure: text });
      this.#changed();
      return "";
    }
    if (mine && status !== "accepted") this.#close();
    const told = status === "executing" || (status === "aborted" && before === "accepted");
    return told && text ? sentence(text) : "";
  }

  /** A request was refused; returns whether it was the goal. */
  takeRefusal(text) {
    const robot = this.proposal?.sent;
    if (!robot || this.#statuses.has(robot)) return false;
    this.takeGoal({ robot, status: "aborted", text });
    return true;
  }

  /** The server's answer to a proposal: the way there, or the reason why there is none. */
  takeWay(answer) {
    const goal = this.proposal;
    if (goal && goal.x === answer.x && goal.y === answer.y) {
      const { points, length, seconds, refusal, closed } = answer;
      Object.assign(goal, { way: points, length, seconds, refusal, closed });
      this.#changed();
    }
  }

  /** Where the selected robot is going, in words, or "". */
  get going() {
    const { live, snapshot, selected } = this.#model;
    const target = live ? snapshot?.target : null;
    if (!target) return "";
    const planned = selected.navigation;
    if (planned?.left != null) {
      const place = planned.place || `${target.x.toFixed(2)}, ${target.y.toFixed(2)}`;
      return `To ${place}: ${planned.left.toFixed(1)} m, ${timeOf(planned.seconds)} left${planned.problem && `; ${planned.problem}`}`;
    }
    const left = Math.hypot(target.x - snapshot.robot_in_map.x, target.y - snapshot.robot_in_map.y).toFixed(1);
    if (target.person) return `Follows somebody ${left} m away`;
    const place = this.#scene.places.find(({ points, x, y }) => !points.length && Math.hypot(x - target.x, y - target.y) <= NEAR)?.name || `${target.x.toFixed(2)}, ${target.y.toFixed(2)}`;
    return `To ${place}: ${left} m left`;
  }

  /** Lists the goals of the map, for use without a pointer. */
  #list() {
    const places = this.#named();
    const key = places.map(({ name }) => name).join("\n");
    const select = byId("goto-place");
    select.hidden = places.length === 0;
    if (key !== this.#listed) {
      this.#listed = key;
      select.replaceChildren(new Option("A place …", "-1"), ...places.map(({ name }, at) => new Option(name, String(at))));
    }
    const chosen = String(places.findIndex(({ name, x }) => name === this.proposal.name && x === this.proposal.x));
    if (select.value !== chosen) select.value = chosen;
  }

  #named() {
    const known = this.#scene.places.map((place) => ({ ...place, name: place.name || (place.role === "home" ? "Home" : "") }));
    return known.filter(({ name, role }) => name && ["goal", "dock", "home"].includes(role));
  }

  #pick(number) {
    const place = this.#named()[number];
    if (place) this.#set(place, place.heads ? place.theta : null, place.name);
  }

  #set({ x, y }, heading, name) {
    const straight = !this.#model.selected.hello.plans;
    this.proposal = { x, y, heading, toward: heading ?? 0, name, straight };
    this.#changed();
  }

  #turn(heading) {
    if (!this.proposal) return;
    this.proposal.heading = heading;
    if (heading !== null) this.proposal.toward = heading;
    this.#changed();
  }

  /** Opens the card: with the nearest place where the robot is not, or where it seems to be, to put it right. */
  begin() {
    if (!this.possible) return this.#tellWhyNot();
    const from = this.#scene.pose;
    const far = ({ x, y }) => (from ? Math.hypot(x - from.x, y - from.y) : 0);
    const [nearest] = this.#named().filter((place) => far(place) > ELSEWHERE).sort((one, other) => far(one) - far(other));
    if (this.unsure) this.#set(from ?? this.#view, from?.theta ?? null, "");
    else if (nearest) this.#set(nearest, nearest.heads ? nearest.theta : null, nearest.name);
    else this.#set(this.#view, null, "");
    byId(this.unsure ? "goto-tell" : "goto-go").focus();
  }

  #tellWhyNot() {
    const { live, viewer, selected } = this.#model;
    if (live && !viewer && selected.hello.forbids) this.#notify(`It cannot be sent to places: ${selected.hello.forbids}.`);
  }

  #lookAround() {
    this.#send({ type: "look_around", robot: this.#model.selected.id });
    this.#close();
  }

  #go() {
    const [robot, speed] = [this.#model.selected.id, this.#speed()];
    const goals = this.stops.map(pointOf);
    const [last, goal] = [goals.at(-1), pointOf(this.proposal)];
    if (!last || last.x !== goal.x || last.y !== goal.y) goals.push(goal);
    if (goals.length > 1) this.#send({ type: "patrol", robot, places: goals, speed });
    else this.#send({ type: "goto", robot, ...goal, speed });
    if (!this.#model.selected.hello.plans) {
      this.#close();
      return;
    }
    this.#statuses.delete(robot);
    Object.assign(this.proposal, { sent: robot, failure: "" });
    if (byId("goto-card").contains(document.activeElement)) byId("goto-close").focus();
    this.#changed();
  }

  /** The robot is at the proposed place, with the proposed heading if there is one. */
  #place() {
    const { name: _, ...pose } = pointOf(this.proposal);
    this.#send({ type: "place_robot", robot: this.#model.selected.id, ...pose });
    this.#close();
  }

  /** More places follow the proposed one: the next click proposes another. */
  #add() {
    const { x, y, heading, name } = this.proposal;
    this.stops.push({ x, y, heading, name });
    this.#changed();
  }

  #key(event, driving) {
    if (hasModifier(event) || isTyping(event)) return;
    if (event.key === "g") this.begin();
    else if (!this.proposal) return;
    else if (event.key === "Escape") this.#callOff();
    else if (event.shiftKey && event.code in STEPS && !driving()) this.#nudge(...STEPS[event.code]);
    else if (event.key === "[" || event.key === "]") this.#turn(this.proposal.toward + (event.key === "[" ? TURN : -TURN));
    else return;
    event.preventDefault();
    event.stopImmediatePropagation(); // these keys do not drive
  }

  #nudge(dx, dy) {
    const { x, y, heading } = this.proposal;
    this.#set({ x: x + dx, y: y + dy }, heading, "");
  }
}
