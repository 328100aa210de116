// The common motion of a body: the rotation and shift that fit its displacements best (Horn 1987).

/** Eigenvector of the largest eigenvalue of a symmetric 4 x 4 matrix, by rotations of Jacobi. */
function largestEigenvector(m) {
  const v = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]];
  for (let sweep = 0; sweep < 30; ++sweep) {
    let off = 0;
    for (let p = 0; p < 3; ++p) {
      for (let q = p + 1; q < 4; ++q) {
        off += m[p][q] ** 2;
        if (Math.abs(m[p][q]) < 1e-300) continue;
        const theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const t = (theta >= 0 ? 1 : -1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
        const c = 1 / Math.sqrt(t * t + 1), s = t * c;
        for (let k = 0; k < 4; ++k) {
          const a = m[k][p], b = m[k][q];
          m[k][p] = c * a - s * b;
          m[k][q] = s * a + c * b;
        }
        for (let k = 0; k < 4; ++k) {
          const a = m[p][k], b = m[q][k];
          m[p][k] = c * a - s * b;
          m[q][k] = s * a + c * b;
          const d = v[k][p], e = v[k][q];
          v[k][p] = c * d - s * e;
          v[k][q] = s * d + c * e;
        }
      }
    }
    if (off < 1e-30 * (m[0][0] ** 2 + m[1][1] ** 2 + m[2][2] ** 2 + m[3][3] ** 2)) break;
  }
  let best = 0;
  for (let k = 1; k < 4; ++k) if (m[k][k] > m[best][best]) best = k;
  return v.map((row) => row[best]);
}

const middle = (x, vertices) => {
  const sum = [0, 0, 0];
  for (const v of vertices) for (let k = 0; k < 3; ++k) sum[k] += x[3 * v + k];
  return sum.map((s) => s / vertices.length);
};

/** { rotation (rows), from, to }: a point X of rest is carried to rotation (X - from) + to. */
export function commonMotion(rest, now, vertices) {
  const from = middle(rest, vertices), to = middle(now, vertices);
  const s = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  for (const v of vertices) {
    for (let i = 0; i < 3; ++i) for (let j = 0; j < 3; ++j) s[i][j] += (rest[3 * v + i] - from[i]) * (now[3 * v + j] - to[j]);
  }
  const [w, x, y, z] = largestEigenvector([
    [s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
    [s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
    [s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
    [s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]],
  ]);
  return {
    from, to,
    rotation: [
      [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
      [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ],
  };
}

/** Vertices of each part that is no obstacle. */
export function verticesOfBodies(run) {
  const sets = run.head.parts.map(() => new Set());
  run.triangles.forEach((v, c) => sets[run.trianglePart[Math.floor(c / 3)]].add(v));
  return sets.filter((_, p) => !run.head.parts[p].obstacle).map((set) => Uint32Array.from(set)).filter((list) => list.length > 0);
}

/** Distances of vertices from where the common motion of their body carries them; zero for all others. */
export function apartFromCommon(rest, now, bodies) {
  const out = new Float32Array(rest.length / 3);
  for (const vertices of bodies) {
    const { rotation, from, to } = commonMotion(rest, now, vertices);
    for (const v of vertices) {
      let sum = 0;
      for (let i = 0; i < 3; ++i) {
        let carried = to[i];
        for (let j = 0; j < 3; ++j) carried += rotation[i][j] * (rest[3 * v + j] - from[j]);
        sum += (now[3 * v + i] - carried) ** 2;
      }
      out[v] = Math.sqrt(sum);
    }
  }
  return out;
}

export const RELATIVE = {
  name: 'relative', label: 'Displacement less the common motion', unit: 'm', kind: 'relative', place: 'vertex', diverging: false, center: 0, categories: [],
};

/** Ranges of values at vertices of bodies by the share of them that is in it; all begin at zero. */
export function quantiles(values, bodies) {
  const all = [];
  for (const vertices of bodies) for (const v of vertices) all.push(values[v]);
  all.sort((a, b) => a - b);
  const last = all.length - 1;
  const at = (share) => [0, last < 0 ? 0 : all[Math.round(last * (0.5 + 0.5 * share))]];
  return { 1: at(1), 0.98: at(0.98), 0.9: at(0.9) };
}
