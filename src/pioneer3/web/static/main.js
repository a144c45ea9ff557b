// Joins the parts: messages -> model -> picture and numbers; inputs -> drive -> messages.

import { checkPairing } from "./access.js";
import { Connection } from "./connection.js";
import { Drive } from "./drive.js";
import { Editor } from "./editor.js";
import { Errand } from "./errand.js";
import { expose } from "./exposed.js";
import { listenToCanvas } from "./gestures.js";
import { watchForLoss } from "./guard.js";
import { Hands } from "./hands.js";
import { robotAt } from "./draw_robots.js";
import { showConnection, showRobot } from "./header.js";
import { Inputs } from "./inputs.js";
import { Layers } from "./layers.js";
import { Legend } from "./legend.js";
import { Limits } from "./limits.js";
import { Model } from "./model.js";
import { showOverlay, showPause, showWhy, toast } from "./notices.js";
import { showLatched, showTrouble } from "./panels/alarm.js";
import { Panels } from "./panels/panels.js";
import { StopPost } from "./panels/stop_post.js";
import { showLink, showSnapshot, showUsable } from "./panel.js";
import { People } from "./people.js";
import { Picker } from "./picker.js";
import { listenToPointer } from "./pointer.js";
import { Scene } from "./scene.js";
import { listenToStops, showStops } from "./stops.js";
import { listenToTools, showMode } from "./tools.js";
import { View } from "./view.js";
import { Workbench } from "./workbench.js";

const CHECK = 250; // ms between looks at the age of what is shown
const NEWS = 1500; // ms in which news are not covered by what follows from them
const NEWS_LAST = 8000; // ms
const WATCHING = "You watch. STOP and E-STOP are for you, too.";
const PHONE = "(max-width: 760px), (max-height: 520px)";

let toldAt = -Infinity;
let driven = false; // whether the user has found out how
const canvas = document.getElementById("canvas");
const model = new Model();
const limits = new Limits();
const view = new View({ reducedMotion: () => matchMedia("(prefers-reduced-motion: reduce)").matches });
const layers = new Layers(showLayer);
const legend = new Legend(layers);
const scene = new Scene(canvas, view, model, layers);
const connection = new Connection({ onMessage: receive, onChange: connected, onLost: checkPairing });
const drive = new Drive({
  send: sendDrive,
  limits: () => limits.values,
  onChange: () => (driven ||= drive.holding, inputs.show(drive)),
});

const people = new People({
  send: (message) => connection.send(message) || toast("Not connected: nothing was changed."),
  complain: toast,
});
const picker = new Picker({ model, select, open: () => panels.open("robots") });
const editor = new Editor({ view, world: model.world, send: sendEdit, lift, changed: showEdit });
scene.editor = editor;
const bench = new Workbench({
  editor,
  world: model.world,
  send: sendEdit,
  driving: () => drive.holding,
  toggled: () => (hands.abandon(), errand.withdraw(), showEdit()), // keys of the pad may have gone from under a finger
});
const errand = new Errand({
  view, scene, model,
  send: (message) => connection.send(message) || toast("Not connected: nothing was sent."),
  speed: () => limits.values.speed,
  driving: () => drive.holding,
  changed: () => (errand.show(), scene.invalidate()),
});
scene.errand = errand;

const post = new StopPost({
  send: (message) => connection.send(message),
  ping: () => connection.ping(),
  delivered: () => toast("The stop has arrived, late."),
});
const hands = new Hands({ drive, model, post, connection, complain: toast, changed: refresh });
const panels = new Panels({
  send: sendToRobot,
  complain: toast,
  remark,
  opened: (view) => {
    if (view && matchMedia(PHONE).matches) bench.open(false);
    picker.listed(view === "robots");
  },
});

/** The socket has opened or closed. */
function connected() {
  post.carryOn(connection.open);
  if (connection.open) panels.attend();
  refresh();
}

function receive(message) {
  const before = model.selected;
  model.receive(message);
  if (before && before !== model.selected) drive.forget(); // it has gone: its keys move no other one
  if (message.type === "hello") greet(message);
  else if (message.type === "map") scene.adoptMap(message.map);
  else if (message.type === "scans") scene.invalidate();
  else if (message.type === "robots") see(message);
  else if (message.type === "world") survey();
  else if (message.type === "added") editor.select(message.id);
  else if (message.type === "edit_refused") refusedEdit(message);
  else if (message.type === "refused") refused(message);
  else if (message.type === "people") meet(message);
  else if (message.type === "told") told(message);
  else if (message.type === "pong") post.heard(message.t);
  else panels.receive(message);
  refresh();
}

function greet(hello) {
  inputs.adopt(hello);
  bench.adopt(hello.models);
  showSelected();
  legend.offer("laser", hello.robots.some(({ laser }) => laser));
  watch();
}

/** Lasers are on while somebody looks at them. */
function watch() {
  connection.send({ type: "watch_lasers", on: layers.has("laser") });
}

function showLayer(name) {
  if (name === "laser") watch();
  scene.renew();
}

/** The user wants another robot: the one before is let go first. */
function select(id) {
  if (id === model.selected?.id || !model.robots.has(id)) return;
  if (drive.active) drive.stop();
  model.select(id);
  showSelected();
  if (panels.view === "robots" && matchMedia(PHONE).matches) panels.open(null); // to what it is driven with
  if (model.snapshot) show();
  refresh();
}

function showSelected() {
  const robot = model.selected;
  showRobot(robot?.hello);
  if (robot?.hello.limits) limits.adopt(robot.hello.limits); // unknown before the robot is
  people.show(robot, model.several);
  panels.select(robot);
  scene.invalidate();
}

/** A tap on the map selects the robot there; says whether there was one. */
function pick(point, type) {
  if (editor.active || !model.several) return false;
  const slack = (type === "mouse" ? 4 : 16) / view.scale;
  const robot = robotAt(scene.robots, view.toWorld(point.x, point.y), slack);
  if (robot) select(robot.id);
  return robot !== null;
}

/** A tap on the map: a robot is selected, or with the mouse a place is offered to drive to. */
function tap(point, type) {
  if (pick(point, type)) return true;
  editor.select(null); // the floor was tapped
  if (!editor.active && type === "mouse") errand.propose(point, type);
  else errand.withdraw();
  return false;
}

const hold = (point, type) => (!editor.active && errand.propose(point, type) ? errand : null);

function sendDrive(message) {
  const request = { ...message, robot: model.selected?.id };
  return message.type === "drive" ? connection.sendFresh(request) : connection.send(request);
}

function sendToRobot(message) {
  return connection.send({ ...message, robot: model.selected?.id });
}

function meet(message) {
  people.receive(message);
  model.viewer = people.viewer;
  model.guest = message.id;
  model.wheels = message.wheels;
}

function see({ snapshots }) {
  for (const snapshot of snapshots) panels.note(snapshot, model.robots.get(snapshot.robot));
  show();
}

function show() {
  if (model.snapshot) {
    showSnapshot(model.snapshot);
    showWhy(model.snapshot, hint());
  }
  scene.invalidate();
}

/** What to do with a robot that stands and is asked for nothing. */
function hint() {
  if (model.viewer) return WATCHING;
  const holder = people.holder;
  if (holder && holder !== "you") return `${holder} has the wheel.`;
  return driven ? "" : inputs.hint;
}

/** The world has changed. While a robot says nothing, as in a pause, the world says where it is. */
function survey() {
  for (const robot of model.robots.values()) {
    const own = model.world.own(robot.id);
    if (own && (model.world.paused || !robot.hearing)) robot.place(own.pose);
  }
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

/** The user takes the selected thing, which is a robot of the page, in the hand, or puts it down. */
function lift(lifted) {
  for (const robot of model.robots.values()) robot.lifted = lifted && robot.id === editor.thing?.own;
  if (drive.active) drive.stop();
}

/** Somebody did something that concerns this page. */
function told({ message }) {
  toldAt = performance.now();
  toast(message, NEWS_LAST);
}

/** Says what has happened, unless the user has just been told why. */
function remark(text) {
  if (performance.now() - toldAt > NEWS) toast(text);
}

function refused({ message }) {
  remark(message);
  // Held inputs must not take over by themselves once the other driver leaves.
  if (model.driver === "you") drive.releaseAll();
  else drive.forget();
}

/** Shows how much of what is known still holds, and lets go where it does not. */
function refresh() {
  model.setSocket(connection.open);
  if (drive.holding && model.obstacle !== null) drive.stop();
  const { live, snapshot } = model;
  showConnection(model, connection.retryAt, people.holder);
  showOverlay(model, connection.retryAt);
  const latched = [...model.robots.values()].filter((robot) => robot.snapshot?.emergency_stop);
  showStops(snapshot?.emergency_stop ?? false, live);
  showLatched(latched, model);
  showTrouble(post.trouble);
  if (snapshot) panels.show(snapshot, { usable: live && !model.viewer, starter: people.holder, going: errand.going, roundTrip: connection.roundTrip });
  showLink(connection.roundTrip, snapshot?.link.rate ?? 0, live);
  showUsable(live && !model.viewer);
  showMode(view.mode);
  if (model.world.paused) showPause();
  picker.show();
  errand.show();
}

const inputs = new Inputs(hands);
listenToStops(hands);
watchForLoss(hands.abandon);
listenToCanvas(canvas, view, {
  takers: [editor, errand],
  changed: () => (scene.invalidate(), showMode(view.mode)),
  tap,
  twice: () => errand.withdraw(),
  hold,
});
listenToPointer(canvas, view);
listenToTools(view, {
  changed: () => (scene.invalidate(), showMode(view.mode)),
  clearTrail: () => model.clearTrail(),
});
document.getElementById("motors").addEventListener("click", ({ currentTarget }) => {
  const on = currentTarget.getAttribute("aria-checked") !== "true";
  sendToRobot({ type: "motors", on });
});

if (matchMedia(PHONE).matches) view.setMode("follow");
setInterval(refresh, CHECK);
connection.connect();

expose({ model, scene, view, connection, editor, drive, layers, errand });
