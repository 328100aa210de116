// Points spread over a surface, each for a piece of its area: what shadows are made from. Large triangles have many, so
// that none of their size is lost on a grid.

const MOST = 24; // pieces along an edge of a triangle

export class Samples {
  /** wanted: whether a part counts. spacing: about how far apart, in scene units. */
  constructor(run, spacing, wanted) {
    const { rest, triangles, trianglePart } = run;
    this.triangles = triangles;
    const corners = [], weights = [], share = [];
    for (let f = 0; f < trianglePart.length; ++f) {
      if (!wanted(trianglePart[f])) continue;
      const at = [0, 1, 2].map((k) => 3 * triangles[3 * f + k]);
      let longest = 0;
      for (let k = 0; k < 3; ++k) {
        const a = at[k], b = at[(k + 1) % 3];
        longest = Math.max(longest, Math.hypot(rest[a] - rest[b], rest[a + 1] - rest[b + 1], rest[a + 2] - rest[b + 2]));
      }
      const n = Math.min(MOST, Math.max(1, Math.ceil(longest / spacing)));
      // Middles of the n^2 small triangles, those that stand upright and those between them.
      for (let i = 0; i < n; ++i) {
        for (let j = 0; i + j < n; ++j) {
          for (const [p, q] of i + j < n - 1 ? [[1 / 3, 1 / 3], [2 / 3, 2 / 3]] : [[1 / 3, 1 / 3]]) {
            corners.push(f);
            weights.push((i + p) / n, (j + q) / n);
            share.push(1 / (n * n));
          }
        }
      }
    }
    this.triangle = Uint32Array.from(corners);
    this.weights = Float32Array.from(weights);
    this.share = Float32Array.from(share);
  }

  get count() { return this.triangle.length; }
}
