// The deforming surface, its section and its rest shape as GPU objects.
import * as THREE from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { COLOR_TABLES, categoryColor, partColor } from './colors.js';
import {
  bodyFragment, bodyVertex, capFragment, ghostFragment, ghostVertex, plainVertex, stencilFragment,
} from './shaders.js';
import { buildTopology, faceNormals, groupNormals, sliceCells, sliceSurface } from './topology.js';

const NO_CUT = new THREE.Vector4(0, 0, 0, -1);

function tableTexture(bytes) {
  const texture = new THREE.DataTexture(bytes, 256, 1);
  texture.magFilter = THREE.LinearFilter;
  texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

const attribute = (array, size) => new THREE.BufferAttribute(array, size).setUsage(THREE.DynamicDrawUsage);

export class Body {
  constructor(run) {
    this.run = run;
    this.object = new THREE.Group();
    this.tables = Object.fromEntries(Object.entries(COLOR_TABLES).map(([k, v]) => [k, tableTexture(v)]));
    const { triangles, trianglePart, edgeMask, rest } = run;
    this.parts = run.head.parts;
    this.topology = buildTopology(rest, triangles, trianglePart, this.parts.length);
    this.faces = new Float32Array(triangles.length);
    this.normals = new Float32Array(this.topology.groupCount * 3);

    // Corners are not shared between triangles: creases, edges and values of triangles need their own.
    const corners = triangles.length;
    this.position = attribute(new Float32Array(corners * 3), 3);
    this.normal = attribute(new Float32Array(corners * 3), 3);
    this.value = attribute(new Float32Array(corners), 1);
    this.valid = attribute(new Float32Array(corners).fill(1), 1);
    this.solid = attribute(new Float32Array(corners * 3), 3);
    const corner = new Float32Array(corners * 3);
    for (let c = 0; c < corners; ++c) {
      const f = Math.floor(c / 3);
      for (let k = 0; k < 3; ++k) {
        // Component k vanishes on the edge opposite to corner k; a hidden edge never vanishes.
        const hidden = !(edgeMask[f] & (1 << ((k + 1) % 3)));
        corner[3 * c + k] = hidden || c % 3 === k ? 1 : 0;
      }
    }
    this.uniforms = {
      table: { value: this.tables.sequential },
      range: { value: new THREE.Vector2(0, 1) },
      mode: { value: 1 },
      cut: { value: NO_CUT.clone() },
      edges: { value: 0 },
      upEye: { value: new THREE.Vector3(0, 1, 0) },
      pixel: { value: 1 },
    };
    this.geometry = new THREE.BufferGeometry();
    for (const name of ['position', 'normal', 'value', 'valid', 'solid']) this.geometry.setAttribute(name, this[name]);
    this.geometry.setAttribute('corner', new THREE.BufferAttribute(corner, 3));
    const material = new THREE.ShaderMaterial({
      uniforms: this.uniforms, vertexShader: bodyVertex, fragmentShader: bodyFragment, side: THREE.DoubleSide,
    });
    this.add(new THREE.Mesh(this.geometry, material), 1);
    this.setShape(run.rest);
    this.buildSection();
    this.buildGhost();
  }

  add(mesh, order, parent = this.object) {
    mesh.renderOrder = order;
    mesh.frustumCulled = false; // the bounds change with every frame; all of it is nearly always in view
    parent.add(mesh);
    return mesh;
  }

  partCorners(part) {
    const out = [];
    const { trianglePart } = this.run;
    for (let f = 0; f < trianglePart.length; ++f) {
      if (trianglePart[f] === part) out.push(3 * f, 3 * f + 1, 3 * f + 2);
    }
    return out;
  }

  /** For each closed part: count back faces minus front faces, then fill where the count is not zero. */
  buildSection() {
    this.section = new THREE.Group();
    this.section.visible = false;
    this.object.add(this.section);
    this.capMaterials = [];
    const stencilBase = {
      uniforms: { cut: this.uniforms.cut }, vertexShader: plainVertex, fragmentShader: stencilFragment,
      depthWrite: false, depthTest: false, colorWrite: false, stencilWrite: true,
    };
    const count = (side, operation) => new THREE.ShaderMaterial({
      ...stencilBase, side, stencilFunc: THREE.AlwaysStencilFunc, stencilFail: operation, stencilZFail: operation, stencilZPass: operation,
    });
    const back = count(THREE.BackSide, THREE.IncrementWrapStencilOp);
    const front = count(THREE.FrontSide, THREE.DecrementWrapStencilOp);
    this.capGeometry = new THREE.BufferGeometry();
    this.capGeometry.setAttribute('position', attribute(new Float32Array(18), 3));
    this.parts.forEach((part, index) => {
      if (!this.topology.closed[index]) return;
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', this.position);
      geometry.setIndex(this.partCorners(index));
      const order = 2 + index * 3;
      this.add(new THREE.Mesh(geometry, back), order, this.section);
      this.add(new THREE.Mesh(geometry, front), order + 0.5, this.section);
      const color = new THREE.Vector3(...partColor(part, index)).multiplyScalar(1 / 255);
      const material = new THREE.ShaderMaterial({
        uniforms: { color: { value: new THREE.Vector3() }, pixel: this.uniforms.pixel },
        vertexShader: plainVertex, fragmentShader: capFragment, side: THREE.DoubleSide,
        stencilWrite: true, stencilRef: 0, stencilFunc: THREE.NotEqualStencilFunc,
        stencilFail: THREE.ReplaceStencilOp, stencilZFail: THREE.ReplaceStencilOp, stencilZPass: THREE.ReplaceStencilOp,
        // Values inside, where the run has them, are drawn over this fill.
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2,
      });
      this.capMaterials.push({ material, color, obstacle: part.obstacle });
      this.add(new THREE.Mesh(this.capGeometry, material), order + 0.75, this.section);
    });
    this.outline = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({
      color: 0x15181c, linewidth: 1.5, transparent: true, opacity: 0.8, depthWrite: false,
      polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -8,
    }));
    this.add(this.outline, 280, this.section);
    if (this.run.cells.length > 0) {
      this.sliceGeometry = new THREE.BufferGeometry();
      const material = new THREE.ShaderMaterial({
        uniforms: { ...this.uniforms, cut: { value: NO_CUT }, edges: { value: 0 } },
        vertexShader: bodyVertex, fragmentShader: bodyFragment, side: THREE.DoubleSide,
      });
      this.slice = this.add(new THREE.Mesh(this.sliceGeometry, material), 1, this.section);
    }
  }

  buildGhost() {
    const geometry = new THREE.BufferGeometry();
    const { rest, triangles } = this.run;
    const normals = groupNormals(faceNormals(rest, triangles), this.topology);
    const position = new Float32Array(triangles.length * 3);
    const normal = new Float32Array(triangles.length * 3);
    this.expand(position, rest, triangles);
    this.expand(normal, normals, this.topology.group);
    geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
    geometry.setAttribute('normal', new THREE.BufferAttribute(normal, 3));
    const base = { uniforms: { color: { value: new THREE.Vector3() } }, vertexShader: ghostVertex, transparent: true };
    // Depth first, color second: only the nearest layer of the veil is seen.
    const depth = new THREE.ShaderMaterial({ ...base, fragmentShader: ghostFragment, colorWrite: false });
    const veil = new THREE.ShaderMaterial({ ...base, fragmentShader: ghostFragment, depthFunc: THREE.LessEqualDepth });
    this.ghostColor = base.uniforms.color.value;
    depth.uniforms.color = veil.uniforms.color = base.uniforms.color;
    this.ghost = new THREE.Group();
    this.ghost.visible = false;
    this.add(new THREE.Mesh(geometry, depth), 400, this.ghost);
    this.add(new THREE.Mesh(geometry, veil), 401, this.ghost);
    this.object.add(this.ghost);
  }

  expand(target, source, index) {
    for (let c = 0; c < index.length; ++c) {
      const from = 3 * index[c];
      target[3 * c] = source[from];
      target[3 * c + 1] = source[from + 1];
      target[3 * c + 2] = source[from + 2];
    }
  }

  setShape(positions) {
    this.positions = positions;
    faceNormals(positions, this.run.triangles, this.faces);
    groupNormals(this.faces, this.topology, this.normals);
    this.expand(this.position.array, positions, this.run.triangles);
    this.expand(this.normal.array, this.normals, this.topology.group);
    this.position.needsUpdate = this.normal.needsUpdate = true;
  }

  /** values: one a vertex or a triangle by field.place; null for the solid color. */
  setValues(field, values) {
    const { triangles, trianglePart } = this.run;
    const categorical = field.categories.length > 0;
    this.uniforms.mode.value = !values || categorical ? 1 : 0;
    this.uniforms.table.value = this.tables[field.diverging ? 'diverging' : 'sequential'];
    this.vertexValues = field.place === 'vertex' && !categorical ? values : null;
    const gray = [143, 143, 143];
    for (let c = 0; c < triangles.length; ++c) {
      const f = Math.floor(c / 3);
      const value = values ? values[field.place === 'triangle' ? f : triangles[c]] : 0;
      const finite = Number.isFinite(value);
      const part = this.parts[trianglePart[f]];
      if (this.uniforms.mode.value === 0) {
        this.value.array[c] = finite ? value : 0;
        this.valid.array[c] = part.obstacle ? -1 : finite ? 1 : 0;
      }
      if (this.uniforms.mode.value === 1 || part.obstacle) {
        let rgb = partColor(part, trianglePart[f]);
        if (categorical && !part.obstacle) rgb = finite ? categoryColor(Math.round(value)) : gray;
        this.solid.array.set(rgb.map((v) => v / 255), 3 * c);
      }
    }
    this.value.needsUpdate = this.valid.needsUpdate = this.solid.needsUpdate = true;
  }

  setRange(low, high) { this.uniforms.range.value.set(low, high); }

  /** plane: null, or [nx, ny, nz, d] that keeps n.x + d <= 0. */
  setCut(plane) {
    this.section.visible = plane !== null;
    if (!plane) { this.uniforms.cut.value.copy(NO_CUT); return; }
    this.uniforms.cut.value.set(...plane);
    const n = new THREE.Vector3(...plane.slice(0, 3));
    const origin = n.clone().multiplyScalar(-plane[3]);
    const u = new THREE.Vector3(n.y, n.z, n.x).cross(n).normalize();
    const w = new THREE.Vector3().crossVectors(n, u);
    const at = (s, t) => origin.clone().addScaledVector(u, 3 * s).addScaledVector(w, 3 * t).toArray();
    const [a, b, c, d] = [at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)];
    this.capGeometry.attributes.position.array.set([...a, ...b, ...c, ...a, ...c, ...d]);
    this.capGeometry.attributes.position.needsUpdate = true;
    for (const { material, color, obstacle } of this.capMaterials) {
      // Gray beside a field: a colored fill could be read as a value.
      const gray = this.uniforms.mode.value === 0 && !obstacle;
      material.uniforms.color.value.set(...(gray ? [0.8, 0.81, 0.83] : color.toArray().map((c) => 0.25 + 0.72 * c)));
    }
    const segments = sliceSurface(this.run.triangles, this.positions, plane);
    this.outline.visible = segments.length > 0;
    this.outline.geometry.dispose();
    this.outline.geometry = new LineSegmentsGeometry();
    if (this.outline.visible) this.outline.geometry.setPositions(segments);
    if (!this.slice) return;
    // Without a value at every node inside, the hatched fill tells the truth.
    this.slice.visible = this.vertexValues !== null;
    if (this.slice.visible) this.fillSlice(plane);
  }

  fillSlice(plane) {
    const { points, values } = sliceCells(this.run.cells, this.positions, this.vertexValues, plane);
    const count = values.length;
    const normal = new Float32Array(count * 3);
    const valid = new Float32Array(count);
    for (let i = 0; i < count; ++i) {
      normal.set(plane.slice(0, 3), 3 * i);
      valid[i] = Number.isFinite(values[i]) ? 1 : 0;
      if (!valid[i]) values[i] = 0;
    }
    const set = (name, array, size) => this.sliceGeometry.setAttribute(name, new THREE.BufferAttribute(array, size));
    this.sliceGeometry.dispose();
    set('position', points, 3);
    set('normal', normal, 3);
    set('value', values, 1);
    set('valid', valid, 1);
    set('solid', new Float32Array(count * 3), 3);
    set('corner', new Float32Array(count * 3), 3);
    this.sliceGeometry.setDrawRange(0, count);
  }
}
