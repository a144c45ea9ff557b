// The stick on the screen -> Drive. It begins where the finger comes down, so that nothing jumps,
// and is in the middle again when the finger is lifted.

import { response, withinCircle } from "./response.js";

const REACH = 0.36; // of the shorter side: so far is all the way
const DEAD = 0.12;
const GENTLE = 0.6;
const INPUT = "stick";

/**
 * @param element what is pressed; its properties --x and --y say where to draw the knob, -1 to 1
 * @param press   function(source, input, wish): asks to drive; says whether it may
 * @param move    function(input, wish): says whether it is still held
 * @param release function(input)
 * @param abandon function(): the finger was taken away by the system
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
    const wish = { forward: response(-y, DEAD, GENTLE), left: response(-x, DEAD, GENTLE) };
    if (move(INPUT, wish)) show(x, y);
    else end(event); // somebody stopped it
  });
  element.addEventListener("pointerup", (event) => end(event) && release(INPUT));
  for (const taken of ["pointercancel", "lostpointercapture"]) {
    element.addEventListener(taken, (event) => end(event) && abandon());
  }
  // Otherwise a long press, which is how one drives, would open the context menu.
  element.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
  return { letGo: () => finger && end({ pointerId: finger.id }) };
}
