// How a phone was turned since a moment: angles of its sensor -> tip, turn and flip. Pure.
// Quaternions are [w, x, y, z]; there is no attitude in which they are ambiguous, as angles are.

const RADIANS = Math.PI / 180;

/** Returns the attitude that `deviceorientation` means by alpha, beta, gamma [degrees] (W3C: Z-X'-Y''). */
export function attitude(alpha, beta, gamma) {
  const [z, x, y] = [alpha, beta, gamma].map((angle) => (angle * RADIANS) / 2);
  const about = (w, sin, axis) => [w, ...[0, 1, 2].map((i) => (i === axis ? sin : 0))];
  return product(
    product(about(Math.cos(z), Math.sin(z), 2), about(Math.cos(x), Math.sin(x), 0)),
    about(Math.cos(y), Math.sin(y), 1),
  );
}

/**
 * Returns the shortest turn from one attitude to another as a vector: its direction is the axis, in
 * the phone's own frame (x to the right, y to the top, z out of the screen), its length the angle [degrees].
 */
export function rotation(from, to) {
  const [w, ...axis] = product([from[0], -from[1], -from[2], -from[3]], to);
  const sine = Math.hypot(...axis);
  if (sine < 1e-9) return [0, 0, 0];
  const angle = (2 * Math.atan2(sine, Math.abs(w))) / RADIANS;
  const length = (Math.sign(w) || 1) * angle / sine;
  return axis.map((part) => part * length);
}

/**
 * Returns what a turn means to who looks at the screen [degrees]: `tip` its far edge down, `turn` it
 * to the left on the screen's plane, `flip` its left edge up.
 *
 * @param turned as `rotation` returns it
 * @param screenAngle `screen.orientation.angle`: 0 upright, 90 with the phone's top to the left [degrees]
 */
export function meaning([x, y, z], screenAngle) {
  const cos = Math.cos(screenAngle * RADIANS);
  const sin = Math.sin(screenAngle * RADIANS);
  return { tip: -(x * cos - y * sin), turn: z, flip: x * sin + y * cos };
}

function product([a, b, c, d], [e, f, g, h]) {
  return [
    a * e - b * f - c * g - d * h,
    a * f + b * e + c * h - d * g,
    a * g - b * h + c * e + d * f,
    a * h + b * g - c * f + d * e,
  ];
}
