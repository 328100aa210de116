// Forces of contacts as arrows, and fibers as short lines.
import * as THREE from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';

const LONGEST = 0.42; // of an arrow, in scene units
const SHORTEST = 0.012; // what is shorter is left out
const AROUND = 10;
const HIDDEN_OPACITY = 0.3;
export const FORCE_COLORS = { normal: '#c8321e', friction: '#1d8a6b' };

const vertex = /* glsl */ `
attribute vec3 from, along;
varying float vLight;
void main() {
  float size = length(along);
  vec3 z = along / max(size, 1e-9);
  vec3 x = normalize(abs(z.z) < 0.9 ? cross(z, vec3(0.0, 0.0, 1.0)) : cross(z, vec3(1.0, 0.0, 0.0)));
  vec3 y = cross(z, x);
  // The head keeps its size as long as there is room for it.
  float head = min(0.05, 0.5 * size), thick = min(1.0, size / 0.1);
  float up = position.z < 0.5 ? 0.0 : (position.z < 1.5 ? size - head : size);
  vec3 side = (position.x * x + position.y * y) * thick;
  vec4 eye = modelViewMatrix * vec4(from + side + up * z, 1.0);
  vec3 n = position.z > 1.5 ? z : normalize(side + 1e-9 * z);
  vLight = 0.72 + 0.28 * (normalMatrix * n).z;
  gl_Position = projectionMatrix * eye;
}`;
const fragment = /* glsl */ `
uniform vec3 color;
uniform float opacity;
varying float vLight;
void main() { gl_FragColor = vec4(color * vLight, opacity); }`;

/** A shaft and a head along z: z is 0 at the tail, 1 where the head begins and 2 at the tip. */
function arrowShape() {
  const points = [], corners = [];
  const ring = (radius, z) => {
    for (let k = 0; k < AROUND; ++k) {
      const angle = (2 * Math.PI * k) / AROUND;
      points.push(radius * Math.cos(angle), radius * Math.sin(angle), z);
    }
    return points.length / 3 - AROUND;
  };
  const ribbon = (a, b) => {
    for (let k = 0; k < AROUND; ++k) {
      const n = (k + 1) % AROUND;
      corners.push(a + k, a + n, b + k, a + n, b + n, b + k);
    }
  };
  const tail = ring(0.0065, 0), neck = ring(0.0065, 1), head = ring(0.019, 1), tip = ring(0, 2);
  ribbon(tail, neck);
  ribbon(neck, head);
  ribbon(head, tip);
  return { points, corners };
}

class ArrowSet {
  constructor(parent, color) {
    const { points, corners } = arrowShape();
    this.geometry = new THREE.InstancedBufferGeometry();
    this.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points), 3));
    this.geometry.setIndex(corners);
    this.geometry.instanceCount = 0;
    this.room = 0;
    this.objects = [true, false].map((depthTest) => {
      const material = new THREE.ShaderMaterial({
        uniforms: { color: { value: new THREE.Color(color) }, opacity: { value: depthTest ? 1 : HIDDEN_OPACITY } },
        vertexShader: vertex, fragmentShader: fragment, side: THREE.DoubleSide, transparent: !depthTest, depthTest, depthWrite: depthTest,
      });
      const mesh = new THREE.Mesh(this.geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = depthTest ? 295 : 294;
      parent.add(mesh);
      return mesh;
    });
  }

  /** from, along: three numbers each an arrow. */
  set(from, along) {
    const count = from.length / 3;
    for (const object of this.objects) object.visible = count > 0;
    this.geometry.instanceCount = count;
    if (count > this.room) {
      this.room = Math.ceil(1.5 * count);
      this.geometry.dispose();
      for (const name of ['from', 'along']) {
        this.geometry.setAttribute(name, new THREE.InstancedBufferAttribute(new Float32Array(3 * this.room), 3).setUsage(THREE.DynamicDrawUsage));
      }
    }
    if (count === 0) return;
    for (const [name, values] of [['from', from], ['along', along]]) {
      const attribute = this.geometry.getAttribute(name);
      attribute.array.set(values);
      attribute.needsUpdate = true;
    }
  }
}

export class Arrows {
  constructor() {
    this.object = new THREE.Group();
    this.normal = new ArrowSet(this.object, FORCE_COLORS.normal);
    this.friction = new ArrowSet(this.object, FORCE_COLORS.friction);
    this.lines = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({
      color: 0x3a1f5d, linewidth: 1.7, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -24,
    }));
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 289;
    this.lines.visible = false;
    this.object.add(this.lines);
    this.shows = { forces: false, fibers: false };
    this.largest = 0; // [N], of the arrow that is as long as any
    this.longest = 0; // [N], shown
  }

  /** forces: nine numbers each (point, normal force, friction); fibers: six (both ends). isKept: of a point, by the cut. */
  set({ forces = [], fibers = [] }, isKept) {
    this.setForces(this.shows.forces ? forces : [], isKept);
    this.setFibers(this.shows.fibers ? fibers : [], isKept);
  }

  setForces(forces, isKept) {
    const scale = this.largest > 0 ? LONGEST / this.largest : 0;
    this.longest = 0;
    for (const [set, at] of [[this.normal, 3], [this.friction, 6]]) {
      const from = [], along = [];
      for (let i = 0; i + 8 < forces.length; i += 9) {
        const size = Math.hypot(forces[i + at], forces[i + at + 1], forces[i + at + 2]);
        if (!(size * scale > SHORTEST) || !isKept(forces[i], forces[i + 1], forces[i + 2])) continue;
        if (size > this.longest) this.longest = size;
        for (let k = 0; k < 3; ++k) {
          from.push(forces[i + k]);
          along.push(scale * forces[i + at + k]);
        }
      }
      set.set(from, along);
    }
  }

  setFibers(fibers, isKept) {
    const ends = [];
    for (let i = 0; i + 5 < fibers.length; i += 6) {
      if (!isKept(0.5 * (fibers[i] + fibers[i + 3]), 0.5 * (fibers[i + 1] + fibers[i + 4]), 0.5 * (fibers[i + 2] + fibers[i + 5]))) continue;
      for (let k = 0; k < 6; ++k) ends.push(fibers[i + k]);
    }
    this.lines.visible = ends.length > 0;
    if (ends.length === 0) return;
    const buffer = this.lines.geometry.getAttribute('instanceStart')?.data;
    if (buffer?.array.length === ends.length) {
      buffer.array.set(ends);
      buffer.needsUpdate = true;
      return;
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new LineSegmentsGeometry();
    this.lines.geometry.setPositions(ends);
  }
}
