// One chart of uPlot: lines over the last minutes, with their values above.

import uPlot from "../vendor/uplot-1.6.32/uPlot.esm.js";
import { make, number, put, set } from "./dom.js";

const HEIGHT = 108; // px
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Chart {
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

  /** Says in words what the picture shows. */
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
