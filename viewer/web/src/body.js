// The deforming surface, its section and its rest shape as GPU objects.
import * as THREE from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { categoryColor, colorTable, partColor } from './colors.js';
import {
  bodyFragment, bodyVertex, capFragment, ghostFragment, ghostVertex, plainVertex, stencilFragment,
} from './shaders.js';
import { Occlusion } from './occlusion.js';
import { buildTopology, faceNormals, groupNormals, hollows, sliceCells, sliceSurface } from './topology.js';

const GRAY = [143, 143, 143];

function tableTexture(name) {
  const texture = new THREE.DataTexture(colorTable(name), 256, 1);
  texture.magFilter = THREE.LinearFilter;
  texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

const attribute = (array, size) => new THREE.BufferAttribute(array, size).setUsage(THREE.DynamicDrawUsage);

/** The vertices that are drawn: copies of the vertices of the run, one for each `source`. */
class Points {
  constructor(source, normalSource, part) {
    Object.assign(this, { source, normalSource, part });
    const count = source.length;
    this.attributes = {
      position: attribute(new Float32Array(count * 3), 3),
      normal: attribute(new Float32Array(count * 3), 3),
      value: attribute(new Float32Array(count), 1),
      valid: attribute(new Float32Array(count).fill(1), 1),
      solid: attribute(new Float32Array(count * 3), 3),
      shade: attribute(new Float32Array(count), 1),
    };
  }

  setShape(positions, normals) {
    expand(this.attributes.position, positions, this.source);
    expand(this.attributes.normal, normals, this.normalSource);
  }

  /** value: of the i-th point, NaN where there is none. Says whether all that count are finite. */
  setValues(value, parts) {
    const { value: values, valid } = this.attributes;
    let finite = true;
    for (let i = 0; i < this.source.length; ++i) {
      const v = value(i);
      const good = Number.isFinite(v);
      values.array[i] = good ? v : 0;
      valid.array[i] = good ? 1 : 0;
      finite &&= good || parts[this.part[i]].obstacle === true;
    }
    values.needsUpdate = true;
    if (!finite) valid.needsUpdate = true;
    return finite;
  }

  setColors(color) {
    const { solid } = this.attributes;
    for (let i = 0; i < this.source.length; ++i) {
      const rgb = color(i);
      for (let k = 0; k < 3; ++k) solid.array[3 * i + k] = rgb[k] / 255;
    }
    solid.needsUpdate = true;
  }
}

function expand(target, source, index) {
  const out = target.array;
  for (let i = 0, at = 0; i < index.length; ++i) {
    const from = 3 * index[i];
    out[at++] = source[from];
    out[at++] = source[from + 1];
    out[at++] = source[from + 2];
  }
  target.needsUpdate = true;
}

export class Body {
  constructor(run) {
    this.run = run;
    this.object = new THREE.Group();
    this.tables = {};
    const { triangles, trianglePart, rest } = run;
    this.parts = run.head.parts;
    this.colors = this.parts.map(partColor);
    this.looks = this.parts.map(() => 'shown');
    this.topology = buildTopology(rest, triangles, trianglePart, this.parts.length);
    this.hollow = hollows(rest, triangles, trianglePart, this.topology.closed);
    this.faces = new Float32Array(triangles.length);
    this.normals = new Float32Array(this.topology.groupCount * 3);
    this.uniforms = {
      table: { value: null },
      range: { value: new THREE.Vector2(0, 1) },
      cut: { value: new THREE.Vector4(0, 0, 0, -1) },
      edges: { value: 0.75 },
      upEye: { value: new THREE.Vector3(0, 1, 0) },
      pixel: { value: 1 },
    };
    this.shows = { field: false, categories: false, invalid: false, cut: false, edges: false, inside: false };
    this.buildShared();
    this.occlusion = new Occlusion(run, (p) => this.parts[p].obstacle === true, (p) => this.looks[p] === 'shown');
    this.section = new THREE.Group();
    this.section.visible = false;
    this.ghost = new THREE.Group();
    this.ghost.visible = false;
    this.ghostColor = new THREE.Vector3();
    this.object.add(this.section, this.ghost);
    this.setShape(run.rest);
  }

  add(mesh, order, parent = this.object) {
    mesh.renderOrder = order;
    mesh.frustumCulled = false; // the bounds change with every frame; all of it is nearly always in view
    parent.add(mesh);
    return mesh;
  }

  /** Corners of the triangles of the parts that `wanted` takes; those of hollows come last. */
  cornersWhere(wanted) {
    const { trianglePart } = this.run;
    const seen = [], hidden = [];
    for (let f = 0; f < trianglePart.length; ++f) {
      if (wanted(trianglePart[f])) (this.hollow[f] ? hidden : seen).push(3 * f, 3 * f + 1, 3 * f + 2);
    }
    return { corners: [...seen, ...hidden], seen: seen.length };
  }

  /** A mesh for each kind of part, drawn from `points`; `vertex`: of a corner of a triangle. */
  buildMeshes(points, vertex, extra = {}) {
    const view = { points, vertex, extra, meshes: [] };
    this.fillMeshes(view);
    return view;
  }

  fillMeshes(view) {
    const { closed } = this.topology;
    for (const look of ['shown', 'faded']) {
      for (const obstacle of [false, true]) {
        for (const isClosed of [true, false]) {
          const { corners, seen } = this.cornersWhere((p) => this.looks[p] === look
            && (this.parts[p].obstacle === true) === obstacle && closed[p] === isClosed);
          if (corners.length === 0) continue;
          const geometry = new THREE.BufferGeometry();
          for (const [name, a] of Object.entries({ ...view.points.attributes, ...view.extra })) geometry.setAttribute(name, a);
          geometry.setIndex(corners.map(view.vertex));
          for (const pass of look === 'faded' ? ['depth', 'veil'] : ['solid']) {
            const mesh = this.add(new THREE.Mesh(geometry, this.bodyMaterial(pass)), { solid: 1, depth: 350, veil: 351 }[pass]);
            view.meshes.push({ mesh, obstacle, closed: isClosed, seen, faded: look === 'faded' });
          }
        }
      }
    }
  }

  /** What is faded comes after everything else, its depth first: only its nearest layer is seen. */
  bodyMaterial(pass) {
    const base = { uniforms: this.uniforms, vertexShader: bodyVertex, fragmentShader: bodyFragment, side: THREE.DoubleSide };
    if (pass === 'depth') return new THREE.ShaderMaterial({ ...base, transparent: true, colorWrite: false });
    if (pass === 'veil') return new THREE.ShaderMaterial({ ...base, transparent: true, depthFunc: THREE.LessEqualDepth });
    return new THREE.ShaderMaterial(base);
  }

  /** look: 'shown', 'faded' or 'hidden'. */
  setLook(part, look) {
    if (this.looks[part] === look) return;
    this.looks[part] = look;
    for (const view of this.views) {
      for (const { mesh } of view.meshes) {
        this.object.remove(mesh);
        mesh.geometry.dispose();
        mesh.material.dispose();
      }
      view.meshes = [];
      this.fillMeshes(view);
    }
    this.occlusion = new Occlusion(this.run, (p) => this.parts[p].obstacle === true, (p) => this.looks[p] === 'shown');
    this.shadedShape = null;
    this.refresh();
  }

  /** Where little of the sky is seen, of the shape as it is now. */
  shade() {
    if (this.shadedShape === this.positions) return;
    this.shadedShape = this.positions;
    this.occlusion.setShape(this.positions);
    this.shadeView();
  }

  shadeView() {
    if (!this.shadedShape || !this.view) return;
    const { source, normalSource, attributes: { shade } } = this.view.points;
    this.occlusion.shade(this.positions, source, this.normals, normalSource, shade.array);
    shade.needsUpdate = true;
    this.shadedView = this.view;
  }

  /** Corners of one smooth group are one vertex: a sixth of the work of having each on its own. */
  buildShared() {
    const { triangles, trianglePart } = this.run;
    const { group, groupCount } = this.topology;
    const vertex = new Uint32Array(groupCount), part = new Uint16Array(groupCount);
    group.forEach((g, c) => {
      vertex[g] = triangles[c];
      part[g] = trianglePart[Math.floor(c / 3)];
    });
    const points = new Points(vertex, Uint32Array.from({ length: groupCount }, (_, i) => i), part);
    points.setColors((i) => this.colors[part[i]]);
    this.shared = this.buildMeshes(points, (c) => group[c]);
    this.views = [this.shared];
  }

  /** Edges of the mesh and values of triangles need corners of their own. */
  get apart() {
    if (this.apartMeshes) return this.apartMeshes;
    const { triangles, trianglePart, edgeMask } = this.run;
    const corners = triangles.length;
    const corner = new Float32Array(corners * 3);
    const part = new Uint16Array(corners);
    for (let c = 0; c < corners; ++c) {
      const f = Math.floor(c / 3);
      part[c] = trianglePart[f];
      for (let k = 0; k < 3; ++k) {
        // Component k vanishes on the edge opposite to corner k; a hidden edge never vanishes.
        const hidden = !(edgeMask[f] & (1 << ((k + 1) % 3)));
        corner[3 * c + k] = hidden || c % 3 === k ? 1 : 0;
      }
    }
    const points = new Points(triangles, this.topology.group, part);
    points.setColors((i) => this.colors[part[i]]);
    this.apartMeshes = this.buildMeshes(points, (c) => c, { corner: new THREE.BufferAttribute(corner, 3) });
    this.views.push(this.apartMeshes);
    return this.apartMeshes;
  }

  /** For each closed part: count back faces minus front faces, then fill where the count is not zero. */
  buildSection() {
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
    const { group, closed } = this.topology;
    this.parts.forEach((part, index) => {
      if (!closed[index]) return;
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', this.shared.points.attributes.position);
      geometry.setIndex(this.cornersWhere((p) => p === index).corners.map((c) => group[c]));
      const order = 2 + index * 3;
      const counted = [this.add(new THREE.Mesh(geometry, back), order, this.section), this.add(new THREE.Mesh(geometry, front), order + 0.5, this.section)];
      const color = new THREE.Vector3(...this.colors[index]).multiplyScalar(1 / 255);
      const material = new THREE.ShaderMaterial({
        uniforms: { color: { value: new THREE.Vector3() }, pixel: this.uniforms.pixel },
        vertexShader: plainVertex, fragmentShader: capFragment, side: THREE.DoubleSide,
        stencilWrite: true, stencilRef: 0, stencilFunc: THREE.NotEqualStencilFunc,
        stencilFail: THREE.ReplaceStencilOp, stencilZFail: THREE.ReplaceStencilOp, stencilZPass: THREE.ReplaceStencilOp,
        // Values inside, where the run has them, are drawn over this fill.
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2,
      });
      counted.push(this.add(new THREE.Mesh(this.capGeometry, material), order + 0.75, this.section));
      this.capMaterials.push({ material, color, obstacle: part.obstacle, part: index, meshes: counted });
    });
    this.outline = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({
      color: 0x15181c, linewidth: 1.5, transparent: true, opacity: 0.8, depthWrite: false,
      polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -8,
    }));
    this.add(this.outline, 280, this.section);
    if (this.run.cells.length > 0) {
      this.sliceGeometry = new THREE.BufferGeometry();
      this.sliceMaterial = new THREE.ShaderMaterial({
        uniforms: this.uniforms, vertexShader: bodyVertex, fragmentShader: bodyFragment, side: THREE.DoubleSide,
      });
      this.slice = this.add(new THREE.Mesh(this.sliceGeometry, this.sliceMaterial), 1, this.section);
    }
  }

  buildGhost() {
    const { rest, triangles } = this.run;
    const points = new Points(this.shared.points.source, this.shared.points.normalSource, this.shared.points.part);
    points.setShape(rest, groupNormals(faceNormals(rest, triangles), this.topology));
    const geometry = new THREE.BufferGeometry();
    for (const name of ['position', 'normal']) geometry.setAttribute(name, points.attributes[name]);
    const { corners, seen } = this.cornersWhere(() => true);
    geometry.setIndex(corners.slice(0, seen).map((c) => this.topology.group[c]));
    const base = { uniforms: { color: { value: this.ghostColor } }, vertexShader: ghostVertex, transparent: true };
    // Depth first, color second: only the nearest layer of the veil is seen.
    const depth = new THREE.ShaderMaterial({ ...base, fragmentShader: ghostFragment, colorWrite: false });
    const veil = new THREE.ShaderMaterial({ ...base, fragmentShader: ghostFragment, depthFunc: THREE.LessEqualDepth });
    depth.uniforms.color = veil.uniforms.color = base.uniforms.color;
    this.add(new THREE.Mesh(geometry, depth), 400, this.ghost);
    this.add(new THREE.Mesh(geometry, veil), 401, this.ghost);
  }

  setGhost(on) {
    if (on && this.ghost.children.length === 0) this.buildGhost();
    this.ghost.visible = on;
  }

  setEdges(on) {
    if (this.shows.edges === on) return;
    this.shows.edges = on;
    this.refresh();
  }

  /** Whether the camera is near enough to be inside the body, where back faces are seen. */
  setInside(inside) {
    if (this.shows.inside === inside) return;
    this.shows.inside = inside;
    this.refreshMaterials();
  }

  setShape(positions) {
    this.positions = positions;
    faceNormals(positions, this.run.triangles, this.faces);
    groupNormals(this.faces, this.topology, this.normals);
  }

  /** Shows the shape set before. values: one a vertex or a triangle by field.place; null for the solid color. */
  setValues(field, values) {
    this.field = field;
    this.values = values;
    const categorical = field.categories.length > 0;
    this.shows.field = values !== null && !categorical;
    this.shows.categories = values !== null && categorical;
    this.vertexValues = field.place === 'vertex' && this.shows.field ? values : null;
    if (this.shows.field) {
      const name = field.diverging ? 'diverging' : 'sequential';
      this.tables[name] ??= tableTexture(name);
      this.uniforms.table.value = this.tables[name];
    }
    this.refresh();
  }

  /** Puts shape and colors into the points that are drawn, whichever these are now. */
  refresh() {
    const { field, values, shows, run, colors } = this;
    const apart = shows.edges || shows.categories || (shows.field && field.place === 'triangle');
    const view = apart ? this.apart : this.shared;
    for (const v of this.views) for (const { mesh } of v.meshes) mesh.visible = v === view;
    this.view = view;
    if (this.shadedView !== view) this.shadeView();
    const { points } = view;
    points.setShape(this.positions, this.normals);
    // The section is cut out of the shared points.
    if (apart && shows.cut) this.shared.points.setShape(this.positions, this.normals);
    shows.invalid = false;
    if (shows.field) {
      const { source } = points;
      const read = field.place === 'triangle' ? (i) => values[Math.floor(i / 3)] : (i) => values[source[i]];
      shows.invalid = !points.setValues(read, this.parts);
    }
    if (apart) {
      const { trianglePart, triangles } = run;
      points.setColors((i) => {
        const f = Math.floor(i / 3);
        if (!shows.categories || this.parts[trianglePart[f]].obstacle) return colors[trianglePart[f]];
        const value = values[field.place === 'triangle' ? f : triangles[i]];
        return Number.isFinite(value) ? categoryColor(Math.round(value)) : GRAY;
      });
    }
    this.refreshMaterials();
  }

  refreshMaterials() {
    const { shows } = this;
    for (const { mesh, obstacle, closed, seen, faded } of this.view.meshes) {
      const field = shows.field && !obstacle;
      // Backs and hollows of a closed surface are seen only through a cut or from within.
      const whole = closed && !shows.cut && !shows.inside;
      const side = whole ? THREE.FrontSide : THREE.DoubleSide;
      mesh.geometry.setDrawRange(0, whole ? seen : Infinity);
      define(mesh.material, { FIELD: field, INVALID: field && shows.invalid, CUT: shows.cut, EDGES: shows.edges, FADED: faded }, side);
    }
    if (this.slice) define(this.sliceMaterial, { FIELD: true, INVALID: true }, THREE.DoubleSide);
  }

  setRange(low, high) { this.uniforms.range.value.set(low, high); }

  /** plane: null, or [nx, ny, nz, d] that keeps n.x + d <= 0. */
  setCut(plane) {
    const { shows } = this;
    this.section.visible = plane !== null;
    const changed = shows.cut !== (plane !== null);
    shows.cut = plane !== null;
    // Made before the materials are told what they show, or the first slice would not know.
    if (plane && !this.capMaterials) this.buildSection();
    if (changed) this.refresh();
    if (!plane) return;
    this.uniforms.cut.value.set(...plane);
    const n = new THREE.Vector3(...plane.slice(0, 3));
    const origin = n.clone().multiplyScalar(-plane[3]);
    const u = new THREE.Vector3(n.y, n.z, n.x).cross(n).normalize();
    const w = new THREE.Vector3().crossVectors(n, u);
    const at = (s, t) => origin.clone().addScaledVector(u, 3 * s).addScaledVector(w, 3 * t).toArray();
    const [a, b, c, d] = [at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)];
    this.capGeometry.attributes.position.array.set([...a, ...b, ...c, ...a, ...c, ...d]);
    this.capGeometry.attributes.position.needsUpdate = true;
    for (const { material, color, obstacle, part, meshes } of this.capMaterials) {
      for (const mesh of meshes) mesh.visible = this.looks[part] === 'shown';
      // Gray beside a field: a colored fill could be read as a value.
      const gray = shows.field && !obstacle;
      material.uniforms.color.value.set(...(gray ? [0.8, 0.81, 0.83] : color.toArray().map((c) => 0.25 + 0.72 * c)));
    }
    const segments = sliceSurface(this.run.triangles, this.positions, plane, (f) => this.looks[this.run.trianglePart[f]] === 'shown');
    this.outline.visible = segments.length > 0;
    this.outline.geometry.dispose();
    this.outline.geometry = new LineSegmentsGeometry();
    if (this.outline.visible) this.outline.geometry.setPositions(segments);
    if (!this.slice) return;
    // Without a value at every node inside, the hatched fill tells the truth.
    this.slice.visible = this.vertexValues !== null;
    if (this.slice.visible) this.fillSlice(plane);
  }

  /** Cells of the parts that are shown; those inside belong to the part of their neighbors. */
  cellsShown() {
    const { cells, triangles, trianglePart } = this.run;
    if (this.looks.every((look) => look === 'shown')) return cells;
    if (!this.cellPart) {
      const of = new Int32Array(this.run.rest.length / 3).fill(-1);
      triangles.forEach((v, c) => { of[v] = trianglePart[Math.floor(c / 3)]; });
      for (let spread = true; spread;) {
        spread = false;
        for (let c = 0; c < cells.length; c += 4) {
          const known = Math.max(of[cells[c]], of[cells[c + 1]], of[cells[c + 2]], of[cells[c + 3]]);
          for (let k = c; known >= 0 && k < c + 4; ++k) if (of[cells[k]] < 0) { of[cells[k]] = known; spread = true; }
        }
      }
      this.cellPart = Int32Array.from({ length: cells.length / 4 }, (_, c) => of[cells[4 * c]]);
    }
    return cells.filter((_, k) => this.looks[this.cellPart[Math.floor(k / 4)]] === 'shown');
  }

  fillSlice(plane) {
    const { points, values } = sliceCells(this.cellsShown(), this.positions, this.vertexValues, plane);
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
    this.sliceGeometry.setDrawRange(0, count);
  }
}

/** The variant of the shader that does what is asked and no more. */
function define(material, wanted, side) {
  const names = Object.keys(wanted).filter((name) => wanted[name]);
  const variant = `${names.join()} ${side}`;
  if (material.userData.variant === variant) return;
  material.userData.variant = variant;
  material.defines = Object.fromEntries(names.map((name) => [name, '']));
  material.side = side;
  material.needsUpdate = true;
}
