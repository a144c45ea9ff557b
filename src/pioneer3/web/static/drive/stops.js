// STOP and E-STOP: their buttons, the alarm, and the delivery of stops to the server.

import { byId, put, set } from "../dom.js";

const LIFETIME = 15000; // ms after the press in which a stop is sent
const ANSWER = 1000; // ms without an answer after which a stop counts as in doubt
const NAMED = 5; // at most so many robots are listed by name
const DRIVER = "When all is safe, reset it; the motors stay off until you drive or switch them on.";
const VIEWER = "A driver can reset it.";
const TROUBLE = {
  unsent: "STOP NOT SENT: there is no connection. It goes out first when the connection is back. Press the stop button on the robot.",
  expired: "STOP NOT SENT: there was no connection for too long. Press it again when the connection is back.",
  unanswered: "STOP NOT CONFIRMED: nothing has answered yet. Press the stop button on the robot if it still moves.",
};

/** Calls `act` when the button is pressed, not when it is released, by pointer or by keyboard. */
export function onPress(button, act) {
  let byPointer = false;
  button.addEventListener("pointerdown", () => {
    byPointer = true;
    act();
  });
  button.addEventListener("click", () => {
    if (!byPointer) act(); // Enter, or an assistive technology
    byPointer = false;
  });
}

/** Stops act on the press; resets need a full click. @param stop, emergencyStop, reset, resetAll function() */
export function listenToStops({ stop, emergencyStop, reset, resetAll }) {
  onPress(byId("stop"), stop);
  onPress(byId("estop"), emergencyStop);
  byId("reset").addEventListener("click", reset);
  byId("reset-all").addEventListener("click", resetAll);
}

/** Shows whether the emergency stop is latched. */
export function showStops(latched, usable) {
  document.body.classList.toggle("latched", latched);
  byId("reset").disabled = !usable;
  set(byId("estop"), "aria-pressed", String(latched));
  put(byId("estop-text"), latched ? "LATCHED" : "E-STOP");
}

/** Shows the alarm of a latched emergency stop. @param latched the robots with one @param model Model */
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

/** Shows that a stop is not delivered. @param trouble of the StopQueue */
export function showTrouble(trouble) {
  put(byId("unsent"), TROUBLE[trouble] ?? "");
}

/**
 * Delivers stops. One that could not be sent is kept for a while and goes out first when the connection is
 * back: a stop is safe at any time, which no other message is.
 */
export class StopQueue {
  #send;
  #ping;
  #delivered;
  #waiting = new Map(); // message as text -> {message, pressed, sent, doubtful}

  /**
   * @param send      function(message): returns whether it was sent
   * @param ping      function(): asks for a pong, which acknowledges all messages before it
   * @param delivered function(), when a stop that was in doubt has arrived
   */
  constructor({ send, ping, delivered }) {
    this.#send = send;
    this.#ping = ping;
    this.#delivered = delivered;
  }

  /** Sends a stop, now or later. */
  add(message) {
    this.#waiting.set(JSON.stringify(message), { message, pressed: performance.now(), sent: null, doubtful: false });
    this.flush(true);
  }

  /** Sends the stops that have not been sent. @param open whether the socket is */
  flush(open) {
    const now = performance.now();
    for (const [key, stop] of this.#waiting) {
      if (!open) stop.sent = null;
      if (stop.sent === null && now - stop.pressed > LIFETIME) this.#waiting.delete(key);
      else if (stop.sent === null && this.#send(stop.message)) stop.sent = now;
    }
    if (open && this.#waiting.size > 0) this.#ping();
  }

  /** A pong has come to the ping that was sent at `asked`. */
  acknowledge(asked) {
    for (const [key, stop] of this.#waiting) {
      if (stop.sent === null || asked < stop.sent) continue;
      this.#waiting.delete(key);
      if (stop.doubtful) this.#delivered();
    }
  }

  /** The trouble of delivery: "" for none, else "unsent", "unanswered" or "expired". */
  get trouble() {
    const now = performance.now();
    let trouble = "";
    for (const stop of this.#waiting.values()) {
      if (stop.sent === null) trouble = now - stop.pressed > LIFETIME ? trouble || "expired" : "unsent";
      else if (now - stop.sent > ANSWER) trouble ||= "unanswered";
      else continue;
      stop.doubtful = true;
    }
    return trouble;
  }
}
