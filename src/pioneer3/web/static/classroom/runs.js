// The runs that students handed in: how many, and a list with downloads and replays.

import { byId, make, number, put, putItems } from "../dom.js";

/** @param {import("../messages.d.ts").HandedIn[]} runs */
export function showRuns(runs) {
  put(byId("runs-count"), String(runs.length));
  byId("runs-none").hidden = runs.length > 0;
  byId("runs-table").hidden = runs.length === 0;
  const newest = [...runs].sort((a, b) => b.at - a.at);
  putItems(byId("runs-list"), JSON.stringify(newest), () => newest.map(row));
}

function row({ file, student, robot, at, seconds, size }) {
  const link = make("a", { href: `/api/class/runs/${encodeURIComponent(file)}`, download: file, "aria-label": `Download ${file}` }, file);
  const replay = make("a", { href: `/?replay=${encodeURIComponent(file)}`, target: "_blank", "aria-label": `Replay ${file}` }, "Replay");
  const cells = [student, String(robot), new Date(at * 1000).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" }), duration(seconds), inWords(size)];
  return make("tr", {}, ...cells.map((text) => make("td", {}, text)), make("td", {}, link), make("td", {}, replay));
}

/** Minutes and seconds, such as 1:05. */
export function duration(seconds) {
  const whole = Math.max(0, Math.floor(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

function inWords(bytes) {
  return bytes < 1e6 ? `${number(bytes / 1e3, 0)} kB` : `${number(bytes / 1e6, 1)} MB`;
}
