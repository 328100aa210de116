// A soft shadow on the ground below the bodies, as under a cloudy sky: without it they seem to float. The surface is
// added up on two grids as it lies above the ground, a coarse one for all of it and a fine one for what is near, and the
// grids are blurred: a fraction of what drawing costs. Where the scene has no table there is a faint floor.
import * as THREE from 'three';
import { Samples } from './samples.js';

const SIZE = 3.2; // of the ground, in scene units
const BELOW = 0.1; // what has no table hangs so far above its floor, in scene units
/** cells across; reach: height at which a body casts a third of its shadow; blur: cells and passes; the darkest. */
const FAR = { cells: 72, reach: 0.9, width: 2, passes: 3, darkest: 0.42 };
const NEAR = { cells: 160, reach: 0.07, width: 1, passes: 2, darkest: 0.5 };

const fragment = /* glsl */ `
uniform sampler2D far, near;
uniform vec4 floorColor;
varying vec2 at;
void main() {
  float light = (1.0 - texture2D(far, at).r) * (1.0 - texture2D(near, at).r);
  float r = length(at - 0.5) * 2.0;
  float edge = 1.0 - smoothstep(0.25, 0.95, r);
  float shadow = (1.0 - light) * (1.0 - smoothstep(0.8, 1.0, r));
  float ground = floorColor.a * edge;
  // The shadow lies on the floor.
  float alpha = shadow + ground * (1.0 - shadow);
  vec3 color = (vec3(0.02, 0.03, 0.05) * shadow + floorColor.rgb * ground * (1.0 - shadow)) / max(alpha, 1e-4);
  gl_FragColor = vec4(color, alpha);
}`;
const vertex = /* glsl */ `
varying vec2 at;
void main() {
  at = uv;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

class Shadow {
  constructor(look) {
    this.look = look;
    const { cells } = look;
    this.light = new Float32Array(cells * cells);
    this.blurred = new Float32Array(cells * cells);
    this.bytes = new Uint8Array(4 * cells * cells);
    this.texture = new THREE.DataTexture(this.bytes, cells, cells);
    this.texture.magFilter = this.texture.minFilter = THREE.LinearFilter;
  }

  add(x, y, above, area) {
    const { cells, reach } = this.look;
    const u = (x / SIZE + 0.5) * cells - 0.5, v = (y / SIZE + 0.5) * cells - 0.5;
    const m = Math.floor(u), n = Math.floor(v);
    if (!(m >= 0 && n >= 0 && m < cells - 1 && n < cells - 1)) return;
    const cast = area * Math.exp(-above / reach), s = u - m, r = v - n, at = n * cells + m;
    const { light } = this;
    light[at] += cast * (1 - s) * (1 - r);
    light[at + 1] += cast * s * (1 - r);
    light[at + cells] += cast * (1 - s) * r;
    light[at + cells + 1] += cast * s * r;
  }

  /** Means over a few cells each way, one after the other, are close to a bell. */
  blur() {
    const { cells, width, passes } = this.look;
    const sweep = (from, to, step, row) => {
      for (let r = 0; r < cells; ++r) {
        for (let c = 0; c < cells; ++c) {
          let sum = 0;
          for (let d = Math.max(-width, -c); d <= Math.min(width, cells - 1 - c); ++d) sum += from[r * row + (c + d) * step];
          to[r * row + c * step] = sum / (2 * width + 1);
        }
      }
    };
    for (let pass = 0; pass < passes; ++pass) {
      sweep(this.light, this.blurred, 1, cells);
      sweep(this.blurred, this.light, cells, 1);
    }
  }

  fill() {
    const { cells, darkest } = this.look;
    const cell = (SIZE / cells) ** 2;
    this.blur();
    for (let i = 0; i < this.light.length; ++i) this.bytes[4 * i] = 255 * darkest * (1 - Math.exp((-0.6 * this.light[i]) / cell));
    this.texture.needsUpdate = true;
  }
}

export class Ground {
  /** height: of the ground, or null where the lowest point of the bodies is. */
  constructor(run, up, height = null) {
    this.run = run;
    this.up = up === 'y' ? 1 : 2;
    this.across = up === 'y' ? [2, 0] : [0, 1];
    this.given = height;
    this.height = height ?? Infinity;
    this.setParts(() => true);
    this.cut = null;
    this.shadows = [new Shadow(FAR), new Shadow(NEAR)];
    const geometry = new THREE.BufferGeometry();
    this.corners = new THREE.BufferAttribute(new Float32Array(12), 3);
    geometry.setAttribute('position', this.corners);
    geometry.setAttribute('uv', new THREE.BufferAttribute(new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]), 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.uniforms = {
      far: { value: this.shadows[0].texture }, near: { value: this.shadows[1].texture }, floorColor: { value: new THREE.Vector4(1, 1, 1, 0) },
    };
    this.object = new THREE.Mesh(geometry, new THREE.ShaderMaterial({
      uniforms: this.uniforms, vertexShader: vertex, fragmentShader: fragment, transparent: true, depthWrite: false,
      side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4,
    }));
    this.object.frustumCulled = false;
    this.object.renderOrder = 1.5; // on a table, which is drawn before
  }

  /** shown: whether a part is to be seen. Takes effect with the next shape. */
  setParts(shown) {
    const { parts } = this.run.head;
    const casts = parts.map((part, p) => shown(p) && (!part.obstacle || this.isThick(p)));
    this.samples = new Samples(this.run, SIZE / NEAR.cells, (p) => casts[p]);
    this.hasTable = parts.some((part, p) => part.obstacle && shown(p) && !this.isThick(p));
  }

  /** plane: as Body.setCut() takes it; what a cut takes away casts no shadow. Takes effect with the next shape. */
  setCut(plane) { this.cut = plane; }

  /** Red, green, blue and strength, 0 to 1. */
  setFloor(color) { this.floor = color; }

  /** A table does not cast the shadow that lies on it. */
  isThick(part) {
    this.thick ??= new Map();
    if (this.thick.has(part)) return this.thick.get(part);
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
    this.thick.set(part, high - low > 0.02);
    return high - low > 0.02;
  }

  setShape(x) {
    const { cut, run: { triangles }, up, across: [a, b], samples: { triangle, weights, share }, shadows: [far, near] } = this;
    if (this.given === null) {
      const first = this.height === Infinity;
      for (let i = up; i < x.length; i += 3) if (x[i] < this.height) this.height = x[i];
      if (first) this.height -= BELOW;
    }
    far.light.fill(0);
    near.light.fill(0);
    let last = -1, i = 0, j = 0, k = 0, area = 0;
    for (let s = 0; s < triangle.length; ++s) {
      const t = triangle[s];
      if (t !== last) {
        last = t;
        i = 3 * triangles[3 * t];
        j = 3 * triangles[3 * t + 1];
        k = 3 * triangles[3 * t + 2];
        area = Math.abs((x[j + a] - x[i + a]) * (x[k + b] - x[i + b]) - (x[j + b] - x[i + b]) * (x[k + a] - x[i + a]));
      }
      const p = weights[2 * s], q = weights[2 * s + 1], o = 1 - p - q;
      if (cut) {
        let side = cut[3];
        for (let c = 0; c < 3; ++c) side += cut[c] * (o * x[i + c] + p * x[j + c] + q * x[k + c]);
        if (side > 0) continue;
      }
      const above = Math.max(0, o * x[i + up] + p * x[j + up] + q * x[k + up] - this.height);
      const u = o * x[i + a] + p * x[j + a] + q * x[k + a], v = o * x[i + b] + p * x[j + b] + q * x[k + b];
      far.add(u, v, above, area * share[s]);
      if (above < 4 * NEAR.reach) near.add(u, v, above, area * share[s]);
    }
    far.fill();
    near.fill();
    this.lay();
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
    const [red, green, blue, strength] = this.floor ?? [1, 1, 1, 0];
    this.uniforms.floorColor.value.set(red, green, blue, this.hasTable ? 0 : strength);
  }

  /** From below the ground there is none. */
  seenFrom(camera) { this.object.visible = camera.position.getComponent(this.up) > this.height; }
}
