// A line of one number over hours.

const SVG = "http://www.w3.org/2000/svg";
const WIDTH = 300;
const HEIGHT = 44;
const LEAST = 1; // V, the smallest range that fills the height

export class Sparkline {
  element;
  #path;

  constructor() {
    this.element = document.createElementNS(SVG, "svg");
    for (const [name, value] of Object.entries({ viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "sparkline", preserveAspectRatio: "none", role: "img" })) {
      this.element.setAttribute(name, value);
    }
    this.#path = this.element.appendChild(document.createElementNS(SVG, "path"));
  }

  /** @param points pairs of time [s] and value, in order */
  show(points, label) {
    this.element.setAttribute("aria-label", label);
    if (points.length < 2) return this.#path.setAttribute("d", "");
    const values = points.map(([, value]) => value);
    const middle = (Math.min(...values) + Math.max(...values)) / 2;
    const range = Math.max(LEAST, Math.max(...values) - Math.min(...values));
    const [begin, end] = [points[0][0], points.at(-1)[0]];
    const at = ([time, value]) => `${(((time - begin) / (end - begin || 1)) * WIDTH).toFixed(1)} ${(HEIGHT / 2 - ((value - middle) / range) * (HEIGHT - 6)).toFixed(1)}`;
    this.#path.setAttribute("d", `M${points.map(at).join("L")}`);
  }
}
