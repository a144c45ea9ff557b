// Joins the parts: messages -> model -> picture and numbers; inputs -> drive -> messages.

import { Connection } from "./connection.js";
import { Drive } from "./drive.js";
import { Editor } from "./editor.js";
import { listenToCanvas } from "./gestures.js";
import { watchForLoss } from "./guard.js";
import { showConnection, showHello } from "./header.js";
import { listenToKeys } from "./keys.js";
import { Limits } from "./limits.js";
import { Model } from "./model.js";
import { showOverlay, showPause, showWhy, toast } from "./notices.js";
import { listenToPad } from "./pad.js";
import { showLink, showSnapshot, showUsable } from "./panel.js";
import { Scene } from "./scene.js";
import { listenToStops, showStops } from "./stops.js";
import { listenToDisclosures, listenToTools, showMode } from "./tools.js";
import { View } from "./view.js";
import { Workbench } from "./workbench.js";

const CHECK = 250; // ms between looks at the age of what is shown
const PHONE = "(max-width: 760px), (max-height: 520px)";

const canvas = document.getElementById("canvas");
const keys = [...document.querySelectorAll(".key")];
const model = new Model();
const limits = new Limits();
const view = new View({ reducedMotion: () => matchMedia("(prefers-reduced-motion: reduce)").matches });
const scene = new Scene(canvas, view, model);
const connection = new Connection({ onMessage: receive, onChange: refresh });
const drive = new Drive({
  send: (message) => (message.type === "drive" ? connection.sendFresh(message) : connection.send(message)),
  limits: () => limits.values,
  onChange: showHeld,
});

const editor = new Editor({ view, world: model.world, send: sendEdit, lift, changed: showEdit });
scene.editor = editor;
const bench = new Workbench({
  editor,
  world: model.world,
  send: sendEdit,
  driving: () => drive.holding,
  toggled: () => (abandon(), showEdit()), // keys of the pad may have gone from under a finger
});

function receive(message) {
  model.receive(message);
  if (message.type === "hello") greet(message);
  else if (message.type === "snapshot") see(message);
  else if (message.type === "world") survey();
  else if (message.type === "added") editor.select(message.id);
  else if (message.type === "edit_refused") refusedEdit(message);
  else if (message.type === "refused") refused(message);
  refresh();
}

function greet(hello) {
  showHello(hello);
  if (hello.limits) limits.adopt(hello.limits); // unknown before the robot is
  scene.adoptMap(hello.map);
  bench.adopt(hello.models);
  scene.invalidate();
}

function see(snapshot) {
  showSnapshot(snapshot);
  showWhy(snapshot);
  scene.adoptPose(snapshot.pose);
}

/** The world has changed. While the robot says nothing, as in a pause, the world says where it is. */
function survey() {
  const { own, paused } = model.world;
  if (own && (paused || !model.hearing)) scene.adoptPose(own.pose);
  editor.catchUp();
  showEdit();
}

function showEdit() {
  bench.show();
  scene.invalidate();
}

function sendEdit(message) {
  if (!connection.send(message)) toast("Not connected: nothing was changed.");
}

function refusedEdit({ message }) {
  editor.refused();
  toast(message);
}

/** The user takes the robot in the hand, or puts it down. */
function lift(lifted) {
  model.lifted = lifted;
  if (drive.active) drive.stop();
}

function refused({ message }) {
  toast(message);
  // Held inputs must not take over by themselves once the other driver leaves.
  if (model.snapshot?.driver === "you") drive.releaseAll();
  else drive.forget();
}

/** Shows how much of what is known still holds, and lets go where it does not. */
function refresh() {
  model.setSocket(connection.open);
  if (drive.holding && model.obstacle !== null) drive.stop();
  const { live, snapshot } = model;
  showConnection(model, connection.retryAt);
  showOverlay(model, connection.retryAt);
  showStops(snapshot?.emergency_stop ?? false, live);
  showLink(connection.roundTrip, snapshot?.link.rate ?? 0, live);
  showUsable(live);
  showMode(view.mode);
  if (model.world.paused) showPause();
}

function showHeld() {
  const held = drive.directions;
  for (const key of keys) {
    key.classList.toggle("held", key.dataset.go.split(" ").every((direction) => held.has(direction)));
  }
}

function press(input, directions) {
  if (model.obstacle === null) drive.press(input, directions);
  else toast(model.obstacle);
}

/** The user may have lost hold of the page. Leaves a robot alone that somebody else drives. */
function abandon() {
  if (drive.active || model.snapshot?.driver === "you") drive.stop();
}

const release = (input) => drive.release(input);

function stop() {
  drive.stop();
  if (!connection.open) toast("Not connected: the stop could not be sent.");
}

listenToKeys({ press, release, stop, abandon });
listenToPad(keys, { press, release, abandon });
listenToStops({
  stop,
  emergencyStop() {
    drive.forget();
    if (!connection.send({ type: "emergency_stop" })) toast("Not connected: the stop could not be sent.");
  },
  reset: () => connection.send({ type: "reset_emergency_stop" }),
});
watchForLoss(abandon);
listenToCanvas(canvas, view, editor, () => (scene.invalidate(), showMode(view.mode)));
listenToTools(view, {
  changed: () => (scene.invalidate(), showMode(view.mode)),
  clearTrail: () => model.clearTrail(),
});
listenToDisclosures();
document.getElementById("motors").addEventListener("click", ({ currentTarget }) => {
  connection.send({ type: "motors", on: currentTarget.getAttribute("aria-checked") !== "true" });
});

if (matchMedia(PHONE).matches) view.setMode("follow");
setInterval(refresh, CHECK);
connection.connect();

const toScreen = (x, y) => view.toScreen(x, y);

// For tests. Pixels are CSS pixels from the canvas' top left corner.
Object.defineProperty(window, "pioneer3", {
  value: Object.freeze({
    toScreen,
    get state() {
      const { pose } = scene;
      const drawn = pose && Object.freeze({ ...toScreen(pose.x, pose.y), theta: pose.theta });
      return Object.freeze({
        hello: model.hello,
        snapshot: model.snapshot,
        status: model.status,
        live: model.live,
        connected: connection.open,
        roundTrip: connection.roundTrip,
        things: [...model.world.things.values()],
        clock: model.world.clock,
        selected: editor.selected,
        held: [...drive.directions],
        pose,
        drawn,
        camera: Object.freeze({ x: view.x, y: view.y, scale: view.scale, mode: view.mode }),
        ratio: scene.ratio,
        toScreen,
      });
    },
  }),
});
