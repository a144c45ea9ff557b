// Fingers and mouse on the canvas -> View: drag, pinch, wheel, double tap; or -> Editor, if it takes them.

const DOUBLE_TAP = 320; // ms
const TAP_RADIUS = 24; // px
const WHEEL = 0.0016; // zoom per wheel pixel

/**
 * @param editor {take, drag, drop, cancel, hovers, select}: gets the fingers that it takes
 * @param changed function(), after the view has changed
 */
export function listenToCanvas(canvas, view, editor, changed) {
  const fingers = new Map(); // pointerId -> {x, y}
  let held = null; // the finger that the editor has: {id, at}
  let lastTap = { at: -Infinity, x: 0, y: 0 };
  let moved = false;

  const place = (event) => ({ x: event.offsetX, y: event.offsetY });

  canvas.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    if (held) giveBack();
    else if (fingers.size === 0 && editor.take(place(event), event.pointerType)) {
      held = { id: event.pointerId, at: place(event) };
      return;
    }
    fingers.set(event.pointerId, place(event));
    if (fingers.size === 1) moved = false;
  });

  /** A second finger makes a pinch of what was the editor's. */
  function giveBack() {
    editor.cancel();
    fingers.set(held.id, held.at);
    held = null;
    moved = true;
  }

  canvas.addEventListener("pointermove", (event) => {
    if (held?.id === event.pointerId) {
      held.at = place(event);
      return editor.drag(held.at);
    }
    const before = fingers.get(event.pointerId);
    if (!before) {
      if (!held) canvas.classList.toggle("over", editor.hovers(place(event)));
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
      held = null;
      if (event.type === "pointerup") editor.drop();
      else editor.cancel();
      return;
    }
    if (!fingers.delete(event.pointerId) || moved || event.type !== "pointerup") return;
    const { x, y } = place(event);
    const near = Math.hypot(x - lastTap.x, y - lastTap.y) < TAP_RADIUS;
    editor.select(null); // the floor was tapped
    if (near && event.timeStamp - lastTap.at < DOUBLE_TAP) {
      view.toggle();
      lastTap.at = -Infinity;
      changed();
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

  canvas.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
}
