// Cables, probes and contacts: what is drawn over the body, faintly where the body hides it.
import * as THREE from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { colorOr } from './colors.js';
import { Arrows } from './arrows.js';
import { placeLabels } from './labels.js';
import { dotFragment, dotVertex } from './shaders.js';

const HIDDEN_OPACITY = 0.35;

// Buffers are written to while they are long enough: new ones every frame would cost far more than drawing.
function fillPoints(geometry, values) {
  const old = geometry.getAttribute('position');
  if (old && old.array.length >= values.length) {
    old.array.set(values);
    old.needsUpdate = true;
  } else {
    const array = new Float32Array(old ? 2 * values.length : values.length);
    array.set(values);
    geometry.dispose();
    geometry.setAttribute('position', new THREE.BufferAttribute(array, 3).setUsage(THREE.DynamicDrawUsage));
  }
  geometry.setDrawRange(0, values.length / 3);
}

/** A line through these points as pairs of ends. */
function segments(points) {
  const out = new Float32Array(2 * (points.length - 3));
  for (let i = 0; i + 5 < points.length; i += 3) for (let k = 0; k < 6; ++k) out[2 * i + k] = points[i + k];
  return out;
}

function fillLine(geometry, values) {
  const buffer = geometry.getAttribute('instanceStart')?.data;
  if (buffer?.array.length === values.length) {
    buffer.array.set(values);
    buffer.needsUpdate = true;
    return;
  }
  geometry.dispose();
  geometry.setPositions(values);
}

const finitePoints = (points) => {
  const out = [];
  for (let i = 0; i + 2 < points.length; i += 3) {
    const p = points.subarray(i, i + 3);
    if (p.every(Number.isFinite)) out.push(...p);
  }
  return out;
};

class Dots {
  constructor(parent, color, size) {
    this.size = size;
    this.geometry = new THREE.BufferGeometry();
    this.materials = [true, false].map((depthTest) => new THREE.ShaderMaterial({
      uniforms: {
        color: { value: new THREE.Vector3(...color.map((v) => v / 255)) },
        ring: { value: new THREE.Vector3(1, 1, 1) },
        size: { value: size },
        opacity: { value: depthTest ? 1 : HIDDEN_OPACITY },
      },
      vertexShader: dotVertex, fragmentShader: dotFragment, transparent: true, depthTest, depthWrite: false,
    }));
    this.objects = this.materials.map((material) => {
      const dots = new THREE.Points(this.geometry, material);
      dots.frustumCulled = false;
      dots.renderOrder = material.depthTest ? 302 : 301;
      dots.visible = false;
      parent.add(dots);
      return dots;
    });
  }

  set(points) {
    const finite = finitePoints(points);
    for (const object of this.objects) object.visible = finite.length > 0;
    if (finite.length === 0) return;
    fillPoints(this.geometry, finite);
  }

  resize(pixelRatio) {
    for (const material of this.materials) material.uniforms.size.value = this.size * pixelRatio;
  }
}

export class Overlays {
  constructor(run, labelLayer) {
    this.run = run;
    this.object = new THREE.Group();
    this.lines = run.head.lines.map((line, index) => {
      const color = new THREE.Color(`rgb(${colorOr(line.color, index + 3).join(',')})`);
      const material = { color, linewidth: 3.2, worldUnits: false };
      // A cable in the plane of a cut lies on the section, not in it.
      const nearer = { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -16 };
      // Three passes: a faint one through the body, a dark casing, and the line itself.
      const materials = [
        // The stencil lets each pixel through once, or the joints of its segments would show as dots.
        new LineMaterial({
          ...material, transparent: true, opacity: HIDDEN_OPACITY, depthTest: false, depthWrite: false,
          stencilWrite: true, stencilRef: 255, stencilFunc: THREE.NotEqualStencilFunc, stencilZPass: THREE.ReplaceStencilOp,
        }),
        new LineMaterial({ ...material, color: 0x1a1d22, linewidth: 5.2, depthWrite: false, ...nearer }),
        new LineMaterial({ ...material, ...nearer }),
      ];
      const geometry = new LineSegmentsGeometry();
      const objects = materials.map((m, k) => {
        const object = new LineSegments2(geometry, m);
        object.frustumCulled = false;
        object.renderOrder = 290 + k;
        this.object.add(object);
        return object;
      });
      return { geometry, objects };
    });
    this.arrows = new Arrows();
    this.object.add(this.arrows.object);
    this.contacts = new Dots(this.object, [232, 120, 30], 9);
    this.probes = new Dots(this.object, [20, 24, 30], 12);
    this.placed = []; // boxes of labels that are to be seen
    this.labels = run.head.probes.map((name) => {
      const label = document.createElement('span');
      label.className = 'probe';
      label.textContent = name;
      labelLayer.append(label);
      return label;
    });
  }

  setFrame(frame) {
    this.frame = frame;
    frame.lines.forEach((points, index) => {
      const finite = finitePoints(points);
      const { geometry, objects } = this.lines[index];
      for (const object of objects) object.visible = finite.length >= 6;
      if (finite.length >= 6) fillLine(geometry, segments(finite));
    });
    this.showPoints();
  }

  /** Points of what a cut takes away go with it. plane: as Body.setCut() takes it. */
  setCut(plane) {
    this.plane = plane;
    if (this.frame) this.showPoints();
  }

  /** Points a little beyond the plane stay: those in a plane of symmetry, for one. */
  isKept(x, y, z) {
    const { plane } = this;
    return !plane || plane[0] * x + plane[1] * y + plane[2] * z + plane[3] <= 0.02;
  }

  showPoints() {
    const kept = (points) => points.map((v, i) => {
      const at = i - (i % 3);
      return this.isKept(points[at], points[at + 1], points[at + 2]) ? v : NaN;
    });
    this.arrows.set(this.frame, (x, y, z) => this.isKept(x, y, z));
    this.contacts.set(kept(this.frame.contacts));
    this.probes.set(kept(this.frame.probes));
  }

  resize(pixelRatio) {
    this.contacts.resize(pixelRatio);
    this.probes.resize(pixelRatio);
  }

  /** shows: { forces, fibers }. */
  setArrows(shows) {
    this.arrows.shows = shows;
    if (this.frame) this.showPoints();
  }

  /** Beside their points, over neither each other nor what else stands on the picture. */
  placeLabels(camera, host, moving) {
    if (!moving) this.boxes = null;
    if (this.labels.length === 0) return;
    const [width, height] = [host.clientWidth, host.clientHeight];
    const p = new THREE.Vector3();
    const points = this.labels.map((label, index) => {
      p.fromArray(this.frame?.probes ?? [], 3 * index);
      if (![p.x, p.y, p.z].every(Number.isFinite) || !this.isKept(p.x, p.y, p.z)) return null;
      p.project(camera);
      if (Math.abs(p.z) > 1) return null;
      label.size ??= this.sizeOf(label);
      if (!label.size) return null;
      return { x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height, ...label.size };
    });
    this.placed = [];
    placeLabels(points, { width, height }, this.taken(host)).forEach((place, index) => {
      const label = this.labels[index];
      label.hidden = place === null;
      if (place === null) return;
      this.placed.push({ ...place, ...label.size });
      const transform = `translate(${place.x}px, ${place.y}px)`;
      if (label.style.transform !== transform) label.style.transform = transform;
    });
  }

  sizeOf(label) {
    const { hidden } = label;
    label.hidden = false;
    const size = { width: label.offsetWidth, height: label.offsetHeight };
    label.hidden = hidden;
    return size.width > 0 ? size : null;
  }

  /** Boxes of the stage where no label may stand; looked up at rest, since asking the browser takes time. */
  taken(host) {
    if (this.boxes) return this.boxes;
    const from = host.getBoundingClientRect();
    this.boxes = [...host.querySelectorAll('.stamp, .legend, .tools, .arrow-key, .triad, .said')].map((node) => {
      const box = node.getBoundingClientRect();
      return { x: box.left - from.left, y: box.top - from.top, width: box.width, height: box.height };
    }).filter((box) => box.width > 0);
    return this.boxes;
  }
}
