// The stick on the screen, and the response curve of all sticks. The stick's middle is where the finger comes
// down, so that nothing jumps.

const REACH = 0.36; // of the shorter side: full deflection
const DEAD = 0.12;
const EXPO = 0.6;
const INPUT = "stick";

/**
 * @param element the stick; its properties --x and --y place the knob, -1 to 1
 * @param press   function(source, input, command): returns whether it is held now
 * @param move    function(input, command): returns whether it is still held
 * @param release function(input)
 * @param abandon function(): the system has taken the finger away
 */
export function listenToStick(element, { press, move, release, abandon }) {
  let finger = null; // {id, x, y, reach}: where it came down

  function show(x, y) {
    element.style.setProperty("--x", x.toFixed(3));
    element.style.setProperty("--y", y.toFixed(3));
  }

  function end(event) {
    if (event.pointerId !== finger?.id) return false;
    finger = null;
    show(0, 0);
    return true;
  }

  element.addEventListener("pointerdown", (event) => {
    if (finger !== null || (event.pointerType === "mouse" && event.button !== 0)) return;
    event.preventDefault();
    try {
      element.setPointerCapture(event.pointerId);
    } catch {
      return; // lifted already
    }
    if (!press("touch", INPUT, { forward: 0, left: 0 })) return;
    const { width, height } = element.getBoundingClientRect();
    finger = { id: event.pointerId, x: event.clientX, y: event.clientY, reach: REACH * Math.min(width, height) };
  });
  element.addEventListener("pointermove", (event) => {
    if (event.pointerId !== finger?.id) return;
    const { reach } = finger;
    const [x, y] = withinCircle((event.clientX - finger.x) / reach, (event.clientY - finger.y) / reach);
    const command = { forward: response(-y, DEAD, EXPO), left: response(-x, DEAD, EXPO) };
    if (move(INPUT, command)) show(x, y);
    else end(event); // it was stopped
  });
  element.addEventListener("pointerup", (event) => end(event) && release(INPUT));
  for (const taken of ["pointercancel", "lostpointercapture"]) {
    element.addEventListener(taken, (event) => end(event) && abandon());
  }
  // Otherwise a long press, which is how one drives, would open the context menu.
  element.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
  return { release: () => finger && end({ pointerId: finger.id }) };
}

/**
 * Returns the command of an axis, -1 to 1, by its deflection, -1 to 1; 0 inside the dead zone.
 *
 * @param value anything that is no number counts as the middle
 * @param dead  half width of the dead zone, 0 to 1
 * @param expo  0: in proportion; 1: by the cube, which is finer near the middle
 */
export function response(value, dead, expo = 0) {
  const out = Math.min(1, Math.abs(value));
  if (!(out > dead)) return 0;
  const part = (out - dead) / (1 - dead);
  return Math.sign(value) * (part * (1 - expo) + part ** 3 * expo);
}

/** Returns the point of the unit circle's disc that is nearest in the direction of x, y. */
function withinCircle(x, y) {
  const far = Math.max(1, Math.hypot(x, y));
  return [x / far, y / far];
}
