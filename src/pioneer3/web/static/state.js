// How a robot is, in a word, a picture and a level: for lists where the eye goes over many.

/** Of robots, the most urgent first: {text, level, icon: the path of a 24 by 24 picture}. */
export function stateOf(robot, model) {
  const [text, level, icon] = judge(robot, model);
  return { text, level, icon: ICONS[icon] };
}

const ICONS = {
  gone: "M3 3l18 18M8 5a10 10 0 0 1 13 5M3 10a10 10 0 0 1 4-3M12 19h.01",
  wait: "M12 3a9 9 0 1 0 9 9M12 7v5l3 2",
  stop: "M8 3h8l5 5v8l-5 5H8l-5-5V8zM12 8v5M12 16h.01",
  battery: "M3 8h15v8H3zM21 11v2M6 11v2",
  drive: "M5 4l15 8-15 8 4-8z",
  ready: "M12 3a9 9 0 1 1 0 18 9 9 0 0 1 0-18M8 12l3 3 5-6",
};

function judge(robot, model) {
  const { status, snapshot } = robot;
  if (!model.socketOpen) return ["Not known", "idle", "gone"];
  if (status?.state === "lost") return ["Lost", "bad", "gone"];
  if (status?.state === "connecting") return ["Connecting", "warn", "wait"];
  if (!model.isLive(robot)) return ["No news", "warn", "wait"];
  if (snapshot.emergency_stop) return ["E-stop", "bad", "stop"];
  if (snapshot.motors.stop_button) return ["Stop button", "bad", "stop"];
  if (snapshot.motors.stalled) return ["Stalled", "bad", "stop"];
  if (snapshot.battery.low) return ["Battery low", "bad", "battery"];
  if (snapshot.driver && snapshot.driver.id !== null && snapshot.driver.id === model.guest) return ["You drive", "you", "drive"];
  if (snapshot.driver) return [`${snapshot.driver.name} drives`, "warn", "drive"];
  return ["Ready", "good", "ready"];
}
