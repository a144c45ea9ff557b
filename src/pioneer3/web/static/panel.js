// The numbers beside the map.

const byId = (id) => document.getElementById(id);
const NO_SIGN = /^-(?=0(\.0*)?$)/; // "-0.00"

function put(id, text) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
}

function level(id, value) {
  const element = byId(id);
  if (element.dataset.level !== value) element.dataset.level = value;
}

/** With a real minus sign, and never "-0.00". */
function number(value, digits) {
  if (!Number.isFinite(value)) return "–";
  return value.toFixed(digits).replace(NO_SIGN, "").replace("-", "−");
}

export function showSnapshot(snapshot) {
  const { pose, twist, sonar, battery, motors, bumpers, link } = snapshot;
  put("speed-now", number(twist.v, 2));
  put("turn-now", number(twist.w, 2));
  put("pose-x", number(pose.x, 2));
  put("pose-y", number(pose.y, 2));
  put("pose-theta", number((pose.theta * 180) / Math.PI, 0));
  showNearest(sonar);
  showBattery(battery);
  showMotors(motors, bumpers);
  put("rate", number(link.rate, 1));
  put("bad-checksums", String(link.bad_checksums));
  level("bad-checksums", link.bad_checksums > 0 ? "warn" : "good");
  put("sessions", String(link.sessions));
}

function showNearest({ ranges, enabled }) {
  const echoes = ranges.filter((range) => range !== null);
  if (!enabled) put("nearest", "sonar off");
  else put("nearest", echoes.length ? `${number(Math.min(...echoes), 2)} m` : "none");
}

function showBattery({ voltage, charge, charging, low }) {
  put("voltage", number(voltage, 1));
  put("charge", charge === null ? "not known" : `${number(charge * 100, 0)} %`);
  put("charging", charging);
  byId("charge-bar").style.width = `${Math.round((charge ?? 0) * 100)}%`;
  byId("low").hidden = !low;
  level("battery", low ? "bad" : charge !== null && charge < 0.25 ? "warn" : "good");
}

function showMotors(motors, bumpers) {
  const button = byId("motors");
  button.setAttribute("aria-checked", String(motors.enabled));
  put("motors-text", motors.enabled ? "On" : "Off");
  put("stop-button", motors.stop_button ? "PRESSED" : "released");
  level("stop-button", motors.stop_button ? "bad" : "good");
  put("stall", motors.stalled ? "STALLED" : "none");
  level("stall", motors.stalled ? "bad" : "good");
  const hits = [...bumpers.front, ...bumpers.rear].filter(Boolean).length;
  put("bumpers", hits ? `${hits} HIT` : "free");
  level("bumpers", hits ? "bad" : "good");
  const alarm = motors.stop_button ? "Stop button" : motors.stalled ? "Stalled" : hits ? "Bumper" : "";
  put("motors-alarm", alarm);
  byId("motors-alarm").hidden = alarm === "";
}

/** Round trip [ms] and whether the robot's reports keep coming. */
export function showLink(roundTrip, rate, live) {
  put("round-trip", roundTrip === null ? "–" : number(roundTrip, 0));
  if (!live || roundTrip === null) level("link", "idle");
  else if (roundTrip > 300 || rate < 5) level("link", "bad");
  else if (roundTrip > 120 || rate < 8) level("link", "warn");
  else level("link", "good");
}

/** Whether what the switch says may be acted on. */
export function showUsable(live) {
  byId("motors").disabled = !live;
}
