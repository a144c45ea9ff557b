// The inputs of the page, put together as main.js does, without a server: `window.bench` has what they send.

import { Drive } from "/static/drive/drive.js";
import { Inputs, Limits } from "/static/drive/inputs.js";
import { StopQueue, listenToStops } from "/static/drive/stops.js";
import { Teleop, watchForLoss } from "/static/drive/teleop.js";

const sent = [];
const told = [];
const send = (message) => Boolean(sent.push(message));
const robot = { id: 1, snapshot: null };
const model = { refusal: null, driver: null, snapshot: null, selected: robot, chosen: [], mine: [], robots: new Map([[1, robot]]) };
const connection = { send, retryNow() {}, ping() {} };
const limits = new Limits();
const drive = new Drive({ send, limits: () => limits.values, onChange: () => inputs.show(drive) });
const stops = new StopQueue({ send, ping() {}, delivered() {} });
const teleop = new Teleop({ drive, model, stops, connection, notify: (text) => told.push(text), changed() {} });
const inputs = new Inputs(teleop);
listenToStops(teleop);
watchForLoss(teleop.abandon);

window.bench = {
  sent,
  told,
  get source() {
    return drive.source;
  },
  get held() {
    return [...drive.directions];
  },
  begin(gamepad, bounds) {
    limits.adopt(bounds);
    inputs.adopt({ gamepad });
  },
};
