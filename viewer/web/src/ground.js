// A soft shadow on the ground below the bodies, as under a cloudy sky: without it they seem to float. The triangles are
// added up on a coarse grid as they lie above it, and the grid is blurred: a fraction of what drawing costs.
import * as THREE from 'three';

const CELLS = 72; // across the ground
const SIZE = 3.2; // of the ground, in scene units
const REACH = 0.9; // height at which a body casts a third of the shadow
const DARKEST = 0.42;

const fragment = /* glsl */ `
uniform sampler2D shadow;
varying vec2 at;
void main() {
  gl_FragColor = vec4(0.02, 0.03, 0.05, texture2D(shadow, at).r);
}`;
const vertex = /* glsl */ `
varying vec2 at;
void main() {
  at = uv;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export class Ground {
  /** height: of the ground, or null where the lowest point of the bodies is. */
  constructor(run, up, height = null) {
    this.run = run;
    this.up = up === 'y' ? 1 : 2;
    this.across = up === 'y' ? [2, 0] : [0, 1];
    this.given = height;
    this.height = height ?? Infinity;
    this.casts = run.trianglePart.map((p) => (run.head.parts[p].obstacle && !this.isThick(p) ? 0 : 1));
    this.light = new Float32Array(CELLS * CELLS);
    this.blurred = new Float32Array(CELLS * CELLS);
    this.bytes = new Uint8Array(4 * CELLS * CELLS);
    this.texture = new THREE.DataTexture(this.bytes, CELLS, CELLS);
    this.texture.magFilter = this.texture.minFilter = THREE.LinearFilter;
    const geometry = new THREE.BufferGeometry();
    this.corners = new THREE.BufferAttribute(new Float32Array(12), 3);
    geometry.setAttribute('position', this.corners);
    geometry.setAttribute('uv', new THREE.BufferAttribute(new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]), 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.object = new THREE.Mesh(geometry, new THREE.ShaderMaterial({
      uniforms: { shadow: { value: this.texture } }, vertexShader: vertex, fragmentShader: fragment, transparent: true, depthWrite: false,
      side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4,
    }));
    this.object.frustumCulled = false;
    this.object.renderOrder = 1.5; // on a table, which is drawn before
  }

  /** A table does not cast the shadow that lies on it. */
  isThick(part) {
    const { run } = this;
    let low = Infinity, high = -Infinity;
    run.trianglePart.forEach((p, t) => {
      if (p !== part) return;
      for (let k = 0; k < 3; ++k) {
        const v = run.rest[3 * run.triangles[3 * t + k] + this.up];
        low = Math.min(low, v);
        high = Math.max(high, v);
      }
    });
    return high - low > 0.02;
  }

  setShape(x) {
    const { run: { triangles }, up, across: [a, b], casts, light } = this;
    if (this.given === null) {
      for (let i = up; i < x.length; i += 3) if (x[i] < this.height) this.height = x[i];
    }
    light.fill(0);
    const place = (v) => (v / SIZE + 0.5) * CELLS - 0.5;
    for (let t = 0; t < casts.length; ++t) {
      if (!casts[t]) continue;
      const i = 3 * triangles[3 * t], j = 3 * triangles[3 * t + 1], k = 3 * triangles[3 * t + 2];
      const area = Math.abs((x[j + a] - x[i + a]) * (x[k + b] - x[i + b]) - (x[j + b] - x[i + b]) * (x[k + a] - x[i + a]));
      const above = Math.max(0, (x[i + up] + x[j + up] + x[k + up]) / 3 - this.height);
      const u = place((x[i + a] + x[j + a] + x[k + a]) / 3), v = place((x[i + b] + x[j + b] + x[k + b]) / 3);
      const m = Math.floor(u), n = Math.floor(v);
      if (!(m >= 0 && n >= 0 && m < CELLS - 1 && n < CELLS - 1)) continue;
      const cast = area * Math.exp(-above / REACH), s = u - m, r = v - n, at = n * CELLS + m;
      light[at] += cast * (1 - s) * (1 - r);
      light[at + 1] += cast * s * (1 - r);
      light[at + CELLS] += cast * (1 - s) * r;
      light[at + CELLS + 1] += cast * s * r;
    }
    this.blur();
    this.fill();
    this.lay();
  }

  /** Three means over five cells each way are close to a bell. */
  blur() {
    const sweep = (from, to, step, row) => {
      for (let r = 0; r < CELLS; ++r) {
        for (let c = 0; c < CELLS; ++c) {
          let sum = 0;
          for (let d = Math.max(-2, -c); d <= Math.min(2, CELLS - 1 - c); ++d) sum += from[r * row + (c + d) * step];
          to[r * row + c * step] = sum / 5;
        }
      }
    };
    for (let pass = 0; pass < 3; ++pass) {
      sweep(this.light, this.blurred, 1, CELLS);
      sweep(this.blurred, this.light, CELLS, 1);
    }
  }

  fill() {
    const cell = (SIZE / CELLS) ** 2;
    for (let i = 0; i < this.light.length; ++i) this.bytes[4 * i] = 255 * DARKEST * (1 - Math.exp((-0.6 * this.light[i]) / cell));
    this.texture.needsUpdate = true;
  }

  lay() {
    const [a, b] = this.across;
    const half = SIZE / 2;
    [[-half, -half], [half, -half], [half, half], [-half, half]].forEach(([u, v], i) => {
      this.corners.array[3 * i + a] = u;
      this.corners.array[3 * i + b] = v;
      this.corners.array[3 * i + this.up] = this.height + 0.002;
    });
    this.corners.needsUpdate = true;
  }

  /** From below the ground there is none. */
  seenFrom(camera) { this.object.visible = camera.position.getComponent(this.up) > this.height; }
}
