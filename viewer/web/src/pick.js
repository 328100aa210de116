// What lies under a point of the picture.
import * as THREE from 'three';

/** The nearest triangle along a ray of the camera: { triangle, weights, point, distance }, or null. */
export function pick(stage, event) {
  const { left, top, width, height } = stage.canvas.getBoundingClientRect();
  const at = new THREE.Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
  const caster = new THREE.Raycaster();
  stage.camera.updateMatrixWorld();
  caster.setFromCamera(at, stage.camera);
  return nearest(stage.body.positions, stage.run.triangles, caster.ray, stage.body.shows.cut ? stage.body.uniforms.cut.value : null,
    (t) => stage.body.looks[stage.run.trianglePart[t]] === 'shown');
}

/** Moeller and Trumbore; what a cut has taken away is not there, nor what is hidden or looked through. */
function nearest(x, triangles, { origin, direction }, cut, shown) {
  let best = null;
  const { x: ox, y: oy, z: oz } = origin, { x: dx, y: dy, z: dz } = direction;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ax = x[a], ay = x[a + 1], az = x[a + 2];
    const fx = x[c] - ax, fy = x[c + 1] - ay, fz = x[c + 2] - az;
    const px = dy * fz - dz * fy, py = dz * fx - dx * fz, pz = dx * fy - dy * fx;
    const ex = x[b] - ax, ey = x[b + 1] - ay, ez = x[b + 2] - az;
    const det = ex * px + ey * py + ez * pz;
    if (Math.abs(det) < 1e-20) continue;
    const sx = ox - ax, sy = oy - ay, sz = oz - az;
    const u = (sx * px + sy * py + sz * pz) / det;
    if (!(u >= 0 && u <= 1)) continue;
    const qx = sy * ez - sz * ey, qy = sz * ex - sx * ez, qz = sx * ey - sy * ex;
    const v = (dx * qx + dy * qy + dz * qz) / det;
    if (!(v >= 0 && u + v <= 1)) continue;
    const far = (fx * qx + fy * qy + fz * qz) / det;
    if (!(far > 0) || (best && far >= best.distance) || !shown(t / 3)) continue;
    const point = [ox + far * dx, oy + far * dy, oz + far * dz];
    if (cut && cut.x * point[0] + cut.y * point[1] + cut.z * point[2] + cut.w > 0) continue;
    best = { triangle: t / 3, weights: [1 - u - v, u, v], point, distance: far };
  }
  return best;
}
