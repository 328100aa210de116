// Planes that a picture is cut by: across an axis, or in any direction.

/** Around and up from the horizontal, in degrees, as a unit vector. up: 'y' or 'z'. */
export function directionOf(azimuth, elevation, up) {
  const a = (azimuth * Math.PI) / 180, e = (elevation * Math.PI) / 180;
  const level = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a)];
  const n = up === 'y' ? [level[0], Math.sin(e), -level[1]] : [level[0], level[1], Math.sin(e)];
  return n.map((v) => (Math.abs(v) < 1e-12 ? 0 : v)); // along an axis exactly
}

/** The angles of a direction. */
export function anglesOf([x, y, z], up) {
  const [p, q, height] = up === 'y' ? [x, -z, y] : [x, y, z];
  return [(Math.atan2(q, p) * 180) / Math.PI, (Math.atan2(height, Math.hypot(p, q)) * 180) / Math.PI];
}

/** cut: { axis: 'x', 'y', 'z' or 'free', azimuth, elevation }. */
export function cutNormal(cut, up) {
  if (cut.axis === 'free') return directionOf(cut.azimuth, cut.elevation, up);
  return ['x', 'y', 'z'].map((axis) => (axis === cut.axis ? 1 : 0));
}

/** The lowest and the highest place of a box along a direction. */
export function spanOf({ low, high }, n) {
  let least = 0, most = 0;
  for (let k = 0; k < 3; ++k) {
    least += Math.min(n[k] * low[k], n[k] * high[k]);
    most += Math.max(n[k] * low[k], n[k] * high[k]);
  }
  return [least, most];
}
