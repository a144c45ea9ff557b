// Pointers on the canvas: drag, pinch, wheel and double tap move the view, others go to the editor or the goal;
// the readout of the pointer's position; the buttons and keys of the view.

import { byId, hasModifier, number, put } from "../dom.js";

const DOUBLE_TAP = 320; // ms
const TAP_RADIUS = 24; // px
const HOLD = 500; // ms; a finger that stays this long means the place
const MODES = ["follow", "fit", "eyes"]; // of the view, as its buttons are called
const WHEEL = 0.0016; // zoom per wheel pixel

/** Steps of a thing or a goal that is moved by keys: [dx, dy] [m], and a turn [rad]. */
export const STEPS = { ArrowUp: [0, 0.1], ArrowDown: [0, -0.1], ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0] };
export const TURN = Math.PI / 12;

/** The kind of a pointer, by which distances differ. */
export const kindOf = (pointerType) => (pointerType === "mouse" ? "mouse" : "touch");

/**
 * @param takers  [{take, drag, drop, cancel, hovers}]: the first that takes a pointer has it
 * @param changed function(), after the view has changed
 * @param tap     function(point, pointerType, event): a tap that no taker has; returns whether it is used up:
 *                then it is no half of a double tap
 * @param twice   function(), after a double tap, which shows all or follows
 * @param longPress function(point, pointerType): a finger stays; returns the taker that has it, or null
 */
export function listenToCanvas(canvas, view, { takers, changed, tap, twice, longPress }) {
  const fingers = new Map(); // pointerId -> {x, y}
  let held = null; // the pointer that a taker has: {id, at, by}
  let lastTap = { at: -Infinity, x: 0, y: 0 };
  let moved = false;
  let timer = 0;

  const place = (event) => ({ x: event.offsetX, y: event.offsetY });

  canvas.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    clearTimeout(timer);
    const at = place(event);
    if (held) giveBack();
    else if (fingers.size === 0) {
      const by = takers.find((taker) => taker.take(at, event.pointerType));
      if (by) {
        held = { id: event.pointerId, at, by };
        return;
      }
    }
    fingers.set(event.pointerId, at);
    if (fingers.size > 1) return;
    moved = false;
    if (event.pointerType !== "mouse") timer = setTimeout(() => stay(event.pointerId, at, event.pointerType), HOLD);
  });

  function stay(id, at, type) {
    if (moved || fingers.size !== 1) return;
    const by = longPress(at, type);
    if (!by) return;
    fingers.delete(id);
    held = { id, at, by };
  }

  /** With a second finger, the taker's pointer becomes half of a pinch. */
  function giveBack() {
    held.by.cancel();
    fingers.set(held.id, held.at);
    held = null;
    moved = true;
  }

  canvas.addEventListener("pointermove", (event) => {
    if (held?.id === event.pointerId) {
      held.at = place(event);
      return held.by.drag(held.at);
    }
    const before = fingers.get(event.pointerId);
    if (!before) {
      if (!held) canvas.classList.toggle("over", takers.some((taker) => taker.hovers(place(event))));
      return;
    }
    const now = place(event);
    const step = Math.hypot(now.x - before.x, now.y - before.y);
    if (!moved && fingers.size === 1 && step < 4) return; // a tap may tremble
    moved = true;
    fingers.set(event.pointerId, now);
    if (fingers.size === 1) view.panBy(now.x - before.x, now.y - before.y);
    else if (fingers.size === 2) pinch(event.pointerId, before, now);
    changed();
  });

  function pinch(id, before, now) {
    const [other] = [...fingers].filter(([key]) => key !== id).map(([, point]) => point);
    const spread = (point) => Math.max(1, Math.hypot(point.x - other.x, point.y - other.y));
    view.zoomBy(spread(now) / spread(before), (now.x + other.x) / 2, (now.y + other.y) / 2);
    if (view.mode !== "follow") view.panBy((now.x - before.x) / 2, (now.y - before.y) / 2);
  }

  function lift(event) {
    if (held?.id === event.pointerId) {
      const { by } = held;
      held = null;
      if (event.type === "pointerup") by.drop();
      else by.cancel();
      return;
    }
    clearTimeout(timer);
    if (!fingers.delete(event.pointerId) || moved || event.type !== "pointerup") return;
    const { x, y } = place(event);
    const near = Math.hypot(x - lastTap.x, y - lastTap.y) < TAP_RADIUS;
    if (near && event.timeStamp - lastTap.at < DOUBLE_TAP) {
      view.toggle();
      lastTap.at = -Infinity;
      twice();
      changed();
    } else if (tap({ x, y }, event.pointerType, event)) {
      lastTap.at = -Infinity;
    } else {
      lastTap = { at: event.timeStamp, x, y };
    }
  }
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) canvas.addEventListener(name, lift);

  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1);
    view.zoomBy(Math.exp(-pixels * (event.ctrlKey ? 6 : 1) * WHEEL), event.offsetX, event.offsetY);
    changed();
  }, { passive: false });

  canvas.addEventListener("pointerleave", () => takers.forEach((taker) => taker.hovers({ x: -Infinity, y: -Infinity })));

  canvas.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
}

/** Shows the position under the mouse. */
export function listenToPointer(canvas, view) {
  const where = byId("where");
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerType !== "mouse") return;
    const { x, y } = view.toWorld(event.offsetX, event.offsetY);
    put(where, `${number(x, 2)}, ${number(y, 2)} m`);
    where.hidden = false;
  });
  canvas.addEventListener("pointerleave", () => (where.hidden = true));
}

/** Buttons and keys of the view that `view()` returns. @param changed function(), after the view has changed */
export function listenToTools(view, { changed, clearTrail }) {
  const act = (id, action) => byId(id).addEventListener("click", () => {
    action();
    changed();
  });
  for (const mode of MODES) act(mode, () => view().setMode(mode));
  act("zoom-in", () => view().zoomBy(1.4));
  act("zoom-out", () => view().zoomBy(1 / 1.4));
  act("clear-trail", clearTrail);
  addEventListener("keydown", (event) => {
    if (hasModifier(event)) return;
    if (event.key === "f") view().toggle();
    else if (event.key === "+") view().zoomBy(1.25);
    else if (event.key === "-") view().zoomBy(0.8);
    else return;
    changed();
  });
}

export function showMode(mode) {
  for (const id of MODES) byId(id).setAttribute("aria-pressed", String(mode === id));
}
