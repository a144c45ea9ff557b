// The parts of the views: rows of values, findings of the diagnosis, bumpers, controller lines, a sparkline.

import { helpLinks, make, makeSvg, number, put, putItems, set } from "../dom.js";

const SIGNS = { ok: "✓", warn: "!", fail: "✕" };
const WORDS = { ok: "fine", warn: "warning", fail: "failure" };
const SLOW_TRIP = 120; // ms
const VERY_SLOW_TRIP = 300;
const SPREAD = 150; // degrees, of the segments at one end
const RADIUS = 46; // of the bumpers
const WIDTH = 300; // of the sparkline
const HEIGHT = 44;
const LEAST = 1; // V, the smallest range that fills the height

/** A list of names and values. */
export class Rows {
  element = make("dl", { class: "rows" });
  #values = new Map();

  /** @param names in order, each {id, name} */
  constructor(names) {
    for (const [id, name] of Object.entries(names)) {
      const value = make("dd", {}, "–");
      this.#values.set(id, value);
      this.element.append(make("dt", {}, name), value);
    }
  }

  /** @param level "bad", "warn" or nothing: never the only sign */
  show(id, text, level = null) {
    put(this.#values.get(id), text);
    set(this.#values.get(id), "data-level", level);
  }
}

/** A titled part of a view. */
export function part(title, ...children) {
  return make("section", { class: "part" }, make("h3", {}, title), ...children);
}

/** Shows findings of the server's diagnosis. @param findings [{check, level, found, meaning, advice, symptom}] */
export function showFindings(list, findings) {
  putItems(list, JSON.stringify(findings), () => findings.map(item));
}

/** Shows whether the page is near enough to the driver. @param roundTrip [ms], or null if not known */
export function showRoundTrip(list, roundTrip) {
  if (roundTrip === null || roundTrip <= SLOW_TRIP) return showFindings(list, []);
  showFindings(list, [{
    check: "page",
    level: roundTrip > VERY_SLOW_TRIP ? "fail" : "warn",
    found: "this page reaches the driver slowly",
    meaning: "Keys and stops arrive late by as much.",
    advice: "Come nearer to the access point, or use a cable; keep the speed low.",
    symptom: "page-is-slow",
  }]);
}

function item({ check, level, found, meaning, advice, symptom }) {
  const sign = make("b", { class: "sign", "aria-hidden": "true" }, SIGNS[level]);
  const lines = [meaning, advice].filter(Boolean).map((line) => make("span", {}, line));
  const head = make("strong", {}, `${check}: `, make("span", { class: "sr-only" }, `${WORDS[level]}: `), found);
  return make("li", { "data-level": level }, sign, make("div", {}, head, ...lines, ...helpLinks(symptom)));
}

/** The arc of segment `i` of `count`, clockwise from the left end in front; behind from the right. */
function arc(i, count, behind) {
  const gap = 3;
  const width = SPREAD / count;
  const start = (behind ? 90 : -90) - SPREAD / 2 + i * width + gap / 2;
  const [x1, y1] = onCircle(start);
  const [x2, y2] = onCircle(start + width - gap);
  return `M${x1} ${y1}A${RADIUS} ${RADIUS} 0 0 1 ${x2} ${y2}`;
}

function onCircle(angle) {
  const radians = (angle * Math.PI) / 180;
  return [50 + RADIUS * Math.cos(radians), 50 + RADIUS * Math.sin(radians)].map((value) => value.toFixed(1));
}

/** The bumpers from above, each segment by itself, and the same in words. */
export class BumperDrawing {
  element;
  #svg;
  #words = make("p", { class: "words" });
  #key = "";
  #segments = [];

  constructor() {
    this.#svg = makeSvg("svg", { viewBox: "0 0 100 100", class: "bumper-drawing", "aria-hidden": "true" });
    this.element = make("div", { class: "bumpers-box" }, this.#svg, this.#words);
  }

  /** @param bumpers {front, rear}: whether each segment is pressed */
  show({ front, rear }) {
    this.#build(front.length, rear.length);
    [...front, ...rear].forEach((pressed, i) => set(this.#segments[i], "class", pressed ? "hit" : "free"));
    put(this.#words, [side("front", front, "left"), side("rear", rear, "right")].join(" "));
  }

  #build(front, rear) {
    const key = `${front} ${rear}`;
    if (key === this.#key) return;
    this.#key = key;
    const arcs = (count, behind) => Array.from({ length: count }, (_, i) => makeSvg("path", { d: arc(i, count, behind) }));
    this.#segments = [...arcs(front, false), ...arcs(rear, true)];
    const body = makeSvg("rect", { x: 28, y: 24, width: 44, height: 52, rx: 8, class: "body" });
    const nose = makeSvg("path", { d: "M50 32l7 11H43z", class: "nose" });
    this.#svg.style.display = front + rear ? "" : "none";
    this.#svg.replaceChildren(body, nose, ...this.#segments);
  }
}

function side(name, segments, first) {
  if (segments.length === 0) return `No bumpers at the ${name}.`;
  const hit = segments.flatMap((pressed, i) => (pressed ? [i + 1] : []));
  const title = `${name[0].toUpperCase()}${name.slice(1)}`;
  if (hit.length === 0) return `${title}: ${segments.length} segments, all free.`;
  return `${title}: segment ${hit.join(", ")} of ${segments.length} PRESSED, counted from the ${first}.`;
}

/** Digital and analog lines of the controller. */
export class LineBoard {
  element;
  #inputs = make("ol", { class: "bits", "aria-label": "Digital inputs", start: 0 });
  #outputs = make("ol", { class: "bits", "aria-label": "Digital outputs", start: 0 });
  #analog = make("p", { class: "words" });

  constructor() {
    this.element = make("div", {}, make("h4", {}, "Digital inputs"), this.#inputs, make("h4", {}, "Digital outputs"), this.#outputs, make("h4", {}, "Analog inputs"), this.#analog);
  }

  show({ digital_in: inputs, digital_out: outputs, analog, selected }) {
    bits(this.#inputs, inputs);
    bits(this.#outputs, outputs);
    const chosen = `port ${selected.port}: ${number(selected.voltage, 2)} V`;
    put(this.#analog, analog?.length ? analog.map((voltage, port) => `${port}: ${number(voltage, 2)} V`).join("   ") : `Only the selected one is known, ${chosen}.`);
  }
}

function bits(list, levels) {
  if (list.children.length !== levels.length) {
    list.replaceChildren(...levels.map((_, i) => make("li", {}, make("small", {}, String(i)), make("b", {}))));
  }
  levels.forEach((high, i) => {
    const item = list.children[i];
    set(item, "class", high ? "high" : "low");
    put(item.lastElementChild, high ? "1" : "0");
  });
}

/** A line of one number over hours. */
export class Sparkline {
  element;
  #path;

  constructor() {
    this.#path = makeSvg("path");
    this.element = makeSvg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "sparkline", preserveAspectRatio: "none", role: "img", "aria-label": "Nothing yet" }, this.#path);
  }

  /** @param points pairs of time [s] and value, in order */
  show(points, label) {
    set(this.element, "aria-label", label);
    if (points.length < 2) return this.#path.setAttribute("d", "");
    const values = points.map(([, value]) => value);
    const middle = (Math.min(...values) + Math.max(...values)) / 2;
    const range = Math.max(LEAST, Math.max(...values) - Math.min(...values));
    const [begin, end] = [points[0][0], points.at(-1)[0]];
    const at = ([time, value]) => `${(((time - begin) / (end - begin || 1)) * WIDTH).toFixed(1)} ${(HEIGHT / 2 - ((value - middle) / range) * (HEIGHT - 6)).toFixed(1)}`;
    this.#path.setAttribute("d", `M${points.map(at).join("L")}`);
  }
}
