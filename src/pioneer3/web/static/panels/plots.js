// The plots: commanded and measured values over the last minutes, each chart drawn by uPlot.

import { make, makeButton, number, put, set } from "../dom.js";
import uPlot from "../vendor/uplot-1.6.32/uPlot.esm.js";
import { COLUMNS } from "./history.js";
import { TimeAxis } from "./time_axis.js";

const HEIGHT = 108; // px
const REDRAW = 200; // ms
const WORDS = 2000; // ms between two descriptions for screen readers

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

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
const MOVE = 0.5; // of the shown time
const LINES = [{ label: "commanded", colour: "--warn", dash: [6, 4] }, { label: "measured", colour: "--accent" }];

export class Plots {
  #history = null;
  #name = "";
  #charts = [];
  #rows = new Map();
  #open = false;
  #pausedAt = null;
  #row = null;
  #describedAt = -Infinity;
  #timer = 0;
  #clock;
  #axis = new TimeAxis(() => this.#draw());
  #box;
  #pause;
  #look;
  #later;
  #all;
  #lookWords = make("b", {}, "of now");

  /**
   * @param now  function(): the time of what is shown [s since 1970]
   * @param logs element for the logs
   */
  constructor(container, now, logs) {
    this.#clock = now;
    this.#pause = make("button", { type: "button", class: "choice", id: "plots-pause", "aria-pressed": "false" }, "Pause");
    const save = make("button", { type: "button", class: "choice", id: "plots-save" }, "Download CSV");
    this.#look = make("input", { type: "range", id: "plots-look", min: -1, max: 0, step: 1, value: 0 });
    const look = make("label", { class: "look" }, make("span", {}, "Values ", this.#lookWords), this.#look);
    const axis = this.#axis;
    const tool = (id, text, label, act) => makeButton(text, { class: "small", id: `plots-${id}`, "aria-label": label, title: label }, act);
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
    container.append(logs, make("div", { class: "plot-tools" }, this.#pause, save, tools, look), this.#box, how, table);
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
    this.#describedAt = -Infinity;
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
    return this.#pausedAt ?? this.#clock();
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
    if (performance.now() - this.#describedAt >= WORDS) this.#describe();
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
    put(this.#lookWords, words);
  }

  #freeze(paused) {
    this.#pausedAt = paused ? this.#clock() : null;
    set(this.#pause, "aria-pressed", String(paused));
    put(this.#pause, paused ? "Go on" : "Pause");
    this.#draw();
  }

  #describe() {
    this.#describedAt = performance.now();
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

/** One chart: lines over time, with their values above. */
class Chart {
  element;
  #plot;
  #picture;
  #values;
  #series;

  /**
   * @param title, unit, digits
   * @param series [{label, column, colour: name of a CSS variable, dash}]
   * @param range  function(least, greatest) -> [low, high]
   * @param axis   the TimeAxis that all charts share
   * @param group  charts of one group share their cursor
   * @param moved  function(row or null): the cursor stands there
   */
  constructor({ title, unit, digits, series, range, axis, group, moved }) {
    this.#series = series.map((one) => ({ ...one, digits }));
    this.#values = series.map(() => make("b", {}, "–"));
    const legend = series.map((one, i) => {
      const line = make("i", { class: `swatch${one.dash ? " dashed" : ""}` });
      line.style.setProperty("--swatch", `var(${one.colour})`);
      return make("span", { class: "key-of-line" }, ...(one.label ? [line, one.label] : []), this.#values[i]);
    });
    this.#picture = make("div", { class: "chart-picture", role: "img", "aria-label": title });
    const head = make("p", { class: "chart-head" }, make("span", { class: "chart-title" }, `${title} `, make("small", {}, unit)), ...legend);
    this.element = make("div", { class: "chart" }, head, this.#picture);
    this.#plot = new uPlot(this.#options(range, axis, group, moved), [[], ...series.map(() => [])], this.#picture);
  }

  /** Draws columns (times first) between two times [s]. */
  draw(columns, from, to) {
    this.#plot.setData([columns[0], ...this.#series.map(({ column }) => columns[column + 1])], false);
    this.#plot.setScale("x", { min: from, max: to });
  }

  /** Shows the values of a row as text. */
  read(columns, row) {
    this.#series.forEach(({ column, digits }, i) => {
      put(this.#values[i], number((row === null ? null : columns[column + 1][row]) ?? NaN, digits));
    });
  }

  /** Describes the picture in words. */
  describe(words) {
    set(this.#picture, "aria-label", words);
  }

  /** Puts the cursor at a time [s]; null takes it away. */
  point(time) {
    const left = time === null ? -10 : this.#plot.valToPos(time, "x");
    this.#plot.setCursor({ left, top: time === null ? -10 : 1 });
  }

  fit(width) {
    if (width > 0 && width !== this.#plot.width) this.#plot.setSize({ width, height: HEIGHT });
  }

  /** Draws again, in today's colours. */
  repaint() {
    this.#plot.redraw(false, true);
  }

  destroy() {
    this.#plot.destroy();
  }

  #options(range, axis, group, moved) {
    const look = {
      stroke: () => colour("--muted"),
      font: "11px system-ui, sans-serif",
      grid: { stroke: () => colour("--line"), width: 1 },
      ticks: { show: false },
    };
    return {
      width: 320,
      height: HEIGHT,
      padding: [6, 12, 0, 0],
      legend: { show: false },
      cursor: { y: false, drag: { x: false, y: false }, points: { size: 7 }, sync: { key: group } },
      scales: { x: { time: false, auto: false }, y: { range: (_, least, greatest) => range(least ?? 0, greatest ?? 0) } },
      axes: [
        { ...look, size: 22, splits: () => axis.marks, values: (_, marks) => marks.map((mark) => axis.ago(mark)) },
        { ...look, size: 44, space: 18 },
      ],
      series: [{}, ...this.#series.map(({ label, colour: name, dash }) => ({
        label, stroke: () => colour(name), width: dash ? 1.5 : 2, dash, points: { show: false }, spanGaps: false,
      }))],
      hooks: { setCursor: [(plot) => moved(plot.cursor.left >= 0 ? plot.cursor.idx ?? null : null)] },
    };
  }
}
