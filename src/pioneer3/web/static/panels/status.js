// The selected robot at a glance: the top bar, the numbers beside the map, and the notices over it.

import { byId, degrees, number, put, putHelp, putLines, putProse, set } from "../dom.js";

const TOAST = 4000; // ms
const BRIEF = 600; // ms that an expected reason to stand lasts before it is shown
let toastTimer = 0;
let shown = { why: "", since: 0 };

function showChip(id, text, level) {
  put(byId(id), text);
  set(byId(id), "data-level", level);
}

const setLevel = (id, level) => set(byId(id), "data-level", level);

/** @param robot {kind, name, shape, url} of the selected one, or null before any is known */
export function showRobot({ kind, name = "", shape = null, url = "" } = {}) {
  const badge = byId("badge");
  const known = Boolean(url); // without an address nothing has answered yet
  const label = known ? kind : "NOT CONNECTED";
  badge.textContent = label;
  badge.dataset.kind = known ? kind.toLowerCase() : "none";
  document.body.dataset.kind = badge.dataset.kind;
  badge.title = url;
  byId("name").textContent = name || "pioneer3";
  byId("title").textContent = shape?.title === name ? "" : shape?.title ?? "waiting for the robot";
  document.title = `${label}: ${name || "pioneer3"}`;
}

/**
 * @param model Model
 * @param retryAt when the socket tries again [performance.now()], or null
 * @param holder of the control lease: "you", a name, or "" for nobody
 */
export function showConnection(model, retryAt, holder) {
  if (!model.socketOpen) showChip("connection", retryAt === null ? "Connecting" : "Reconnecting", "bad");
  else if (model.status?.state === "lost") showChip("connection", "Robot lost", "bad");
  else if (model.status?.state === "connecting") showChip("connection", "Connecting", "warn");
  else if (!model.live) showChip("connection", "No news", "warn");
  else showChip("connection", "Connected", "good");
  if (!model.live) showChip("driver", "Driver unknown", "idle");
  else if (model.viewer && !model.replayed && !model.driver && !holder) showChip("driver", "You watch", "idle");
  else showChip("driver", ...driver(model, holder));
}

function driver({ driver: who, snapshot, program, replayed }, holder) {
  if (program) return ["A program drives", "you"];
  if (who === "you") return ["You drive", "you"];
  if (replayed) return [who ? `${snapshot.driver.name} drives` : "Nobody drives", "idle"];
  if (who === "other") return [`${snapshot.driver.name} drives`, "warn"];
  if (holder === "you") return ["You have control", "idle"];
  return [holder ? `${holder} has control` : "Nobody drives", "idle"];
}

/** Shows the numbers of a snapshot. */
export function showSnapshot(snapshot) {
  const { robot_in_map: pose, twist, battery, motors, bumpers } = snapshot;
  put(byId("speed-now"), number(twist.v, 2));
  put(byId("turn-now"), number(twist.w, 2));
  put(byId("pose"), `${number(pose.x, 2)}, ${number(pose.y, 2)}`);
  put(byId("pose-theta"), number(degrees(pose.theta), 0));
  showBattery(battery);
  showMotors(motors, bumpers);
}

function showBattery({ voltage, charge, charging, low }) {
  put(byId("voltage"), number(voltage, 1));
  put(byId("charge"), charge === null ? "not known" : `${number(charge * 100, 0)} %`);
  put(byId("charging"), charging);
  byId("charge-bar").style.width = `${Math.round((charge ?? 0) * 100)}%`;
  byId("low").hidden = !low;
  setLevel("battery", low ? "bad" : charge !== null && charge < 0.25 ? "warn" : "good");
}

function showMotors(motors, bumpers) {
  set(byId("motors"), "aria-checked", String(motors.enabled));
  put(byId("motors-text"), motors.enabled ? "On" : "Off");
  const hit = [...bumpers.front, ...bumpers.rear].some(Boolean);
  const alarm = motors.stop_button ? "Stop button" : motors.stalled ? "Stalled" : hit ? "Bumper" : "";
  put(byId("motors-alarm"), alarm);
  byId("motors-alarm").hidden = alarm === "";
}

/** Shows the round trip [ms] and the rate of reports [1/s]. */
export function showLink(roundTrip, rate, live) {
  put(byId("round-trip"), roundTrip === null ? "–" : number(roundTrip, 0));
  if (!live || roundTrip === null) setLevel("link", "idle");
  else if (roundTrip > 300 || rate < 5) setLevel("link", "bad");
  else if (roundTrip > 120 || rate < 8) setLevel("link", "warn");
  else setLevel("link", "good");
}

/** Enables the switch of the motors, or disables it. */
export function showUsable(usable) {
  byId("motors").disabled = !usable;
}

/**
 * Shows why the robot stands, in the colour of a warning only for a fault.
 * @param hint shown while the robot has nothing to do, or something has stopped it
 */
export function showWhy({ why, standing, symptom, mode, faults, parting }, hint) {
  const text = standing === "idle" || standing === "stopped" ? hint : standing === "normal" && mode ? "" : why ?? ""; // the card of the mode says it
  if (text !== shown.why) shown = { why: text, since: performance.now() };
  const brief = standing === "normal" && performance.now() - shown.since < BRIEF;
  putHelp(byId("why"), brief ? "" : text, standing === "fault" ? symptom : null);
  byId("why").classList.toggle("fault", standing === "fault");
  putLines(byId("faults"), parting ? [...faults, `Not as its twin: ${parting.why}`] : faults);
}

/** Shows that simulated time is paused, in place of any other reason. */
export function showPause() {
  putHelp(byId("why"), "Simulated time is paused.", null);
  byId("why").classList.remove("fault");
}

/** Greys the map while it shows old data. */
export function showOverlay(model, retryAt) {
  const [title, text] = reason(model, retryAt);
  document.body.classList.toggle("stale", title !== "");
  byId("overlay").hidden = title === "";
  put(byId("overlay-title"), title);
  put(byId("overlay-text"), text);
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
  if (element.hidden) element.replaceChildren(); // so that it is read out again
  putProse(element, text);
  element.hidden = false;
  clearTimeout(toastTimer);
  toastTimer = setTimeout(() => (element.hidden = true), lasts);
}
