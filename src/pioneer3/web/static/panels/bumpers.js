// A small drawing of the bumpers from above, each segment by itself, and the same in words.

import { make, put, set } from "./dom.js";

const SVG = "http://www.w3.org/2000/svg";
const SPREAD = 150; // degrees that a ring of segments covers
const RADIUS = 46;

function shape(tag, attributes) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
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

export class BumperDrawing {
  element;
  #svg;
  #words = make("p", { class: "words" });
  #key = "";
  #segments = [];

  constructor() {
    this.#svg = shape("svg", { viewBox: "0 0 100 100", class: "bumper-drawing", "aria-hidden": "true" });
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
    const arcs = (count, behind) => Array.from({ length: count }, (_, i) => shape("path", { d: arc(i, count, behind) }));
    this.#segments = [...arcs(front, false), ...arcs(rear, true)];
    const body = shape("rect", { x: 28, y: 24, width: 44, height: 52, rx: 8, class: "body" });
    const nose = shape("path", { d: "M50 32l7 11H43z", class: "nose" });
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
