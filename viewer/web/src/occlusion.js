// Where a surface sees little of the sky: in folds, between bodies, near a table. The surface is added up on a coarse grid
// in space, which is blurred; a point is as dark as what the grid has a little way in front of it. That follows every
// motion and costs a fraction of drawing.
import { Samples } from './samples.js';

const CELLS = 44; // along the longest side of the bodies
const AHEAD = 3; // cells in front of a point, where its own flat surroundings are hardly felt
const FLAT = 0.045; // what they leave there
const STRENGTH = 3.2;
const DARKEST = 0.6;

export class Occlusion {
  /** casts: whether a part counts; obstacle: whether the part is one, which is as large as it likes. */
  constructor(run, isObstacle, casts) {
    this.run = run;
    this.bodies = run.trianglePart.some((p) => !isObstacle(p));
    this.isObstacle = isObstacle;
    const box = this.boxOf(run.rest);
    this.samples = new Samples(run, Math.max(1e-3, this.spanOf(box) / CELLS), casts);
  }

  spanOf({ low, high }) { return Math.max(...low.map((v, k) => high[k] - v), 1e-6); }

  /** Of what moves; of everything where nothing does. */
  boxOf(x) {
    const { triangles, trianglePart } = this.run;
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let f = 0; f < trianglePart.length; ++f) {
      if (this.bodies && this.isObstacle(trianglePart[f])) continue;
      for (let c = 3 * f; c < 3 * f + 3; ++c) {
        const i = 3 * triangles[c];
        for (let k = 0; k < 3; ++k) {
          const v = x[i + k];
          if (v < low[k]) low[k] = v;
          if (v > high[k]) high[k] = v;
        }
      }
    }
    return low[0] <= high[0] ? { low, high } : { low: [0, 0, 0], high: [1, 1, 1] };
  }

  /** The grid around the shape as it is now. */
  place(x) {
    const box = this.boxOf(x);
    const size = this.spanOf(box) / CELLS;
    const pad = 8;
    this.size = size;
    this.origin = box.low.map((v) => v - pad * size);
    this.cells = box.high.map((v, k) => Math.ceil((v - box.low[k]) / size) + 2 * pad + 1);
    const count = this.cells[0] * this.cells[1] * this.cells[2];
    if (!this.grid || this.grid.length < count) {
      this.grid = new Float32Array(Math.ceil(1.3 * count));
      this.other = new Float32Array(this.grid.length);
    }
    this.grid.fill(0, 0, count);
  }

  gather(x) {
    const { samples: { triangle, weights, share }, run: { triangles }, origin: [ox, oy, oz], cells: [nx, ny, nz], size, grid } = this;
    const unit = 1 / (size * size);
    let last = -1, a = 0, b = 0, c = 0, area = 0;
    for (let s = 0; s < triangle.length; ++s) {
      const f = triangle[s];
      if (f !== last) {
        last = f;
        a = 3 * triangles[3 * f];
        b = 3 * triangles[3 * f + 1];
        c = 3 * triangles[3 * f + 2];
        const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
        const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
        const px = uy * vz - uz * vy, py = uz * vx - ux * vz, pz = ux * vy - uy * vx;
        area = 0.5 * Math.sqrt(px * px + py * py + pz * pz) * unit;
      }
      const p = weights[2 * s], q = weights[2 * s + 1], o = 1 - p - q;
      const gx = (o * x[a] + p * x[b] + q * x[c] - ox) / size;
      const gy = (o * x[a + 1] + p * x[b + 1] + q * x[c + 1] - oy) / size;
      const gz = (o * x[a + 2] + p * x[b + 2] + q * x[c + 2] - oz) / size;
      const i = Math.floor(gx), j = Math.floor(gy), k = Math.floor(gz);
      if (!(i >= 0 && j >= 0 && k >= 0 && i < nx - 1 && j < ny - 1 && k < nz - 1)) continue;
      const u = gx - i, v = gy - j, w = gz - k, cast = area * share[s];
      const at = (k * ny + j) * nx + i, up = at + nx * ny;
      const low = cast * (1 - w), high = cast * w;
      grid[at] += low * (1 - v) * (1 - u);
      grid[at + 1] += low * (1 - v) * u;
      grid[at + nx] += low * v * (1 - u);
      grid[at + nx + 1] += low * v * u;
      grid[up] += high * (1 - v) * (1 - u);
      grid[up + 1] += high * (1 - v) * u;
      grid[up + nx] += high * v * (1 - u);
      grid[up + nx + 1] += high * v * u;
    }
  }

  /** Three means over three cells along each axis are close to a bell; sums may run over the ends of rows, which are empty. */
  blur() {
    const { cells: [nx, ny, nz] } = this;
    const count = nx * ny * nz;
    for (const step of [1, nx, nx * ny]) {
      for (let pass = 0; pass < 3; ++pass) {
        const { grid, other } = this;
        other.fill(0, 0, step);
        other.fill(0, count - step, count);
        for (let i = step; i < count - step; ++i) other[i] = (grid[i - step] + grid[i] + grid[i + step]) / 3;
        [this.grid, this.other] = [other, grid];
      }
    }
  }

  /** How much of the light is missing at points with these normals, into `out`. */
  shade(x, source, normals, normalSource, out) {
    const { origin: [ox, oy, oz], cells: [nx, ny, nz], size, grid } = this;
    for (let s = 0; s < source.length; ++s) {
      const i3 = 3 * source[s], n3 = 3 * normalSource[s];
      const gx = (x[i3] - ox) / size + AHEAD * normals[n3];
      const gy = (x[i3 + 1] - oy) / size + AHEAD * normals[n3 + 1];
      const gz = (x[i3 + 2] - oz) / size + AHEAD * normals[n3 + 2];
      const i = Math.floor(gx), j = Math.floor(gy), k = Math.floor(gz);
      if (!(i >= 0 && j >= 0 && k >= 0 && i < nx - 1 && j < ny - 1 && k < nz - 1)) { out[s] = 0; continue; }
      const u = gx - i, v = gy - j, w = gz - k, at = (k * ny + j) * nx + i, up = at + nx * ny;
      const low = (1 - v) * (grid[at] * (1 - u) + grid[at + 1] * u) + v * (grid[at + nx] * (1 - u) + grid[at + nx + 1] * u);
      const high = (1 - v) * (grid[up] * (1 - u) + grid[up + 1] * u) + v * (grid[up + nx] * (1 - u) + grid[up + nx + 1] * u);
      const near = low * (1 - w) + high * w - FLAT;
      out[s] = near > 0 ? DARKEST * (1 - Math.exp(-STRENGTH * near)) : 0;
    }
  }

  setShape(x) {
    this.place(x);
    this.gather(x);
    this.blur();
  }
}
