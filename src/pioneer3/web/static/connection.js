// The WebSocket: connects, reconnects with back-off, measures the round trip. A socket that is silent for
// SILENCE ms counts as lost, whatever TCP reports.

const FIRST_RETRY = 500; // ms
const LAST_RETRY = 5000;
const PING = 500; // a mode ends after 2 s without one: SILENCE of web/control.py
const SILENCE = 4000;
const PHONE = 600; // px, the narrow side of a tablet's screen at least
const QUEUE = 512; // bytes; velocities behind a longer queue would arrive late

/** The kind of device in a word, which its browser may not tell: "phone", "tablet", or nothing for others. */
function deviceHere() {
  if (!matchMedia("(pointer: coarse)").matches) return "";
  return Math.min(screen.width, screen.height) < PHONE ? "phone" : "tablet";
}

export class Connection {
  #onMessage;
  #onChange;
  #onLost;
  #query;
  #socket = null;
  #retry = FIRST_RETRY;
  #timer = 0;
  #heardAt = 0;
  #pingedAt = -Infinity;

  /** Milliseconds from a ping to its answer, or null before the first. */
  roundTrip = null;
  /** When the next attempt is due [performance.now()], or null while connected or connecting. */
  retryAt = null;

  /** @param query behind the socket's address, such as "?robot=3"; by default that of the page */
  constructor({ onMessage, onChange, onLost, query = location.search }) {
    this.#query = query;
    this.#onMessage = onMessage;
    this.#onChange = onChange;
    this.#onLost = onLost;
    setInterval(() => this.#check(), PING);
    addEventListener("online", () => this.retryNow());
    document.addEventListener("visibilitychange", () => document.hidden || this.retryNow());
  }

  get open() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  connect() {
    clearTimeout(this.#timer);
    this.retryAt = null;
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(`${scheme}//${location.host}/ws?${new URLSearchParams([...new URLSearchParams(this.#query), ["device", deviceHere()]])}`);
    this.#socket = socket;
    this.#heardAt = performance.now();
    socket.addEventListener("open", () => this.#isCurrent(socket) && this.#opened());
    socket.addEventListener("message", (event) => this.#isCurrent(socket) && this.#receive(event.data));
    socket.addEventListener("close", () => this.#isCurrent(socket) && this.#lost());
    this.#onChange();
  }

  /**
   * Sends now or not at all: nothing is kept for a later connection. Returns whether it was sent.
   *
   * @param {import("./messages.d.ts").ToServer} message
   */
  send(message) {
    if (!this.open) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  /** Like send, but gives up when older messages still wait in the queue. */
  sendFresh(message) {
    return this.open && this.#socket.bufferedAmount < QUEUE && this.send(message);
  }

  /** Asks for a pong; for the server it is a sign of life. */
  ping() {
    this.#pingedAt = performance.now();
    return this.send({ type: "ping", t: this.#pingedAt });
  }

  /** Connects at once instead of waiting for the next attempt. */
  retryNow() {
    if (this.retryAt !== null) this.connect();
  }

  #isCurrent(socket) {
    return socket === this.#socket;
  }

  #opened() {
    this.#heardAt = performance.now();
    this.#onChange();
    this.ping();
  }

  #receive(text) {
    this.#heardAt = performance.now();
    this.#retry = FIRST_RETRY;
    this.#keepAlive(); // timers of a page in the background run once a minute, but messages always arrive
    let message;
    try {
      message = JSON.parse(text);
    } catch {
      return;
    }
    if (message?.type === "pong") this.roundTrip = Math.max(0, performance.now() - message.t);
    if (message?.type) this.#onMessage(message);
  }

  #check() {
    if (this.#socket === null) return;
    if (performance.now() - this.#heardAt > SILENCE) this.#lost();
    else this.#keepAlive();
  }

  #keepAlive() {
    if (performance.now() - this.#pingedAt >= PING) this.ping();
  }

  #lost() {
    const socket = this.#socket;
    this.#socket = null;
    socket.close();
    this.roundTrip = null;
    this.retryAt = performance.now() + this.#retry;
    this.#timer = setTimeout(() => this.connect(), this.#retry);
    this.#retry = Math.min(LAST_RETRY, this.#retry * 2);
    this.#onChange();
    this.#onLost();
  }
}
