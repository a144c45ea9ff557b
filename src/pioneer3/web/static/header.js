// The top bar: what we are connected to, how well, and who drives.

const byId = (id) => document.getElementById(id);

const DRIVERS = {
  you: ["You drive", "you"],
  other: ["Someone else drives", "warn"],
};

function chip(id, text, level) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
  if (element.dataset.level !== level) element.dataset.level = level;
}

export function showHello({ connection, robot, url }) {
  const badge = byId("badge");
  const known = Boolean(url); // without an address nothing has answered yet
  const label = known ? connection : "NOT CONNECTED";
  badge.textContent = label;
  badge.dataset.kind = known ? connection.toLowerCase() : "none";
  document.body.dataset.kind = badge.dataset.kind;
  badge.title = url;
  byId("name").textContent = robot?.name || "pioneer3";
  byId("title").textContent = robot?.title ?? "waiting for the robot";
  document.title = `${label}: ${robot?.name || "pioneer3"}`;
}

/** @param model Model @param retryAt when the socket tries again [performance.now()], or null */
export function showConnection(model, retryAt) {
  if (!model.socketOpen) chip("connection", retryAt === null ? "Connecting" : "Reconnecting", "bad");
  else if (model.status?.state === "lost") chip("connection", "Robot lost", "bad");
  else if (model.status?.state === "connecting") chip("connection", "Connecting", "warn");
  else if (!model.live) chip("connection", "No news", "warn");
  else chip("connection", "Connected", "good");
  if (!model.live) chip("driver", "Driver unknown", "idle");
  else chip("driver", ...(DRIVERS[model.snapshot.driver] ?? ["Nobody drives", "idle"]));
}
