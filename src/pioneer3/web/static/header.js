// The top bar: what we are connected to, how well, and who drives.

const byId = (id) => document.getElementById(id);

function chip(id, text, level) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
  if (element.dataset.level !== level) element.dataset.level = level;
}

/** @param robot {connection, name, robot, url} of the selected one, or null before any is known */
export function showRobot({ connection, name = "", robot = null, url = "" } = {}) {
  const badge = byId("badge");
  const known = Boolean(url); // without an address nothing has answered yet
  const label = known ? connection : "NOT CONNECTED";
  badge.textContent = label;
  badge.dataset.kind = known ? connection.toLowerCase() : "none";
  document.body.dataset.kind = badge.dataset.kind;
  badge.title = url;
  byId("name").textContent = name || "pioneer3";
  byId("title").textContent = robot?.title ?? "waiting for the robot";
  document.title = `${label}: ${name || "pioneer3"}`;
}

/**
 * @param model Model
 * @param retryAt when the socket tries again [performance.now()], or null
 * @param holder who has the wheel: "you", a name, or "" for nobody
 */
export function showConnection(model, retryAt, holder) {
  if (!model.socketOpen) chip("connection", retryAt === null ? "Connecting" : "Reconnecting", "bad");
  else if (model.status?.state === "lost") chip("connection", "Robot lost", "bad");
  else if (model.status?.state === "connecting") chip("connection", "Connecting", "warn");
  else if (!model.live) chip("connection", "No news", "warn");
  else chip("connection", "Connected", "good");
  if (!model.live) chip("driver", "Driver unknown", "idle");
  else if (model.viewer && !model.driver && !holder) chip("driver", "You watch", "idle");
  else chip("driver", ...driver(model, holder));
}

function driver({ driver: who, snapshot }, holder) {
  if (who === "you") return ["You drive", "you"];
  if (who === "other") return [`${snapshot.driver.name} drives`, "warn"];
  if (holder === "you") return ["You have the wheel", "idle"];
  return [holder ? `${holder} has the wheel` : "Nobody drives", "idle"];
}
