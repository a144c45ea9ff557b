// The on-screen arrows -> Drive. Each finger holds the button it came down on until it is lifted.

/**
 * @param buttons elements with data-go="forward left"
 * @param press   function(source, input, wish): asks to drive
 * @param release function(input)
 * @param abandon function(why): the finger was taken away by the system
 */
export function listenToPad(buttons, { press, release, abandon }) {
  const fingers = new Set();
  const input = (event) => `pointer ${event.pointerId}`;

  function wish({ dataset: { go } }) {
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
    press("touch", input(event), wish(event.currentTarget));
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
