// The history of a robot over the last minutes, for the plots and for the sparkline of the battery.

const SPAN = 300; // s
const GAP = 1.5; // s without a reading: the line breaks
const SLACK = 300; // rows too many before the oldest are forgotten
const SLOW = 10; // s between points of the battery's long line
const SLOW_SPAN = 4 * 3600; // s
const FRONT = Math.PI / 2 + 1e-3;
const ROUND = 1e4; // of a unit: more digits than that are noise

/** Columns of a row, in order: those of the charts, then the pose in the map. */
export const COLUMNS = [
  { name: "speed commanded", unit: "m/s", digits: 2 },
  { name: "speed measured", unit: "m/s", digits: 2 },
  { name: "turn rate commanded", unit: "rad/s", digits: 2 },
  { name: "turn rate measured", unit: "rad/s", digits: 2 },
  { name: "battery", unit: "V", digits: 1 },
  { name: "nearest echo in front", unit: "m", digits: 2 },
  { name: "x", unit: "m", digits: 2 },
  { name: "y", unit: "m", digits: 2 },
  { name: "heading", unit: "rad", digits: 2 },
];
/** Of them, in the order of the file. */
const SAVED = ["x", "y", "heading", ...COLUMNS.map(({ name }) => name).slice(0, -3)];

export class History {
  /** Times [s since 1970], then the columns, all of one length; null where nothing is known. */
  columns = [[], ...COLUMNS.map(() => [])];
  /** The battery over hours: pairs of time [s] and voltage [V]. */
  battery = [];

  static SPAN = SPAN;

  /** When the oldest reading came that is kept [s since 1970], or null. */
  get since() {
    return this.columns[0][0] ?? null;
  }

  get length() {
    return this.columns[0].length;
  }

  /** Takes a snapshot that came at `now` [s since 1970]; `sonars` are the robot's of hello. */
  add(snapshot, sonars, now) {
    const last = this.columns[0].at(-1) ?? now;
    if (now - last > GAP) this.#push(last + 1e-3, COLUMNS.map(() => null));
    const { twist, commanded, battery, robot_in_map: pose } = snapshot;
    this.#push(now, [
      commanded?.v ?? null, twist.v, commanded?.w ?? null, twist.w, battery.voltage, nearest(snapshot.sonar, sonars),
      pose.x, pose.y, pose.theta,
    ]);
    if (now - (this.battery.at(-1)?.[0] ?? -Infinity) >= SLOW) {
      this.battery.push([now, battery.voltage]);
      if (now - this.battery[0][0] > SLOW_SPAN) this.battery.shift();
    }
    this.#forget(now - SPAN);
  }

  /** Least, greatest, mean and last value of a column since `from` and until `to` [s]. */
  summary(column, from, to) {
    const [times] = this.columns;
    const values = this.columns[column + 1].filter((v, i) => v !== null && times[i] >= from && times[i] <= to);
    if (values.length === 0) return null;
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    return { least: Math.min(...values), greatest: Math.max(...values), mean, last: values.at(-1) };
  }

  /** All of it as comma-separated values (RFC 4180), a row a reading. */
  csv() {
    const order = SAVED.map((saved) => COLUMNS.findIndex(({ name }) => name === saved));
    const head = ["time", "elapsed [s]", ...order.map((at) => `${COLUMNS[at].name} [${COLUMNS[at].unit}]`)].join(",");
    const rounded = (value) => (value === null ? "" : Math.round(value * ROUND) / ROUND);
    const rows = this.columns[0].map((time, i) => {
      const values = order.map((at) => rounded(this.columns[at + 1][i]));
      return [new Date(time * 1000).toISOString(), rounded(time - this.since), ...values].join(",");
    });
    return [head, ...rows, ""].join("\r\n");
  }

  #push(time, values) {
    [time, ...values].forEach((value, i) => this.columns[i].push(value));
  }

  #forget(before) {
    const [times] = this.columns;
    const old = times.findIndex((time) => time >= before);
    if (old > SLACK) for (const column of this.columns) column.splice(0, old);
  }
}

/** The nearest echo of the sonars that look forward [m]; their reach where there is none. */
function nearest({ ranges, enabled }, { sonars = [], sonar_max: reach = null } = {}) {
  if (!enabled) return null;
  const ahead = ranges.filter((range, i) => range !== null && Math.abs(sonars[i]?.theta ?? 0) <= FRONT);
  return ahead.length ? Math.min(...ahead) : reach;
}
