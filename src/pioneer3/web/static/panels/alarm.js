// What must not be overlooked: the emergency stop is latched, or a stop did not get through.

import { put } from "./dom.js";

const byId = (id) => document.getElementById(id);

const NAMED = 5; // robots that are told by name
const DRIVER = "When all is safe, reset it; the motors stay off until you drive or switch them on.";
const VIEWER = "A driver can reset it.";
const TROUBLE = {
  unsent: "STOP NOT SENT: there is no connection. It goes out first when the connection is back. Press the stop button on the robot.",
  expired: "STOP NOT SENT: there was no connection for too long. Press it again when the connection is back.",
  unanswered: "STOP NOT CONFIRMED: nothing has answered yet. Press the stop button on the robot if it still moves.",
};

/** @param latched the robots whose emergency stop is; @param model says which one is selected, and who looks */
export function showLatched(latched, { selected, several, viewer, live }) {
  const here = latched.includes(selected);
  const which = several && here ? ` ${namesOf(latched)}` : "";
  put(byId("latched-words"), here ? `EMERGENCY STOP${which}: latched, motors off.` : "");
  put(byId("latched-how"), here ? (viewer ? VIEWER : DRIVER) : "");
  byId("alarm").hidden = !here;
  byId("reset-all").hidden = latched.length < 2;
  byId("reset-all").disabled = !live;
}

function namesOf(robots) {
  return robots.length > NAMED ? `of ${robots.length} robots` : robots.map(({ name }) => name).join(", ");
}

/** @param trouble of the StopPost */
export function showTrouble(trouble) {
  put(byId("unsent"), TROUBLE[trouble] ?? "");
}
