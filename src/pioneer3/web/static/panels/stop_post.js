// Delivers stops. One that did not get through is kept for a while and goes out first when the
// connection is back: a stop is safe at any time, which no other message is.

const WORTH = 15000; // ms after the press
const ANSWER = 1000; // ms after which a stop that nobody has answered is said to be in doubt

export class StopPost {
  #send;
  #ping;
  #delivered;
  #waiting = new Map(); // what -> {message, pressed, sent}

  /**
   * @param send      function(message): says whether it was sent
   * @param ping      function(): asks for a pong, which shows that what was sent before has arrived
   * @param delivered function(late), when a stop that was in doubt has arrived
   */
  constructor({ send, ping, delivered }) {
    this.#send = send;
    this.#ping = ping;
    this.#delivered = delivered;
  }

  /** The user wants this stop. */
  press(message) {
    this.#waiting.set(JSON.stringify(message), { message, pressed: performance.now(), sent: null, doubtful: false });
    this.carryOn(true);
  }

  /** Sends what has not been sent; whether the socket is open may have changed. */
  carryOn(open) {
    const now = performance.now();
    for (const [what, stop] of this.#waiting) {
      if (!open) stop.sent = null;
      if (stop.sent === null && now - stop.pressed > WORTH) this.#waiting.delete(what);
      else if (stop.sent === null && this.#send(stop.message)) stop.sent = now;
    }
    if (open && this.#waiting.size > 0) this.#ping();
  }

  /** A pong has come to the ping that was sent at `asked`. */
  heard(asked) {
    for (const [what, stop] of this.#waiting) {
      if (stop.sent === null || asked < stop.sent) continue;
      this.#waiting.delete(what);
      if (stop.doubtful) this.#delivered();
    }
  }

  /** What to tell the user: "" if all is well, else "unsent", "unanswered" or "expired". */
  get trouble() {
    const now = performance.now();
    let trouble = "";
    for (const stop of this.#waiting.values()) {
      if (stop.sent === null) trouble = now - stop.pressed > WORTH ? trouble || "expired" : "unsent";
      else if (now - stop.sent > ANSWER) trouble ||= "unanswered";
      else continue;
      stop.doubtful = true;
    }
    return trouble;
  }
}
