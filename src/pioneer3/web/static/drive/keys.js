// The keyboard and the arrows on the screen. Space stops and K is the emergency stop wherever the focus is,
// except in text fields.

import { hasModifier, isTyping } from "../dom.js";

const KEYS = {
  ArrowUp: { forward: 1, left: 0 },
  ArrowDown: { forward: -1, left: 0 },
  ArrowLeft: { forward: 0, left: 1 },
  ArrowRight: { forward: 0, left: -1 },
  KeyW: { forward: 1, left: 0 },
  KeyS: { forward: -1, left: 0 },
  KeyA: { forward: 0, left: 1 },
  KeyD: { forward: 0, left: -1 },
};

/**
 * The keyboard.
 * @param press   function(source, input, command)
 * @param release function(input)
 * @param stop    function()
 * @param emergencyStop function()
 * @param abandon function(): key releases may go unnoticed from here on
 */
export function listenToKeys({ press, release, stop, emergencyStop, abandon }) {
  const down = new Set();

  addEventListener("keydown", (event) => {
    if (isTextField(event.target)) return;
    const stops = event.code === "Space" ? stop : isEmergency(event) ? emergencyStop : null;
    if (stops) {
      event.preventDefault(); // else a space would press the focused button
      if (!event.repeat) stops();
      return;
    }
    if (event.key === "Meta") return abandon(); // macOS sends no keyup of keys that are released meanwhile
    const command = KEYS[event.code];
    if (down.has(event.code)) return event.preventDefault(); // a repeat, even if a slider has the focus now
    if (!command || hasModifier(event) || isTyping(event)) return;
    event.preventDefault();
    if (event.repeat) return;
    down.add(event.code);
    press("keyboard", event.code, command);
  }, { capture: true });

  addEventListener("keyup", (event) => {
    if (event.code === "Space" && !isTextField(event.target)) event.preventDefault(); // else it would click the focused button
    down.delete(event.code);
    release(event.code);
  }, { capture: true });

  addEventListener("blur", () => down.clear());
  // in a text field the keys that stop are letters, so nothing may be driven meanwhile
  addEventListener("focusin", ({ target }) => isTextField(target) && abandon("a text field has the focus"));
}

/** By its letter or its place: on layouts where they differ both count. */
function isEmergency(event) {
  const { code, key } = event;
  return (code === "KeyK" || key === "k" || key === "K") && !hasModifier(event);
}

/** Whether a space is part of a text here. */
function isTextField(target) {
  return target instanceof Element
    && target.matches('textarea, [contenteditable], input:is([type="text"], [type="search"], [type="url"], [type="email"], [type="password"], :not([type]))');
}

/**
 * The arrows on the screen. Each finger holds the button on which it came down until it is lifted.
 * @param buttons elements with data-go="forward left"
 * @param press   function(source, input, command)
 * @param release function(input)
 * @param abandon function(why): the system has taken the finger away
 */
export function listenToPad(buttons, { press, release, abandon }) {
  const fingers = new Set();
  const input = (event) => `pointer ${event.pointerId}`;

  function command({ dataset: { go } }) {
    return { forward: go.includes("forward") - go.includes("back"), left: go.includes("left") - go.includes("right") };
  }

  function down(event) {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    event.preventDefault();
    try {
      event.currentTarget.setPointerCapture(event.pointerId);
    } catch {
      return; // lifted already
    }
    fingers.add(event.pointerId);
    press("touch", input(event), command(event.currentTarget));
  }

  function up(event) {
    if (fingers.delete(event.pointerId)) release(input(event));
  }

  function taken(event) {
    if (fingers.delete(event.pointerId)) abandon("the touch was taken away");
  }

  for (const button of buttons) {
    button.addEventListener("pointerdown", down);
    button.addEventListener("pointerup", up);
    button.addEventListener("pointercancel", taken);
    button.addEventListener("lostpointercapture", taken);
    // Otherwise a long press, which is how one drives, would open the context menu.
    button.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
  }
}
