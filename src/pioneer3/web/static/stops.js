// The stop buttons. They act when pressed, not when let go; resetting needs a full click.

/** Calls `act` on press of the button, by pointer or by keyboard. */
function onPress(button, act) {
  let byPointer = false;
  button.addEventListener("pointerdown", () => {
    byPointer = true;
    act();
  });
  button.addEventListener("click", () => {
    if (!byPointer) act(); // Enter, or an assistive technology
    byPointer = false;
  });
}

/** @param stop, emergencyStop, reset function() */
export function listenToStops({ stop, emergencyStop, reset }) {
  const byId = (id) => document.getElementById(id);
  onPress(byId("stop"), stop);
  onPress(byId("estop"), emergencyStop);
  byId("reset").addEventListener("click", reset);
}

/** Shows whether the emergency stop is latched. */
export function showStops(latched, usable) {
  const reset = document.getElementById("reset");
  const estop = document.getElementById("estop");
  document.body.classList.toggle("latched", latched);
  reset.hidden = !latched;
  reset.disabled = !usable;
  estop.setAttribute("aria-pressed", String(latched));
  const text = latched ? "LATCHED" : "E-STOP";
  if (estop.textContent !== text) estop.textContent = text;
}
