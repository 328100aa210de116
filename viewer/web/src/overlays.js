// Cables, probes and contacts: what is drawn over the body, faintly where the body hides it.
import * as THREE from 'three';
import { Line2 } from 'three/addons/lines/Line2.js';
import { LineGeometry } from 'three/addons/lines/LineGeometry.js';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { colorOr } from './colors.js';
import { dotFragment, dotVertex } from './shaders.js';

const HIDDEN_OPACITY = 0.35;

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
    this.materials.forEach((material) => {
      const dots = new THREE.Points(this.geometry, material);
      dots.frustumCulled = false;
      dots.renderOrder = material.depthTest ? 302 : 301;
      parent.add(dots);
    });
  }

  set(points) {
    this.geometry.dispose();
    this.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(finitePoints(points)), 3));
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
      return materials.map((m, k) => {
        const object = new Line2(new LineGeometry(), m);
        object.frustumCulled = false;
        object.renderOrder = 290 + k;
        this.object.add(object);
        return object;
      });
    });
    this.contacts = new Dots(this.object, [232, 120, 30], 9);
    this.probes = new Dots(this.object, [20, 24, 30], 12);
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
      for (const object of this.lines[index]) {
        object.visible = finite.length >= 6;
        if (!object.visible) continue;
        object.geometry.dispose();
        object.geometry = new LineGeometry();
        object.geometry.setPositions(finite);
      }
    });
    this.contacts.set(frame.contacts);
    this.probes.set(frame.probes);
  }

  resize(pixelRatio) {
    this.contacts.resize(pixelRatio);
    this.probes.resize(pixelRatio);
  }

  placeLabels(camera, width, height) {
    const p = new THREE.Vector3();
    this.labels.forEach((label, index) => {
      p.fromArray(this.frame?.probes ?? [], 3 * index);
      const finite = [p.x, p.y, p.z].every(Number.isFinite);
      if (finite) p.project(camera);
      label.hidden = !finite || Math.abs(p.z) > 1;
      label.style.transform = `translate(${((p.x + 1) / 2) * width + 10}px, ${((1 - p.y) / 2) * height - 22}px)`;
    });
  }
}
