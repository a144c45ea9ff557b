// What lasers see, where it was when they saw it.

const SIZE = 3; // px

/** What a sweep says as points of the map: [x, y, x, y, ...] [m]. */
export function pointsOf({ pose: [x_mm, y_mm, theta_mrad], first, step, ranges }) {
  const [x, y, theta] = [x_mm / 1000, y_mm / 1000, theta_mrad / 1000];
  const points = new Float32Array(2 * ranges.length);
  let count = 0;
  ranges.forEach((range_mm, number) => {
    if (range_mm === 0) return; // nothing answered
    const bearing = theta + first + number * step;
    points[count] = x + (range_mm / 1000) * Math.cos(bearing);
    points[count + 1] = y + (range_mm / 1000) * Math.sin(bearing);
    count += 2;
  });
  return points.subarray(0, count);
}

/** In world coordinates. @param points as above, or null without a scan */
export function drawLaser(context, view, palette, points) {
  if (!points) return;
  const size = SIZE / view.scale;
  const { left, right, bottom, top } = view.window;
  context.fillStyle = palette.laser;
  for (let at = 0; at < points.length; at += 2) {
    const [x, y] = [points[at], points[at + 1]];
    if (x < left || x > right || y < bottom || y > top) continue;
    context.fillRect(x - size / 2, y - size / 2, size, size);
  }
}
