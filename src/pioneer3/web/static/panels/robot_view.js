// The view of one robot: fast values from its snapshots, the others from its details, and its CONFIG.

import { degrees, make, number, put, putHelp, putItems, putLines } from "../dom.js";
import { BumperDrawing, LineBoard, Rows, Sparkline, part, showFindings, showRoundTrip } from "./widgets.js";

const NOT_SENT = "not sent";
const place = ({ x, y, theta }) => `${number(x, 2)}, ${number(y, 2)} m, ${number(degrees(theta), 0)}°`;

function nearest({ ranges, enabled }) {
  const echoes = ranges.filter((range) => range !== null);
  if (!enabled) return "sonar off";
  return echoes.length ? `${number(Math.min(...echoes), 2)} m` : "none";
}

const speeds = (twist) => (twist ? `${number(twist.v, 2)} m/s, ${number(twist.w, 2)} rad/s` : "–");

export class RobotView {
  #why = make("p", { class: "why-words" });
  #decided = make("ul", { class: "lines-of-text" });
  #motion = new Rows({ pose: "In the map", odometry: "Odometry", encoder: "Own counters", measured: "Measured", commanded: "Commanded", echo: "Nearest echo", wheels: "Left, right wheel", compass: "Compass" });
  #power = new Rows({ battery: "Battery", charge: "Charge", charger: "Charger", temperature: "Motor temperature" });
  #sparkline = new Sparkline();
  #span = make("p", { class: "words" });
  #motors = new Rows({ power: "Motors", button: "Stop button", left: "Left wheels", right: "Right wheels" });
  #bumpers = new BumperDrawing();
  #lines = new LineBoard();
  #sensors = make("div");
  #link = new Rows({ reports: "Reports", spoilt: "Bad checksums", skipped: "Bytes lost", sessions: "Sessions", trip: "Page to driver", address: "Address" });
  #advice = make("ul", { class: "findings", "aria-label": "Advice about the link" });
  #powerAdvice = make("ul", { class: "findings", "aria-label": "Advice about the battery" });
  #trip = make("ul", { class: "findings" });
  #flags = new Rows({ flags: "Flags", faults: "Faults" });
  #config;

  /** @param requestConfig function(): asks the robot for its CONFIG; returns whether it was sent */
  constructor(container, { requestConfig }) {
    this.#config = new ConfigTable(requestConfig);
    container.append(
      part("Why it does not move", this.#why, this.#decided),
      part("Motion", this.#motion.element),
      part("Battery", this.#power.element, this.#powerAdvice, this.#sparkline.element, this.#span),
      part("Motors", this.#motors.element),
      part("Bumpers", this.#bumpers.element),
      part("Link", this.#link.element, this.#advice, this.#trip),
      part("Inputs and outputs", this.#lines.element),
      part("Sensors", this.#sensors),
      part("Flags and faults", this.#flags.element),
      this.#config.element,
    );
  }

  /** Removes the values of the robot before. */
  clear() {
    this.#config.clear();
  }

  showSnapshot(snapshot, roundTrip) {
    const { motors, battery, why, standing, symptom } = snapshot;
    putHelp(this.#why, why ?? (snapshot.motors.moving ? "It moves." : "Nothing keeps it."), standing === "idle" ? null : symptom);
    putLines(this.#decided, snapshot.mode ? [snapshot.mode, ...snapshot.decided] : []);
    this.#motion.show("pose", place(snapshot.robot_in_map));
    this.#motion.show("odometry", place(snapshot.robot_in_odom));
    this.#motion.show("measured", speeds(snapshot.twist));
    this.#motion.show("commanded", speeds(snapshot.commanded));
    this.#motion.show("echo", nearest(snapshot.sonar));
    this.#power.show("battery", `${number(battery.voltage, 1)} V${battery.low ? ", LOW" : ""}`, battery.low ? "bad" : null);
    this.#power.show("charge", battery.charge === null ? "not known" : `${number(battery.charge * 100, 0)} %`);
    this.#power.show("charger", battery.charging);
    this.#motors.show("power", motors.enabled ? "on" : "off");
    this.#motors.show("button", motors.stop_button ? "PRESSED" : "released", motors.stop_button ? "bad" : null);
    this.#bumpers.show(snapshot.bumpers);
    const { link } = snapshot;
    this.#link.show("reports", `${number(link.rate, 1)} per second, ${link.reports} so far`);
    this.#link.show("spoilt", String(link.bad_checksums), link.bad_checksums ? "warn" : null);
    this.#link.show("skipped", String(link.bytes_skipped), link.bytes_skipped ? "warn" : null);
    this.#link.show("sessions", String(link.sessions));
    this.#link.show("trip", roundTrip === null ? "–" : `${number(roundTrip, 0)} ms there and back`);
    showRoundTrip(this.#trip, roundTrip);
  }

  /** @param {import("../messages.d.ts").Details | import("../messages.d.ts").NoDetails} details @param url of the robot */
  showDetails(details, url) {
    if (!details.known) return;
    const { wheels, stalls, baud } = details;
    this.#motion.show("encoder", place(details.robot_in_encoder));
    this.#motion.show("wheels", `${number(wheels.left, 2)}, ${number(wheels.right, 2)} m/s`);
    this.#power.show("temperature", details.temperature === null ? "no sensor" : `${details.temperature} °C`);
    for (const side of ["left", "right"]) this.#motors.show(side, stalls[side] ? "STALLED" : "free", stalls[side] ? "bad" : null);
    this.#lines.show(details.lines);
    this.#motion.show("compass", details.compass === null ? "none" : `${number(degrees(details.compass), 0)}°`);
    putItems(this.#sensors, JSON.stringify(details.sensors), () => details.sensors.flatMap(sensor));
    this.#link.show("address", url + (baud ? ` at ${baud} baud` : ""));
    this.#flags.show("flags", details.flags.join(", ") || "none");
    this.#flags.show("faults", details.faults === null ? "not sent by this robot" : details.faults.join(", ") || "none", details.faults?.length ? "bad" : null);
    const isPower = ({ check }) => check === "battery";
    showFindings(this.#powerAdvice, details.findings.filter(isPower).filter(({ level }) => level !== "ok"));
    showFindings(this.#advice, details.findings.filter((finding) => !isPower(finding)));
  }

  showConfig(message) {
    this.#config.show(message);
  }

  /** @param points pairs of time [s] and voltage [V] */
  showBattery(points) {
    this.#sparkline.element.style.display = points.length < 2 ? "none" : "";
    if (points.length < 2) return put(this.#span, "");
    const [first, last] = [points[0], points.at(-1)];
    const minutes = Math.round((last[0] - first[0]) / 60);
    const words = `The last ${minutes < 2 ? "minute" : `${minutes} minutes`}: from ${number(first[1], 1)} to ${number(last[1], 1)} V`;
    put(this.#span, words);
    this.#sparkline.show(points, words);
  }
}

/** @param {import("../messages.d.ts").SensorDetails} details */
function sensor({ words, values }) {
  const rows = values.flatMap(({ label, text }) => [make("dt", {}, label), make("dd", {}, text)]);
  return [make("p", { class: "words" }, words), ...(rows.length ? [make("dl", { class: "rows" }, ...rows)] : [])];
}

/** CONFIG, requested when it is opened: every field by name, with its unit and its meaning. */
class ConfigTable {
  element;
  #note = make("p", { class: "words", role: "status" });
  #body = make("div", { class: "config" });
  #again = make("button", { type: "button", class: "choice", id: "config-again" }, "Ask again");
  #send;

  /** @param send function(): sends the request; returns whether it was sent */
  constructor(send) {
    this.#send = send;
    const summary = make("summary", { id: "config-open" }, "Configuration (CONFIG)");
    this.element = make("details", { class: "part", id: "config" }, summary, this.#note, this.#body, this.#again);
    this.element.addEventListener("toggle", () => this.element.open && this.#request());
    this.#again.addEventListener("click", () => this.#request());
  }

  clear() {
    this.element.open = false;
    this.#body.replaceChildren();
    put(this.#note, "");
  }

  show({ rows, error }) {
    const missing = rows.length ? error : error ?? "The robot did not send its configuration.";
    put(this.#note, missing ? `${missing}${rows.length ? " These are the values of before." : ""}` : `${rows.length} fields.`);
    const groups = grouped(rows);
    this.#body.replaceChildren(...[...groups].map(([group, members]) => table(group, members)));
  }

  #request() {
    put(this.#note, "Asking the robot …");
    if (!this.#send()) put(this.#note, "Not connected to the driver.");
  }
}

function grouped(rows) {
  const groups = new Map();
  for (const row of rows) groups.set(row.group, [...(groups.get(row.group) ?? []), row]);
  return groups;
}

function table(group, rows) {
  const head = ["Field", "Value", "Meaning"].map((title) => make("th", { scope: "col" }, title));
  const lines = rows.map(({ field, value, unit, meaning }) => make("tr", value === NOT_SENT ? { class: "absent" } : {},
    make("th", { scope: "row" }, field), make("td", {}, `${value} ${unit}`.trim()), make("td", {}, meaning)));
  return make("table", {}, make("caption", {}, group), make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...lines));
}
