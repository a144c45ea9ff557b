// The keyboard -> Drive. Space stops whatever has the focus.

const KEYS = {
  ArrowUp: ["forward"],
  ArrowDown: ["back"],
  ArrowLeft: ["left"],
  ArrowRight: ["right"],
  KeyW: ["forward"],
  KeyS: ["back"],
  KeyA: ["left"],
  KeyD: ["right"],
};

/**
 * @param press   function(input, directions): asks to drive
 * @param release function(input)
 * @param stop    function(): the user wants a stop
 * @param abandon function(): key releases may go unnoticed from here on
 */
export function listenToKeys({ press, release, stop, abandon }) {
  const down = new Set();

  addEventListener("keydown", (event) => {
    if (event.code === "Space") {
      event.preventDefault();
      if (!event.repeat) stop();
      return;
    }
    if (event.key === "Meta") return abandon(); // macOS tells no keyup of keys let go under it
    const directions = KEYS[event.code];
    if (down.has(event.code)) return event.preventDefault(); // a repeat, even if a slider has the focus now
    if (!directions || event.ctrlKey || event.altKey || event.metaKey || isTyping(event.target)) return;
    event.preventDefault();
    if (event.repeat) return;
    down.add(event.code);
    press(event.code, directions);
  }, { capture: true });

  addEventListener("keyup", (event) => {
    if (event.code === "Space") event.preventDefault(); // else it would click the focused button
    down.delete(event.code);
    release(event.code);
  }, { capture: true });

  addEventListener("blur", () => down.clear());
}

function isTyping(target) {
  return target instanceof Element && target.matches("input, textarea, select, [contenteditable]");
}
