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
  const e1 = [0, 0, 0], e2 = [0, 0, 0], s = [0, 0, 0];
  const o = origin.toArray(), d = direction.toArray();
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    for (let k = 0; k < 3; ++k) {
      e1[k] = x[b + k] - x[a + k];
      e2[k] = x[c + k] - x[a + k];
      s[k] = o[k] - x[a + k];
    }
    const px = d[1] * e2[2] - d[2] * e2[1], py = d[2] * e2[0] - d[0] * e2[2], pz = d[0] * e2[1] - d[1] * e2[0];
    const det = e1[0] * px + e1[1] * py + e1[2] * pz;
    if (Math.abs(det) < 1e-20) continue;
    const u = (s[0] * px + s[1] * py + s[2] * pz) / det;
    if (!(u >= 0 && u <= 1)) continue;
    const qx = s[1] * e1[2] - s[2] * e1[1], qy = s[2] * e1[0] - s[0] * e1[2], qz = s[0] * e1[1] - s[1] * e1[0];
    const v = (d[0] * qx + d[1] * qy + d[2] * qz) / det;
    if (!(v >= 0 && u + v <= 1)) continue;
    const far = (e2[0] * qx + e2[1] * qy + e2[2] * qz) / det;
    if (!(far > 0) || (best && far >= best.distance) || !shown(t / 3)) continue;
    const point = o.map((p, k) => p + far * d[k]);
    if (cut && cut.x * point[0] + cut.y * point[1] + cut.z * point[2] + cut.w > 0) continue;
    best = { triangle: t / 3, weights: [1 - u - v, u, v], point, distance: far };
  }
  return best;
}
