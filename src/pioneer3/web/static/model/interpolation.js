// The pose to draw between two reports: never more than a delay behind the newest.

export const DELAY = 90; // ms, where reports come ten times a second
const JUMP = 0.5; // m; a larger step is not interpolated
const JUMP_ANGLE = 0.8; // rad

export class PoseInterpolator {
  #from = null;
  #to = null;
  #start = 0;
  #delay;

  /** @param delay [ms], a little less than the time between two reports */
  constructor(delay = DELAY) {
    this.#delay = delay;
  }

  /** Takes a pose that arrived at `now` [ms]. */
  moveTo(pose, now) {
    const current = this.at(now);
    const jumps = current === null
      || Math.hypot(pose.x - current.x, pose.y - current.y) > JUMP
      || Math.abs(wrap(pose.theta - current.theta)) > JUMP_ANGLE;
    this.#from = jumps ? pose : current;
    this.#to = pose;
    this.#start = now;
  }

  /** Pose to draw at `now` [ms], or null before the first. */
  at(now) {
    if (this.#to === null) return null;
    const k = Math.min(1, Math.max(0, (now - this.#start) / this.#delay));
    if (k === 1) return this.#to;
    return {
      x: this.#from.x + (this.#to.x - this.#from.x) * k,
      y: this.#from.y + (this.#to.y - this.#from.y) * k,
      theta: wrap(this.#from.theta + wrap(this.#to.theta - this.#from.theta) * k),
    };
  }

  /** Whether the pose still changes at `now`. */
  moving(now) {
    if (this.#to === null || now - this.#start >= this.#delay) return false;
    return ["x", "y", "theta"].some((key) => this.#from[key] !== this.#to[key]);
  }
}

const wrap = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));
