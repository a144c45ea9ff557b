// The time axis that all plots share: it grows with the history, and is zoomed and moved by hand.

import { History } from "./history.js";

const WHOLE = [10, 20, 30, 60, 120, History.SPAN]; // s, so that it does not creep
const LEAST = 2; // s
const MARKS = [0.5, 1, 2, 5, 10, 30, 60]; // s between marks
const MOST_MARKS = 6;
const WHEEL = 0.002; // of a zoom for a pixel of the wheel
const CLICK = 4; // px that a finger or mouse moves before it moves the axis

export class TimeAxis {
  #changed;
  #span = null; // s, null for all
  #end = null; // s since 1970, null for now
  #now = 0;
  #since = 0;

  /** @param changed function(), after it was zoomed or moved */
  constructor(changed) {
    this.#changed = changed;
  }

  /** Takes the time, and that of the oldest reading or null [s since 1970]. */
  note(now, since) {
    [this.#now, this.#since] = [now, since ?? now];
  }

  get #whole() {
    return WHOLE.find((span) => span >= this.#now - this.#since) ?? History.SPAN;
  }

  get now() {
    return this.#now;
  }

  get span() {
    return Math.min(this.#span ?? Infinity, this.#whole);
  }

  get to() {
    const earliest = Math.min(this.#now, this.#since + this.span);
    return this.#end === null ? this.#now : Math.min(this.#now, Math.max(this.#end, earliest));
  }

  get from() {
    return this.to - this.span;
  }

  /** Whether it ends now, and goes along with it. */
  get follows() {
    return this.#end === null;
  }

  /** Whether all is shown. */
  get isWhole() {
    return this.#span === null && this.follows;
  }

  /** Shows `factor` times as much, about a time [s]; without one about now or the middle. */
  zoom(factor, about = this.follows ? this.to : this.to - this.span / 2) {
    const [to, span] = [this.to, this.span];
    const wanted = Math.max(LEAST, span * factor);
    if (wanted >= this.#whole) return this.reset();
    this.#span = wanted;
    this.#endAt(about + ((to - about) * wanted) / span);
  }

  /** Moves to later times [s]. */
  move(seconds) {
    this.#endAt(this.to + seconds);
  }

  /** Shows all, until now. */
  reset() {
    this.#span = this.#end = null;
    this.#changed();
  }

  #endAt(time) {
    this.#end = time >= this.#now - 1e-3 ? null : Math.max(time, this.#since + this.span);
    this.#changed();
  }

  /** Times of marks [s since 1970]. */
  get marks() {
    const step = MARKS.find((each) => this.span / each <= MOST_MARKS) ?? MARKS.at(-1);
    const first = Math.ceil((this.#now - this.to) / step - 1e-6);
    const last = Math.floor((this.#now - this.from) / step + 1e-6);
    return Array.from({ length: last - first + 1 }, (_, i) => this.#now - (last - i) * step);
  }

  /** The shown time in words. */
  get words() {
    const length = spoken(this.span);
    return this.follows ? `the last ${length}` : `${length} until ${spoken(this.#now - this.to)} ago`;
  }

  /** How long ago a time was, as marks say it. */
  ago(time) {
    const seconds = Math.round((this.#now - time) * 10) / 10;
    if (seconds === 0) return "now";
    const [minutes, rest] = [Math.floor(seconds / 60), seconds % 60];
    if (minutes === 0) return `−${seconds} s`;
    return rest ? `−${minutes}:${String(Math.round(rest)).padStart(2, "0")}` : `−${minutes} min`;
  }

  /** Drag or one finger moves it; two fingers, or the wheel with Ctrl, zoom; a double click shows all. */
  listen(box) {
    const fingers = new Map(); // pointer -> x
    let moved = 0;
    const over = ({ target }) => target.closest?.(".u-over");
    const timeAt = (plot, x) => {
      const { left, width } = plot.getBoundingClientRect();
      return this.from + ((x - left) / width) * this.span;
    };
    box.addEventListener("pointerdown", (event) => {
      if (!over(event) || event.button !== 0) return;
      if (fingers.size === 0) moved = 0;
      fingers.set(event.pointerId, event.clientX);
    });
    addEventListener("pointermove", ({ pointerId, clientX }) => {
      if (!fingers.has(pointerId)) return;
      const plot = box.querySelector(".u-over");
      const perPixel = this.span / plot.clientWidth;
      const before = [...fingers.values()];
      const by = clientX - fingers.get(pointerId);
      moved += Math.abs(by);
      fingers.set(pointerId, clientX);
      if (fingers.size === 2) {
        const after = [...fingers.values()];
        const apart = ([a, b]) => Math.max(10, Math.abs(a - b));
        this.move((-by / 2) * perPixel);
        this.zoom(apart(before) / apart(after), timeAt(plot, (after[0] + after[1]) / 2));
      } else if (fingers.size === 1 && moved >= CLICK) this.move(-by * perPixel);
    });
    for (const name of ["pointerup", "pointercancel"]) addEventListener(name, ({ pointerId }) => fingers.delete(pointerId));
    box.addEventListener("wheel", (event) => {
      const plot = over(event);
      const sideways = Math.abs(event.deltaX) > Math.abs(event.deltaY);
      if (!plot || !(event.ctrlKey || event.metaKey || sideways)) return; // it scrolls the view
      event.preventDefault();
      if (sideways) this.move((event.deltaX * this.span) / plot.clientWidth);
      else this.zoom(Math.exp(event.deltaY * WHEEL), timeAt(plot, event.clientX));
    }, { passive: false });
    box.addEventListener("dblclick", (event) => over(event) && this.reset());
  }
}

function spoken(seconds) {
  const count = (value, unit) => `${value} ${unit}${value === 1 ? "" : "s"}`;
  const whole = Math.round(seconds);
  return whole >= 120 && whole % 60 === 0 ? count(whole / 60, "minute") : count(whole, "second");
}
