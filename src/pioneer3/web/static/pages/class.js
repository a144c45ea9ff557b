// The teacher's page: all robots of the class small, and what can be done about each and about all.

import { confirmed } from "../classroom/confirm.js";
import { Invitation } from "../classroom/invitation.js";
import { showRuns } from "../classroom/runs.js";
import { openToTakeOver } from "../classroom/take_over.js";
import { Tiles } from "../classroom/tiles.js";
import { Connection } from "../connection.js";
import { byId, hasModifier, isTyping, put, set } from "../dom.js";
import { StopQueue, onPress, showTrouble } from "../drive/stops.js";
import { checkPairing } from "../http.js";
import { Model } from "../model/model.js";
import { toast } from "../panels/status.js";

const CHECK = 250; // ms between checks of the age of the data
const DELAY = 190; // ms, of drawn poses: snapshots come five times a second

const model = new Model(DELAY);
/** @type {import("../messages.d.ts").Class | null} */
let told = null;
const tiles = new Tiles({ model, act });
const invitation = new Invitation({ notify: toast });
const connection = new Connection({ onMessage: receive, onChange: connected, onLost: () => checkPairing(), query: "?view=class" });
const stops = new StopQueue({
  send: (message) => connection.send(message),
  ping: () => connection.ping(),
  delivered: () => toast("The stop has arrived, late."),
});

function receive(message) {
  model.receive(message);
  if (message.type === "hello") takeHello(message);
  else if (message.type === "map") tiles.adoptMap(message.map);
  else if (message.type === "class") takeClass(message);
  else if (message.type === "class_robots") takeSnapshots(message);
  else if (["told", "refused", "edit_refused"].includes(message.type)) toast(message.message);
  else if (message.type === "pong") stops.acknowledge(message.t);
}

function takeHello({ class: member }) {
  if (member && !member.teacher) return location.replace("/"); // a student's page is there
  put(byId("lost"), member ? "" : "No class is held here. “pioneer3 class” starts one.");
  tiles.adopt();
  show();
}

function takeClass(message) {
  told = message;
  invitation.show(message);
  showRuns(message.handed_in);
  show();
}

/** @param {import("../messages.d.ts").ClassRobots} message */
function takeSnapshots({ snapshots }) {
  for (const { robot_in_map: [x, y, theta], ...snapshot } of snapshots) {
    model.robots.get(snapshot.robot)?.takeSnapshot({ ...snapshot, robot_in_map: { x, y, theta } });
  }
  tiles.moved();
  show();
}

function connected() {
  stops.flush(connection.open);
  show();
}

/** Shows all that may have changed. */
function show() {
  model.setSocket(connection.open);
  const [words, level] = connection.open ? ["Connected", "good"] : [connection.retryAt === null ? "Connecting" : "Reconnecting", "bad"];
  put(byId("connection"), words);
  set(byId("connection"), "data-level", level);
  document.body.classList.toggle("no-connection", !connection.open);
  if (!connection.open) put(byId("lost"), told ? "Connection lost. This is how it was before." : "");
  showTrouble(stops.trouble);
  if (told === null) return;
  if (connection.open) put(byId("lost"), "");
  tiles.show(told);
  showAll();
}

function showAll() {
  const { paused, locked, shared } = told;
  document.body.classList.toggle("all-paused", paused);
  put(byId("pause-all-text"), paused ? "Go on" : "Pause all");
  put(byId("paused"), paused ? "All robots are paused: they stand, and nobody can drive." : "");
  put(byId("lock"), locked ? "Let students join" : "Lock joining");
  set(byId("lock"), "aria-pressed", String(locked));
  set(byId("share"), "aria-pressed", String(shared));
  const latched = [...model.robots.values()].filter(({ snapshot }) => snapshot?.emergency_stop);
  byId("latched").hidden = latched.length === 0;
  const which = latched.length === model.robots.size ? "of all robots" : `of ${latched.map(({ id }) => nameOf(id)).join(", ")}`;
  put(byId("latched-words"), latched.length ? `EMERGENCY STOP ${which}: motors off until it is reset.` : "");
}

const seatOf = (id) => told?.seats.find(({ robot }) => robot === id);
const nameOf = (id) => seatOf(id)?.name ?? `robot ${id}`;

function send(message) {
  if (!connection.send(message)) toast("Not connected: nothing was changed.");
}

/** Carries out a button of a robot's tile. */
async function act(name, id) {
  if (name === "take") {
    if (!openToTakeOver(id)) toast("The browser did not open a tab: let this site open them.");
  } else if (name === "pause") {
    send({ type: "pause_robots", paused: !seatOf(id)?.paused, robot: id });
  } else if (name === "back") {
    if (await confirmed(`Put ${nameOf(id)} back?`, "The robot stops, and stands where it began.", "Put back")) send({ type: "put_back", robot: id });
  } else if (await confirmed(`Free the seat of ${nameOf(id)}?`, "The student is shown out, and the robot is for somebody else. Runs that were handed in stay.", "Free the seat")) {
    send({ type: "free_seat", robot: id });
  }
}

/** Pauses all robots: also later, when there is a connection again. */
function pauseAll() {
  stops.add({ type: "pause_robots", paused: true });
  connection.retryNow();
  show();
}

/** The emergency stop of all robots. They stay paused when it is reset, so that no program drives on by itself. */
function stopAll() {
  stops.add({ type: "emergency_stop" });
  pauseAll();
}

function resetAll() {
  for (const { id, snapshot } of model.robots.values()) if (snapshot?.emergency_stop) send({ type: "reset_emergency_stop", robot: id });
}

function listenToKeys() {
  addEventListener("keydown", (event) => {
    if (isTyping(event)) return;
    const stop = event.code === "Space" ? pauseAll : event.key.toLowerCase() === "k" && !hasModifier(event) ? stopAll : null;
    if (!stop) return;
    event.preventDefault(); // else a space would press the focused button
    if (!event.repeat) stop();
  }, { capture: true });
  addEventListener("keyup", (event) => {
    if (event.code === "Space" && !isTyping(event)) event.preventDefault(); // else it would click the focused button
  }, { capture: true });
}

onPress(byId("stop-all"), stopAll);
byId("pause-all").addEventListener("click", () => (told?.paused ? send({ type: "pause_robots", paused: false }) : pauseAll()));
byId("reset-all").addEventListener("click", resetAll);
byId("lock").addEventListener("click", () => send({ type: "lock_joining", locked: !told?.locked }));
byId("share").addEventListener("click", () => send({ type: "share_addresses", shared: !told?.shared }));
byId("put-all-back").addEventListener("click", async () => {
  if (await confirmed("Put all robots back?", "They stop, and stand where they began.", "Put all back")) send({ type: "put_back" });
});
byId("runs-open").addEventListener("click", () => byId("runs").showModal());
byId("runs-close").addEventListener("click", () => byId("runs").close());
listenToKeys();
setInterval(show, CHECK);
connection.connect();

/** The state for tests, frozen. */
Object.defineProperty(window, "pioneer3", {
  value: Object.freeze({
    get state() {
      return Object.freeze({
        class: told,
        connected: connection.open,
        robots: [...model.robots.values()].map(({ id, snapshot }) => ({ id, snapshot })),
        pictures: tiles.pictures,
      });
    },
  }),
});
