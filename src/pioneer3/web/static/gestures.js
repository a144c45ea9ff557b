// Fingers and mouse on the canvas -> View: drag, pinch, wheel, double tap.

const DOUBLE_TAP = 320; // ms
const TAP_RADIUS = 24; // px
const WHEEL = 0.0016; // zoom per wheel pixel

export function listenToCanvas(canvas, view, changed) {
  const fingers = new Map(); // pointerId -> {x, y}
  let lastTap = { at: -Infinity, x: 0, y: 0 };
  let moved = false;

  const place = (event) => ({ x: event.offsetX, y: event.offsetY });

  canvas.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, place(event));
    if (fingers.size === 1) moved = false;
  });

  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
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
    if (!fingers.delete(event.pointerId) || moved || event.type !== "pointerup") return;
    const { x, y } = place(event);
    const near = Math.hypot(x - lastTap.x, y - lastTap.y) < TAP_RADIUS;
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
