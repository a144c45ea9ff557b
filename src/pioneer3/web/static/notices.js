// What must be read: why it does not move, a lost connection, a refusal.

const byId = (id) => document.getElementById(id);
const TOAST = 4000; // ms
const BRIEF = 600; // ms that an expected reason to stand lasts before it is shown
let toastTimer = 0;
let shown = { why: "", since: 0 };

function put(id, text) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
}

/**
 * Shows why the robot stands: in the colour of a warning only what must be mended.
 * @param hint what to do with a robot that nobody asks for anything
 */
export function showWhy({ why, standing, mode, faults }, hint) {
  const text = standing === "idle" ? hint : standing === "normal" && mode ? "" : why ?? ""; // a mode's card tells its own
  if (text !== shown.why) shown = { why: text, since: performance.now() };
  const brief = standing === "normal" && performance.now() - shown.since < BRIEF;
  put("why", brief ? "" : text);
  byId("why").classList.toggle("fault", standing === "fault");
  list("faults", faults);
}

function list(id, lines) {
  const element = byId(id);
  const key = lines.join("\n");
  if (element.dataset.key === key) return;
  element.dataset.key = key;
  element.replaceChildren(...lines.map((line) => {
    const item = document.createElement("li");
    item.textContent = line;
    return item;
  }));
}

/** Time stands still: so does all the rest. */
export function showPause() {
  put("why", "Simulated time is paused.");
  byId("why").classList.remove("fault");
}

/** Greys the scene while what it shows is old. */
export function showOverlay(model, retryAt) {
  const [title, text] = reason(model, retryAt);
  document.body.classList.toggle("stale", title !== "");
  byId("overlay").hidden = title === "";
  put("overlay-title", title);
  put("overlay-text", text);
}

function reason(model, retryAt) {
  if (!model.socketOpen) {
    if (retryAt === null) return ["Connecting", "Looking for the driver on this address."];
    const seconds = Math.max(0, Math.ceil((retryAt - performance.now()) / 1000));
    return ["Connection lost", `A robot you drove stops by itself. Next try in ${seconds} s.`];
  }
  if (model.own?.plugged === false) {
    return ["Cable unplugged", "To put it in again, edit the world and select the robot."];
  }
  if (model.status?.state === "lost") return ["Robot lost", model.status.message];
  if (model.status?.state === "connecting") return ["Connecting to the robot", model.status.message];
  if (model.world.paused) return ["", ""];
  if (!model.live) return [model.snapshot ? "No news from the robot" : "Waiting for the robot", "The picture may be old."];
  return ["", ""];
}

/** A short message that goes away by itself after some time [ms]. */
export function toast(text, lasts = TOAST) {
  const element = byId("toast");
  if (element.hidden || element.textContent !== text) element.textContent = text; // else it would be read out again
  element.hidden = false;
  clearTimeout(toastTimer);
  toastTimer = setTimeout(() => (element.hidden = true), lasts);
}
