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

/** @param stop, emergencyStop, reset, resetAll function() */
export function listenToStops({ stop, emergencyStop, reset, resetAll }) {
  const byId = (id) => document.getElementById(id);
  onPress(byId("stop"), stop);
  onPress(byId("estop"), emergencyStop);
  byId("reset").addEventListener("click", reset);
  byId("reset-all").addEventListener("click", resetAll);
}

/** Shows whether the emergency stop is latched. */
export function showStops(latched, usable) {
  const estop = document.getElementById("estop");
  const text = document.getElementById("estop-text");
  document.body.classList.toggle("latched", latched);
  document.getElementById("reset").disabled = !usable;
  estop.setAttribute("aria-pressed", String(latched));
  const words = latched ? "LATCHED" : "E-STOP";
  if (text.textContent !== words) text.textContent = words;
}
