// Every way in which the user can lose hold of the page. Each must stop the robot.

const EVENTS = {
  blur: "the window lost the focus",
  pagehide: "the page was left",
  orientationchange: "the screen turned",
  touchcancel: "the touch was taken away",
  offline: "this device has no network",
};

/** Calls `abandon` with the reason whenever the page may no longer notice that the user lets go. */
export function watchForLoss(abandon) {
  for (const [name, why] of Object.entries(EVENTS)) addEventListener(name, () => abandon(why));
  addEventListener("pointercancel", ({ target }) => {
    // a second finger that begins to scroll elsewhere is taken away as well, and holds nothing
    if (!(target instanceof Element) || target.closest(".pad")) abandon("the touch was taken away");
  });
  document.addEventListener("visibilitychange", () => document.hidden && abandon("the page was hidden"));
  document.addEventListener("freeze", () => abandon("the page was put to sleep"));
  screen.orientation?.addEventListener?.("change", () => abandon("the screen turned"));
  addEventListener("contextmenu", (event) => {
    event.preventDefault();
    abandon("a menu opened");
  });
}
