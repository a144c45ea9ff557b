// How far a stick is out -> how much is asked for.

/**
 * Returns -1 to 1 for how far out an axis is, -1 to 1; nothing inside the dead zone.
 *
 * @param value  anything that is no number counts as the middle
 * @param dead   half width of the dead zone, 0 to 1
 * @param gentle 0: in proportion; 1: by the cube, for a fine touch near the middle
 */
export function response(value, dead, gentle = 0) {
  const out = Math.min(1, Math.abs(value));
  if (!(out > dead)) return 0;
  const part = (out - dead) / (1 - dead);
  return Math.sign(value) * (part * (1 - gentle) + part ** 3 * gentle);
}

/** Returns the point of the unit circle's disc that is nearest in the direction of x, y. */
export function withinCircle(x, y) {
  const far = Math.max(1, Math.hypot(x, y));
  return [x / far, y / far];
}
