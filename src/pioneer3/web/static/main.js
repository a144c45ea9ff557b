// Composes the page: messages change the model, the model is drawn and shown, inputs become messages.

import { OwnRobot } from "./classroom/own_robot.js";
import { Connection } from "./connection.js";
import { PHONE, byId, sentence } from "./dom.js";
import { Drive } from "./drive/drive.js";
import { Inputs, Limits } from "./drive/inputs.js";
import { StopQueue, listenToStops, showLatched, showStops, showTrouble } from "./drive/stops.js";
import { Teleop, watchForLoss } from "./drive/teleop.js";
import { checkPairing } from "./http.js";
import { Editor } from "./map/editor.js";
import { EditMode } from "./map/edit_mode.js";
import { EditorToolbar } from "./map/editor_toolbar.js";
import { listenToCanvas, listenToPointer, listenToTools, showMode } from "./map/gestures.js";
import { GotoTool } from "./map/goto.js";
import { MapEditor } from "./map/map_editor.js";
import { MapToolbar } from "./map/map_toolbar.js";
import { Whereabouts } from "./map/whereabouts.js";
import { Layers, Legend } from "./map/layers.js";
import { robotAt } from "./map/robots.js";
import { Scene } from "./map/scene.js";
import { View } from "./map/view.js";
import { View3d } from "./map/view3d.js";
import { Model } from "./model/model.js";
import { MapNews } from "./panels/map_making.js";
import { Panels } from "./panels/panels.js";
import { People } from "./panels/people.js";
import { Picker, addsRobot } from "./panels/picker.js";
import { Replay } from "./replay/replay.js";
import {
  showConnection, showLink, showOverlay, showPause, showRobot, showSnapshot, showUsable, showWhy, toast,
} from "./panels/status.js";

const CHECK = 250; // ms between checks of the age of the data
const RECENT = 1500; // ms after a message of the server in which it is not covered by others
const LONG = 8000; // ms, of a message of the server
const WATCHING = "You watch. STOP and E-STOP are for you, too.";

let newsAt = -Infinity; // of the last message about another person's action
let hasDriven = false; // the user knows how to drive
const canvas = byId("canvas");
const model = new Model();
const limits = new Limits();
const view = new View({ reducedMotion: () => matchMedia("(prefers-reduced-motion: reduce)").matches });
const layers = new Layers(showLayer);
const legend = new Legend(layers);
const scene = new Scene(canvas, view, model, layers);
const connection = new Connection({ onMessage: receive, onChange: connected, onLost: () => checkPairing(ownRobot.isStudent ? "/join" : "/pair") });
const drive = new Drive({
  send: sendDrive,
  limits: () => limits.values,
  onChange: () => (hasDriven ||= drive.holding, inputs.show(drive)),
});

const replay = new Replay({
  send: (message) => connection.send(message),
  notify: toast,
  nameOf: (number) => (model.several ? model.robots.get(number)?.name : ""),
  jumped: () => (model.forget(), panels.forget(), scene.invalidate()),
});

const people = new People({
  send: (message) => connection.send(message) || toast("Not connected: nothing was changed."),
  notify: toast,
});
const ownRobot = new OwnRobot({ send: (message) => connection.send(message), notify: toast, prefer: () => panels.prefer("program") });
const picker = new Picker({ model, select, toggle, chooseAll, open: () => panels.open("robots") });
const editor = new Editor({ view, world: model.world, send: sendEdit, lift, changed: showEdit });
scene.editor = editor;
const toolbar = new EditorToolbar({
  editor,
  world: model.world,
  send: sendEdit,
  driving: () => drive.holding,
});
const mapEditor = new MapEditor({
  view,
  send: (message) => connection.send(message) && (mapToolbar.placed(message), true),
  notify: toast,
  naming: (needed) => mapToolbar.naming(needed),
  changed: showEdit,
});
scene.mapEditor = mapEditor;
const mapToolbar = new MapToolbar({ editor: mapEditor, notify: toast });
const editMode = new EditMode({
  world: editor,
  map: mapEditor,
  toggled: () => (editMode.open && view3d.open && view3d.close(), teleop.abandon(), goto.withdraw(), showMap(), showEdit()), // a held control may vanish from under a finger
});
const goto = new GotoTool({
  view, scene, model,
  send: (message) => connection.send(message) || toast("Not connected: nothing was sent."),
  speed: () => limits.values.speed,
  driving: () => drive.holding,
  changed: () => (goto.show(), scene.invalidate()),
  notify: toast,
});
scene.goto = goto;
const whereabouts = new Whereabouts({
  model,
  send: (message) => connection.send(message),
  place: () => goto.begin(),
  notify: (text) => toast(text, LONG),
});

const stops = new StopQueue({
  send: (message) => connection.send(message),
  ping: () => connection.ping(),
  delivered: () => toast("The stop has arrived, late."),
});
const teleop = new Teleop({ drive, model, stops, connection, notify: toast, changed: refresh });
const panels = new Panels({
  model,
  send: sendToRobot,
  sendToAll: (message) => connection.send(message),
  lead: select,
  notify: toast,
  tell,
  now: () => (replay.on ? replay.now : Date.now() / 1000),
  opened: (view) => {
    if (view && PHONE.matches) editMode.set(false);
    picker.setListed(view === "robots");
  },
});

const mapNews = new MapNews({ send: sendToRobot, notify: toast });

/** The socket has opened or closed. */
function connected() {
  stops.flush(connection.open);
  if (connection.open) panels.subscribe();
  refresh();
}

function receive(message) {
  const before = model.selected;
  model.receive(message);
  if (before && before !== model.selected) drive.forget(); // the robot is gone, and its keys drive no other
  if (message.type === "hello") showHello(message);
  else if (message.type === "map") takeMap(message.map);
  else if (message.type === "map_draft") takeDraft(message);
  else if (message.type === "scans") scene.invalidate();
  else if (message.type === "robots") showSnapshots(message);
  else if (message.type === "world") showWorld();
  else if (message.type === "added") editor.select(message.id);
  else if (message.type === "edit_refused") refusedEdit(message);
  else if (message.type === "refused") refused(message);
  else if (message.type === "people") takePeople(message);
  else if (message.type === "class") ownRobot.takeClass(message);
  else if (message.type === "way") goto.takeWay(message);
  else if (message.type === "goal") showGoal(message);
  else if (message.type === "told") showNews(message);
  else if (message.type === "replay") replay.takeState(message);
  else if (message.type === "replay_marks") replay.takeMarks(message);
  else if (message.type === "pong") stops.acknowledge(message.t);
  else panels.receive(message);
  refresh();
}

let mapInUse = null;

/** The view that the user moves. */
function looking() {
  return scene.solid?.camera ?? view;
}

function takeMap(map) {
  mapInUse = map;
  mapEditor.adopt(map);
  editMode.offer("map", !model.replayed && Boolean(map?.walls.length || map?.cells.length));
  legend.offer("changes", Boolean(map?.changes.length));
  showMap();
}

function takeDraft(draft) {
  mapEditor.takeDraft(draft);
  showMap();
}

/** Shows the map that robots use, and its draft to people who edit it. */
function showMap() {
  scene.adoptMap(mapEditor.active ? mapEditor.map : mapInUse);
}

function showHello(hello) {
  document.body.classList.toggle("replaying", model.replayed);
  byId("driver").disabled = model.replayed;
  ownRobot.takeHello(hello);
  inputs.adopt(hello);
  editMode.offer("world", Boolean(hello.models));
  toolbar.adopt(hello.models);
  showSelected();
  legend.offer("laser", hello.robots.some(({ laser }) => laser));
  if (hello.robots.some(({ scans }) => scans)) layers.suggest("laser");
  legend.update("laser");
  watchLasers();
}

/** Lasers are on while somebody looks at them. */
function watchLasers() {
  connection.send({ type: "watch_lasers", on: layers.has("laser") });
}

function showLayer(name) {
  if (name === "laser") watchLasers();
  scene.renew();
}

/** Selects another robot; the one before is stopped if it is driven. */
function select(id) {
  if (!model.robots.has(id) || (id === model.selected?.id && model.chosen.length < 2)) return;
  if (drive.active) drive.stop();
  model.select(id);
  showSelected();
  if (panels.view === "robots" && PHONE.matches) panels.open(null); // back to the controls
  if (model.snapshot) show();
  refresh();
}

/** Chooses one robot more, or one less; those that are driven are stopped first. */
function toggle(id) {
  if (drive.active) drive.stop();
  model.toggle(id);
  showSelected();
  refresh();
}

function chooseAll() {
  if (drive.active) drive.stop();
  model.chooseAll();
  showSelected();
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

/** A tap on the map selects the robot there; returns whether there is one. */
function pick(point, type, event) {
  if (editMode.open || !model.several) return false;
  const slack = (type === "mouse" ? 4 : 16) / view.scale;
  const robot = robotAt(scene.robots, view.toWorld(point.x, point.y), slack);
  if (robot && addsRobot(event)) toggle(robot.id);
  else if (robot) select(robot.id);
  return robot !== null;
}

/** A tap on the map: a robot is selected, or a goal is proposed, with a finger only on a place or once the card is open. */
function tap(point, type, event) {
  if (pick(point, type, event)) return true;
  editor.select(null); // the floor was tapped
  if (editMode.open) goto.withdraw();
  else if (type === "mouse" || goto.proposal || goto.placeAt(point, type)) goto.propose(point, type);
  return false;
}

const longPress = (point, type) => (!editMode.open && goto.hold(point, type) ? goto : null);

/** Drives or stops the chosen robots, but those that somebody else has control of. */
function sendDrive(message) {
  const [first, ...rest] = model.driven.map(({ id }) => id);
  if (first === undefined) return;
  if (message.type === "drive") connection.sendFresh({ ...message, robot: first, ...(rest.length ? { also: rest } : {}) });
  else for (const robot of [first, ...rest]) connection.send({ ...message, robot });
}

function sendToRobot(message) {
  return connection.send({ ...message, robot: model.selected?.id });
}

function takePeople(message) {
  people.receive(message);
  model.viewer = people.viewer || model.replayed;
  document.body.classList.toggle("viewer", model.viewer);
  model.client = message.id;
  model.leases = message.control;
  ownRobot.takeOver(model);
}

function showSnapshots({ snapshots }) {
  for (const snapshot of snapshots) panels.record(snapshot, model.robots.get(snapshot.robot));
  show();
}

function show() {
  if (model.snapshot) {
    showSnapshot(model.snapshot);
    showWhy(model.snapshot, model.snapshot.standing === "stopped" ? stopped(model.snapshot) : hint());
  }
  scene.invalidate();
}

/** Returns the hint for a robot that stands and has nothing to do. */
function hint() {
  if (model.replayed) return "";
  if (model.viewer) return WATCHING;
  if (model.denial) return ""; // the class's banner says why
  const holder = people.holder;
  const { chosen, driven } = model;
  if (chosen.length > 1) return `You drive ${driven.length} of ${chosen.length} chosen robots; space stops all of them.`;
  if (holder && holder !== "you") return `${holder} has control.`;
  return hasDriven ? "" : inputs.hint;
}

/** The reason that a stop keeps the robot standing for, and what drives it again from here. */
function stopped({ stop }) {
  const { selected, several, viewer, denial } = model;
  const taken = model.holderOf(selected) && people.holder !== "you";
  return viewer || denial || taken ? sentence(stop) : `${sentence(stop)} ${inputs.again}`;
}

/** Shows the world. While a robot does not report, as in a pause, its pose comes from the world. */
function showWorld() {
  for (const robot of model.robots.values()) {
    const own = model.world.own(robot.id);
    if (own && (model.world.paused || !robot.reporting)) robot.moveTo(own.pose);
  }
  editor.catchUp();
  showEdit();
}

function showEdit() {
  toolbar.show();
  mapToolbar.show();
  scene.invalidate();
}

function sendEdit(message) {
  if (!connection.send(message)) toast("Not connected: nothing was changed.");
}

function refusedEdit({ message }) {
  editor.refused();
  toast(message);
}

/** The user begins to drag the selected thing, which is a robot of the page, or drops it. */
function lift(lifted) {
  for (const robot of model.robots.values()) robot.lifted = lifted && robot.id === editor.thing?.own;
  if (drive.active) drive.stop();
}

/** Shows a message about another person's action. */
function showNews({ message }) {
  newsAt = performance.now();
  toast(message, LONG);
}

/** Shows a message, unless one about another person's action explains it. */
function tell(text) {
  if (performance.now() - newsAt > RECENT) toast(text);
}

function showGoal(goal) {
  const news = goto.takeGoal(goal);
  if (news) toast(news, LONG);
}

function refused({ message }) {
  if (!goto.takeRefusal(message)) tell(message);
  // held inputs must not take over by themselves once the other driver leaves
  if (model.driver === "you") drive.releaseAll();
  else drive.forget();
}

/** Shows which data are still up to date, and stops driving where they are not. */
function refresh() {
  model.setSocket(connection.open);
  ownRobot.show(model, people.holder);
  if (drive.holding && model.refusal !== null) drive.stop();
  const { live, snapshot } = model;
  showConnection(model, connection.retryAt, people.holder);
  showOverlay(model, connection.retryAt);
  const latched = [...model.robots.values()].filter((robot) => robot.snapshot?.emergency_stop);
  showStops(snapshot?.emergency_stop ?? false, live);
  showLatched(latched, model);
  showTrouble(stops.trouble);
  if (snapshot) panels.show(snapshot, { usable: live && !model.viewer, startedBy: people.holder, going: goto.going, roundTrip: model.replayed ? null : connection.roundTrip });
  showLink(model.replayed ? null : connection.roundTrip, snapshot?.link.rate ?? 0, live);
  showUsable(live && !model.viewer);
  showMode(looking().mode);
  if (model.world.paused) showPause();
  picker.show();
  goto.show();
  whereabouts.show();
  mapNews.show(model.selected?.mapping ?? null, mapInUse?.changes ?? [], model.viewer);
}

const inputs = new Inputs(teleop);
listenToStops(teleop);
watchForLoss(teleop.abandon);
listenToCanvas(canvas, view, {
  takers: [editor, mapEditor, goto],
  changed: () => (scene.invalidate(), showMode(view.mode)),
  tap,
  twice: () => goto.withdraw(),
  longPress,
});
listenToPointer(canvas, view);
const view3d = new View3d({
  scene, notify: toast,
  changed: () => (view3d?.open && editMode.open && editMode.set(false), scene.renew(), refresh()),
  still: () => matchMedia("(prefers-reduced-motion: reduce)").matches,
  tap: ({ x, y }, type, event) => tap(view.toScreen(x, y), type, event),
});
listenToTools(looking, {
  changed: () => (scene.invalidate(), showMode(looking().mode)),
  clearTrail: () => model.clearTrail(),
});
byId("motors").addEventListener("click", ({ currentTarget }) => {
  const on = currentTarget.getAttribute("aria-checked") !== "true";
  sendToRobot({ type: "motors", on });
});

// on a home screen, and only there, a worker says when the driver cannot be reached; a browser says so itself
const installed = matchMedia("(display-mode: standalone)").matches || navigator.standalone === true;
if (installed) navigator.serviceWorker?.register("/worker.js").catch(() => {}); // a certificate that is not trusted

if (PHONE.matches) view.setMode("follow");
setInterval(refresh, CHECK);
connection.connect();

expose();

/** Exposes the state to tests as `window.pioneer3`, frozen. Pixels are CSS pixels from the canvas' top left corner. */
function expose() {
  const toScreen = (x, y) => view.toScreen(x, y);
  Object.defineProperty(window, "pioneer3", {
    value: Object.freeze({
      toScreen,
      get state() {
        const { pose } = scene;
        const drawn = pose && Object.freeze({ ...toScreen(pose.x, pose.y), theta: pose.theta });
        return Object.freeze({
          hello: model.hello,
          robot: model.selected?.id ?? null,
          chosen: model.chosen.map(({ id }) => id),
          robots: [...model.robots.values()].map(({ id, name, snapshot, status }) => ({ id, name, snapshot, status })),
          snapshot: model.snapshot,
          status: model.status,
          live: model.live,
          connected: connection.open,
          roundTrip: connection.roundTrip,
          things: [...model.world.things.values()],
          clock: model.world.clock,
          selected: editor.selected,
          held: [...drive.directions],
          source: drive.source,
          pose,
          drawn,
          camera: Object.freeze({ x: view.x, y: view.y, scale: view.scale, mode: view.mode }),
          ratio: scene.ratio,
          layers: layers.all,
          places: scene.places,
          draft: mapEditor.draft,
          object: mapEditor.selected,
          proposal: goto.proposal && Object.freeze({ ...goto.proposal }),
          scans: [...model.robots.values()].map(({ points, scanning }) => (scanning ? points.length / 2 : 0)),
          frames: scene.frames,
          replay: replay.on ? replay.now : null,
          solid: scene.solid && Object.freeze(scene.solid.state),
          toScreen,
        });
      },
    }),
  });
}
