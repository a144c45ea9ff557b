// The replay of logs: the time line with its marks, play and pause, the speed, and the keys.

import { byId, hasModifier, make, put, putItems, set } from "../dom.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 32];
const STEP = 5; // s, of an arrow key
const LEAP = 60; // s, with Shift
const TICK = 100; // ms between two looks at the time
const PATIENCE = 1000; // ms until a time that was asked for is given up
const NEAR = 9; // px beside a mark that mean it
const THUMB = 12; // px, half of the slider's thumb: the time line begins and ends there
const BUCKETS = 400; // marks nearer than that part of the line are drawn as one
const KINDS = ["note", "mode", "goal", "link", "stall", "emergency"]; // the last one covers the others
const KEYS = ["Space", "ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "Comma", "Period", "KeyK"];
const NOTHING_DRIVES = "This is a replay: nothing in it can be driven.";

export class Replay {
  /** @type {import("../messages.d.ts").ReplayState | null} */
  #state = null;
  /** @type {import("../messages.d.ts").ReplayMark[]} */
  #marks = [];
  #heardAt = 0;
  #wanted = null; // the time that was asked for last, until the server is there: {at, jumps, until}
  #held = null; // where a finger or mouse holds the slider [s since 1970]
  #under = null; // the mark under the mouse
  #nameOf;
  #send;
  #notify;
  #jumped;
  #line = byId("replay-time");

  /**
   * @param send   function(message): returns whether it was sent
   * @param notify function(text)
   * @param nameOf function(number): the name of a robot where there are several, else nothing
   * @param jumped function(), after the time has changed other than by passing
   */
  constructor({ send, notify, nameOf, jumped }) {
    [this.#send, this.#notify, this.#nameOf, this.#jumped] = [send, notify, nameOf, jumped];
    const line = this.#line;
    line.addEventListener("input", () => this.#scrub());
    line.addEventListener("change", () => (this.#held = null));
    line.addEventListener("pointermove", ({ clientX }) => (this.#under = this.#markAt(clientX)));
    line.addEventListener("pointerleave", () => (this.#under = null));
    line.addEventListener("click", ({ clientX }) => this.#goToMark(this.#markAt(clientX)));
    byId("replay-play").addEventListener("click", () => this.#toggle());
    byId("replay-before").addEventListener("click", () => this.#goToMark(this.#before));
    byId("replay-after").addEventListener("click", () => this.#goToMark(this.#after));
    const speed = byId("replay-speed");
    speed.append(...SPEEDS.map((each) => make("option", { value: each }, `${each}×`)));
    speed.addEventListener("change", () => this.#ask({ speed: Number(speed.value) }));
    addEventListener("keydown", (event) => this.#key(event), { capture: true });
    addEventListener("keyup", (event) => this.#takes(event) && event.stopImmediatePropagation(), { capture: true });
    setInterval(() => this.#state && this.#show(), TICK);
  }

  /** Whether the page shows a replay. */
  get on() {
    return this.#state !== null;
  }

  /** The time of the replay [s since 1970]. */
  get now() {
    const { at, ended, playing, speed, jumps } = this.#state;
    if (this.#wanted?.jumps === jumps && performance.now() < this.#wanted.until) return this.#wanted.at;
    const passed = playing ? ((performance.now() - this.#heardAt) / 1000) * speed : 0;
    return Math.min(ended, at + passed);
  }

  /** Takes the state of the replay. @param {import("../messages.d.ts").ReplayState} state */
  takeState(state) {
    const jumps = this.#state?.jumps;
    this.#state = state;
    this.#heardAt = performance.now();
    if (jumps !== undefined && jumps !== state.jumps) this.#jumped();
    byId("replay").hidden = false;
    this.#show();
  }

  /** Takes the marks found so far. @param {import("../messages.d.ts").ReplayMarks} message */
  takeMarks({ marks }) {
    this.#marks = [...marks].sort((a, b) => a.at - b.at);
    const { began, ended } = this.#state;
    const buckets = new Map();
    for (const { at, kind } of this.#marks) {
      const place = Math.round(((at - began) / (ended - began || 1)) * BUCKETS);
      if (rank(kind) >= rank(buckets.get(place) ?? "note")) buckets.set(place, kind);
    }
    putItems(byId("replay-marks"), JSON.stringify([...buckets]), () => byRank(buckets).map(([place, kind]) => {
      const mark = make("i", { "data-kind": kind });
      mark.style.left = `${(100 * place) / BUCKETS}%`;
      return mark;
    }));
  }

  #ask(change) {
    if (!this.#send({ type: "play", ...change })) this.#notify("Not connected: nothing was changed.");
  }

  #toggle() {
    this.#ask({ playing: !this.#state.playing });
  }

  #goTo(at) {
    const { began, ended, jumps } = this.#state;
    const wanted = Math.min(ended, Math.max(began, at));
    this.#wanted = { at: wanted, jumps, until: performance.now() + PATIENCE };
    this.#ask({ at: wanted });
    this.#show();
  }

  #goToMark(mark) {
    if (mark) this.#goTo(mark.at);
  }

  #scrub() {
    this.#held = this.#state.began + this.#line.valueAsNumber;
    this.#goTo(this.#held);
  }

  /** The mark at a place of the line [px], or null. */
  #markAt(x) {
    const { left, width } = this.#line.getBoundingClientRect();
    const { began, ended } = this.#state;
    const far = (mark) => Math.abs(left + THUMB + ((mark.at - began) / (ended - began || 1)) * (width - 2 * THUMB) - x);
    return this.#marks.filter((mark) => far(mark) <= NEAR).sort((a, b) => far(a) - far(b))[0] ?? null;
  }

  get #before() {
    return this.#marks.findLast(({ at }) => at < this.now - (this.#state.playing ? 1 : 1e-3)) ?? null;
  }

  get #after() {
    return this.#marks.find(({ at }) => at > this.now + 1e-3) ?? null;
  }

  /** Whether a key is one of the replay's. */
  #takes(event) {
    const { target, code } = event;
    if (!this.on || hasModifier(event) || !KEYS.includes(code)) return false;
    return !(target instanceof Element) || !target.matches('select, textarea, input:not([type="range"])');
  }

  #key(event) {
    if (!this.#takes(event)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    const by = event.shiftKey ? LEAP : STEP;
    const { began, ended, speed } = this.#state;
    const faster = (n) => SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, SPEEDS.indexOf(speed) + n))];
    if (event.code === "Space") event.repeat || this.#toggle();
    else if (event.code === "KeyK") this.#notify(NOTHING_DRIVES);
    else if (event.code === "ArrowLeft") this.#goTo(this.now - by);
    else if (event.code === "ArrowRight") this.#goTo(this.now + by);
    else if (event.code === "ArrowUp") this.#ask({ speed: faster(1) });
    else if (event.code === "ArrowDown") this.#ask({ speed: faster(-1) });
    else if (event.code === "Home") this.#goTo(began);
    else if (event.code === "End") this.#goTo(ended);
    else this.#goToMark(event.code === "Comma" ? this.#before : this.#after);
  }

  #show() {
    const { began, ended, speed, playing, looked } = this.#state;
    const at = this.#held ?? this.now;
    const [passed, length] = [at - began, ended - began];
    this.#line.max = length;
    if (this.#held === null) this.#line.value = passed;
    this.#line.style.setProperty("--filled", `${(100 * passed) / (length || 1)}%`);
    const words = `${clock(at)}, ${duration(passed)} of ${duration(length)}`;
    set(this.#line, "aria-valuetext", words);
    put(byId("replay-clock"), clock(at));
    put(byId("replay-passed"), `${duration(passed)} / ${duration(length)}`);
    const play = byId("replay-play");
    set(play, "aria-label", playing ? "Pause" : "Play");
    set(play, "title", `${playing ? "Pause" : "Play"} (Space)`);
    play.classList.toggle("playing", playing);
    if (document.activeElement !== byId("replay-speed")) byId("replay-speed").value = String(speed);
    byId("replay-before").disabled = this.#before === null;
    byId("replay-after").disabled = this.#after === null;
    const mark = this.#under ?? this.#marks.findLast((each) => each.at <= at + 1e-3);
    const looking = looked < 1 ? `Looking for marks: ${Math.floor(100 * looked)} %` : "No mark before this.";
    set(byId("replay-mark"), "data-kind", mark?.kind ?? "note");
    put(byId("replay-mark"), mark ? this.#told(mark) : looking);
  }

  #told({ at, robot, text }) {
    const name = robot === null ? "" : this.#nameOf(robot);
    return `${clock(at)} ${name ? `${name}: ` : ""}${text}`;
  }
}

const rank = (kind) => KINDS.indexOf(kind);

/** The marks that are drawn, the gravest last: it covers those beside it. */
function byRank(buckets) {
  return [...buckets].sort(([, a], [, b]) => rank(a) - rank(b));
}

/** A time of day here [s since 1970]. */
function clock(seconds) {
  return new Date(seconds * 1000).toLocaleTimeString("en-GB");
}

function duration(seconds) {
  const whole = Math.max(0, Math.round(seconds));
  const [hours, minutes, rest] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, String(whole % 60).padStart(2, "0")];
  return hours ? `${hours}:${String(minutes).padStart(2, "0")}:${rest}` : `${minutes}:${rest}`;
}
