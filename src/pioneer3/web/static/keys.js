// The keyboard -> Drive. Space stops and K is the emergency stop wherever the focus is, save where texts are written.

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
 * @param press   function(source, input, wish): asks to drive
 * @param release function(input)
 * @param stop    function(): the user wants a stop
 * @param emergencyStop function(): the user wants everything to stop, at once and for good
 * @param abandon function(): key releases may go unnoticed from here on
 */
export function listenToKeys({ press, release, stop, emergencyStop, abandon }) {
  const down = new Set();

  addEventListener("keydown", (event) => {
    if (isWriting(event.target)) return;
    const stops = event.code === "Space" ? stop : isEmergency(event) ? emergencyStop : null;
    if (stops) {
      event.preventDefault(); // else a space would press the focused button
      if (!event.repeat) stops();
      return;
    }
    if (event.key === "Meta") return abandon(); // macOS tells no keyup of keys let go under it
    const wish = KEYS[event.code];
    if (down.has(event.code)) return event.preventDefault(); // a repeat, even if a slider has the focus now
    if (!wish || event.ctrlKey || event.altKey || event.metaKey || isTyping(event.target)) return;
    event.preventDefault();
    if (event.repeat) return;
    down.add(event.code);
    press("keyboard", event.code, wish);
  }, { capture: true });

  addEventListener("keyup", (event) => {
    if (event.code === "Space" && !isWriting(event.target)) event.preventDefault(); // else it would click the focused button
    down.delete(event.code);
    release(event.code);
  }, { capture: true });

  addEventListener("blur", () => down.clear());
  // where text is written the keys that stop are letters: nothing goes on being driven meanwhile
  addEventListener("focusin", ({ target }) => isWriting(target) && abandon("a text field has the focus"));
}

/** By its letter or its place: on layouts where they differ both count. */
function isEmergency({ code, key, ctrlKey, altKey, metaKey }) {
  return (code === "KeyK" || key === "k" || key === "K") && !ctrlKey && !altKey && !metaKey;
}

/** Whether the focus is where a space is part of a text. */
function isWriting(target) {
  return target instanceof Element
    && target.matches('textarea, [contenteditable], input:is([type="text"], [type="search"], [type="url"], [type="email"], [type="password"], :not([type]))');
}

function isTyping(target) {
  return target instanceof Element && target.matches("input, textarea, select, [contenteditable]");
}
