// Every way in which the user can lose hold of the page. Each must stop the robot.

/** Calls `abandon` whenever the page may no longer notice that the user lets go. */
export function watchForLoss(abandon) {
  for (const name of ["blur", "pagehide", "orientationchange", "touchcancel", "pointercancel"]) {
    addEventListener(name, abandon);
  }
  document.addEventListener("visibilitychange", () => document.hidden && abandon());
  document.addEventListener("freeze", abandon);
  screen.orientation?.addEventListener?.("change", abandon);
  addEventListener("contextmenu", (event) => {
    event.preventDefault();
    abandon();
  });
}
