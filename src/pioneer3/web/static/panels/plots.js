// The plots: what was commanded and what was measured, over the last minutes.

import { Chart } from "./chart.js";
import { make, number, put, set } from "./dom.js";
import { COLUMNS } from "./history.js";
import { TimeAxis } from "./time_axis.js";

const REDRAW = 200; // ms
const WORDS = 2000; // ms between two texts for those who do not see the picture

/** At least so much of the scale is shown; a little air above and below. */
function around(span, least, greatest) {
  const middle = (least + greatest) / 2;
  const half = Math.max(span, (greatest - least) * 1.15) / 2;
  return [middle - half, middle + half];
}

const withZero = (span) => (least, greatest) => around(span, Math.min(0, least), Math.max(0, greatest));
const CHARTS = [
  { title: "Speed", columns: [0, 1], range: withZero(0.2) },
  { title: "Turn rate", columns: [2, 3], range: withZero(0.4) },
  { title: "Battery", columns: [4], range: (least, greatest) => around(1, least, greatest) },
  { title: "Nearest echo in front", columns: [5], range: (_, greatest) => [0, Math.max(1, greatest * 1.05)] },
];
const PLOTTED = CHARTS.flatMap(({ columns }) => columns);
const ZOOM = 2;
const MOVE = 0.5; // of what is shown
const LINES = [{ label: "commanded", colour: "--warn", dash: [6, 4] }, { label: "measured", colour: "--accent" }];

export class Plots {
  #history = null;
  #name = "";
  #charts = [];
  #rows = new Map();
  #open = false;
  #pausedAt = null;
  #row = null;
  #spokenAt = -Infinity;
  #timer = 0;
  #axis = new TimeAxis(() => this.#draw());
  #box;
  #pause;
  #look;
  #later;
  #all;
  #moment = make("b", {}, "of now");

  constructor(container) {
    this.#pause = make("button", { type: "button", class: "choice", id: "plots-pause", "aria-pressed": "false" }, "Pause");
    const save = make("button", { type: "button", class: "choice", id: "plots-save" }, "Download CSV");
    this.#look = make("input", { type: "range", id: "plots-look", min: -1, max: 0, step: 1, value: 0 });
    const look = make("label", { class: "look" }, make("span", {}, "Values ", this.#moment), this.#look);
    const axis = this.#axis;
    const tool = (id, text, label, act) => {
      const button = make("button", { type: "button", class: "small", id: `plots-${id}`, "aria-label": label, title: label }, text);
      button.addEventListener("click", act);
      return button;
    };
    this.#later = tool("later", "▶", "Later", () => axis.move(MOVE * axis.span));
    this.#all = tool("all", "All", "Show all, until now", () => axis.reset());
    const tools = make("div", { class: "row", role: "group", "aria-label": "Time axis" },
      tool("in", "+", "Zoom in", () => axis.zoom(1 / ZOOM)), tool("out", "−", "Zoom out", () => axis.zoom(ZOOM)),
      tool("earlier", "◀", "Earlier", () => axis.move(-MOVE * axis.span)), this.#later, this.#all);
    const how = make("p", { class: "words" }, "Drag a chart to move in time; Ctrl and the wheel, or two fingers, zoom; a double click shows all.");
    this.#box = make("div", { class: "charts" });
    axis.listen(this.#box);
    const row = (text, ...cells) => make("tr", {}, make("th", { scope: "row" }, text), ...cells);
    const body = make("tbody");
    for (const { name, unit } of PLOTTED.map((column) => COLUMNS[column])) {
      const cells = ["last", "least", "greatest", "mean"].map(() => make("td", {}, "–"));
      this.#rows.set(name, cells);
      body.append(row(`${name[0].toUpperCase()}${name.slice(1)} [${unit}]`, ...cells));
    }
    const heads = ["", "now", "least", "greatest", "mean"].map((text) => (text ? make("th", { scope: "col" }, text) : make("td")));
    const table = make("table", { class: "numbers" }, make("caption", {}, "What the charts show, in numbers"), make("thead", {}, make("tr", {}, ...heads)), body);
    container.append(make("div", { class: "plot-tools" }, this.#pause, save, tools, look), this.#box, how, table);
    this.#pause.addEventListener("click", () => this.#freeze(this.#pausedAt === null));
    save.addEventListener("click", () => this.#save());
    this.#look.addEventListener("input", () => this.#point());
    new ResizeObserver(() => this.#charts.forEach((chart) => chart.fit(this.#box.clientWidth))).observe(this.#box);
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.#charts.forEach((chart) => chart.repaint()));
  }

  /** Shows the history of a robot of this name. */
  adopt(history, name) {
    [this.#history, this.#name] = [history, name];
    if (this.#open) this.#draw();
  }

  /** Draws while open, and only then. */
  setOpen(open) {
    if (open === this.#open) return;
    this.#open = open;
    clearInterval(this.#timer);
    if (!open) return;
    if (this.#charts.length === 0) this.#build();
    this.#spokenAt = -Infinity;
    this.#draw();
    this.#timer = setInterval(() => this.#pausedAt === null && this.#draw(), REDRAW);
  }

  #build() {
    this.#charts = CHARTS.map(({ title, columns, range }) => {
      const { unit, digits } = COLUMNS[columns[0]];
      const series = columns.map((column, i) => (columns.length > 1 ? { column, ...LINES[i] } : { column, label: "", colour: "--accent" }));
      return new Chart({ title, unit, digits, series, range, axis: this.#axis, group: "plots", moved: (row) => this.#moved(row) });
    });
    this.#box.replaceChildren(...this.#charts.map((chart) => chart.element));
    this.#charts.forEach((chart) => chart.fit(this.#box.clientWidth));
  }

  get #now() {
    return this.#pausedAt ?? Date.now() / 1000;
  }

  #draw() {
    if (!this.#history) return;
    const [{ columns }, axis] = [this.#history, this.#axis];
    axis.note(this.#now, this.#history.since);
    this.#charts.forEach((chart) => chart.draw(columns, axis.from, axis.to));
    this.#later.disabled = axis.follows;
    this.#all.disabled = axis.isWhole;
    set(this.#look, "min", String(-Math.floor(axis.span)));
    if (this.#look.value !== "0") this.#point();
    this.#read();
    if (performance.now() - this.#spokenAt >= WORDS) this.#speak();
  }

  #moved(row) {
    this.#row = row;
    this.#read();
  }

  /** The values under the cursor, or the newest. */
  #read() {
    if (!this.#history) return;
    const { columns } = this.#history;
    const row = this.#row ?? columns[0].findLastIndex((time) => time <= this.#axis.to);
    this.#charts.forEach((chart) => chart.read(columns, row < 0 ? null : row));
  }

  #point() {
    const back = Number(this.#look.value);
    const time = back === 0 ? null : this.#axis.to + back;
    this.#charts.forEach((chart) => chart.point(time));
    if (time === null) this.#moved(null);
    const ago = Math.round(this.#now - this.#axis.to - back);
    const words = ago === 0 ? "of now" : `of ${ago} seconds before`;
    set(this.#look, "aria-valuetext", words);
    put(this.#moment, words);
  }

  #freeze(paused) {
    this.#pausedAt = paused ? Date.now() / 1000 : null;
    set(this.#pause, "aria-pressed", String(paused));
    put(this.#pause, paused ? "Go on" : "Pause");
    this.#draw();
  }

  #speak() {
    this.#spokenAt = performance.now();
    const { from, to, words: when } = this.#axis;
    const summaries = PLOTTED.map((column) => this.#history.summary(column, from, to));
    PLOTTED.forEach((column) => {
      const { name, digits } = COLUMNS[column];
      const one = summaries[column];
      this.#rows.get(name).forEach((cell, i) => {
        put(cell, one ? number([one.last, one.least, one.greatest, one.mean][i], digits) : "–");
      });
    });
    CHARTS.forEach(({ title, columns }, i) => {
      const words = columns.map((column) => sentence(COLUMNS[column], summaries[column]));
      this.#charts[i].describe(`${title} over ${when}. ${words.join(" ")}`);
    });
  }

  #save() {
    const url = URL.createObjectURL(new Blob([this.#history?.csv() ?? ""], { type: "text/csv" }));
    const when = new Date().toISOString().slice(0, 19).replaceAll(":", "");
    const link = make("a", { href: url, download: `${this.#name.replace(/\W+/g, "-") || "robot"}-${when}.csv` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  }
}

function sentence({ name, unit, digits }, one) {
  if (!one) return `${name}: nothing known.`;
  const say = (value) => value.toFixed(digits);
  return `${name}: now ${say(one.last)} ${unit}, between ${say(one.least)} and ${say(one.greatest)}.`;
}
