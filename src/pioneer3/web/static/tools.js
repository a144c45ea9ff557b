// The small buttons on the map, and their keys.

const byId = (id) => document.getElementById(id);

/** Buttons on the map. @param changed function(), after the view has changed */
export function listenToTools(view, { changed, clearTrail }) {
  const act = (id, action) => byId(id).addEventListener("click", () => {
    action();
    changed();
  });
  act("follow", () => view.setMode("follow"));
  act("fit", () => view.setMode("fit"));
  act("zoom-in", () => view.zoomBy(1.4));
  act("zoom-out", () => view.zoomBy(1 / 1.4));
  act("clear-trail", clearTrail);
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "f") view.toggle();
    else if (event.key === "+") view.zoomBy(1.25);
    else if (event.key === "-") view.zoomBy(0.8);
    else return;
    changed();
  });
}

export function showMode(mode) {
  for (const id of ["follow", "fit"]) byId(id).setAttribute("aria-pressed", String(mode === id));
}
