// A scene that runs, as the stage takes it: what RunData is for a run that is over. Lengths are scaled so that the scene
// with room for its motion lies in a sphere of radius one.

import { RELATIVE, apartFromCommon, verticesOfBodies } from '../rigid.js';

const ROOM = 1.5; // for motion, over the size at rest

export class LiveData {
  constructor(message) {
    const { head } = message;
    const meters = message.floats(3 * head.vertices);
    this.triangles = message.integers(3 * head.triangles);
    this.trianglePart = Uint16Array.from(message.integers(head.triangles));
    this.edgeMask = Uint16Array.from(message.integers(head.triangles));
    this.maps = Array.from({ length: head.maps }, () => message.floats(head.triangles));
    this.cells = new Uint32Array(0);
    this.name = head.name;
    this.countBodies(head);
    const box = this.boxOf(meters);
    this.center = box.low.map((v, i) => 0.5 * (v + box.high[i]));
    this.extent = Math.hypot(...box.low.map((v, i) => box.high[i] - v)) || 1;
    this.scale = 2 / (ROOM * this.extent);
    const pad = 0.25 * this.extent;
    this.head = {
      ...head, frames: [], series: [], summary: [], run: [], footer: `isochor ${head.version} · scene ${head.name}`,
      x: head.dynamic ? { label: 'Time', symbol: 't', unit: 's' } : { label: 'Load factor', symbol: 'λ', unit: '' },
      box: { low: box.low.map((v) => v - pad), high: box.high.map((v) => v + pad) },
    };
    this.rest = this.toWorld(meters);
    this.frameCount = 1;
    this.usual = new Map();
    this.mostForce = 0; // so far [N]
  }

  /** Bodies come before obstacles. */
  countBodies(head) {
    this.bodyVertices = 0;
    this.triangles.forEach((v, c) => {
      if (!head.parts[this.trianglePart[Math.floor(c / 3)]].obstacle) this.bodyVertices = Math.max(this.bodyVertices, v + 1);
    });
  }

  boxOf(meters) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < 3 * this.bodyVertices; ++i) {
      low[i % 3] = Math.min(low[i % 3], meters[i]);
      high[i % 3] = Math.max(high[i % 3], meters[i]);
    }
    return this.bodyVertices > 0 ? { low, high } : { low: [0, 0, 0], high: [1, 1, 1] };
  }

  toWorld(meters) {
    const out = new Float32Array(meters.length);
    for (let i = 0; i < out.length; ++i) out[i] = (meters[i] - this.center[i % 3]) * this.scale;
    return out;
  }

  toMeters(point) { return point.map((v, i) => v / this.scale + this.center[i]); }

  /** A picture as the server sends it. */
  read(message) {
    const { head } = message;
    // From rest [m], so that motions far smaller than the body keep their digits.
    const moved = message.floats(3 * head.vertices);
    const positions = this.rest.map((v, i) => v + moved[i] * this.scale);
    const values = head.field === null ? null : message.floats(head.values);
    const lines = head.lines.map((count) => this.toWorld(message.floats(3 * count)));
    const probes = this.toWorld(message.floats(3 * head.probes));
    const contacts = this.toWorld(message.floats(3 * head.contacts));
    const forces = message.floats(9 * head.forces);
    for (let i = 0; i < forces.length; i += 9) {
      for (const at of [i + 3, i + 6]) this.mostForce = Math.max(this.mostForce, Math.hypot(forces[at], forces[at + 1], forces[at + 2]) || 0);
      for (let k = 0; k < 3; ++k) forces[i + k] = (forces[i + k] - this.center[k]) * this.scale;
    }
    const fibers = this.toWorld(message.floats(3 * head.fibers));
    return { info: head, moved, positions, field: head.field, given: values, lines, probes, contacts, forces, fibers, kept: new Map() };
  }

  positions(frame) { return frame.positions; }

  fieldList() {
    let map = 0;
    const list = this.head.fields.map((f) => {
      if (f.name === 'displacement') return { ...f, kind: 'displacement' };
      return f.place === 'triangle' ? { ...f, kind: 'map', index: map++ } : { ...f, kind: 'given' };
    });
    list.push(RELATIVE);
    list.push({ name: 'solid', label: 'None (solid color)', unit: '', kind: 'solid', place: 'vertex', categories: [] });
    return list;
  }

  /** Null where the picture does not have the field (yet): it was asked for with the next one. */
  values(frame, field) {
    if (field.kind === 'solid') return null;
    if (field.kind === 'map') return this.maps[field.index];
    if (field.kind === 'given') return frame.field === field.name ? frame.given : null;
    let out = frame.kept.get(field.name);
    if (out) return out;
    const { moved, positions } = frame;
    if (field.kind === 'relative') {
      this.bodies ??= verticesOfBodies(this);
      out = apartFromCommon(this.rest, positions, this.bodies).map((v) => v / this.scale);
      frame.kept.set(field.name, out);
      return out;
    }
    out = new Float32Array(this.head.vertices);
    for (let i = 0; i < this.bodyVertices; ++i) out[i] = Math.hypot(moved[3 * i], moved[3 * i + 1], moved[3 * i + 2]);
    frame.kept.set(field.name, out);
    return out;
  }

  /** Ranges of the values of the bodies in one picture, by the share of them that is in it. */
  stats(frame, field) {
    const key = `stats ${field.name}`;
    if (frame.kept.has(key)) return frame.kept.get(key);
    const values = this.values(frame, field);
    let out = null;
    if (values && field.place === 'vertex') {
      const finite = values.subarray(0, this.bodyVertices).filter((v) => Number.isFinite(v) && v !== 0).sort();
      const invalid = values.subarray(0, this.bodyVertices).filter((v) => !Number.isFinite(v)).length;
      const zeros = finite.length + invalid < this.bodyVertices;
      if (finite.length > 0 || zeros) {
        const at = (i) => (finite.length > 0 ? finite[i] : 0);
        const last = finite.length - 1;
        const zero = (range) => (zeros ? [Math.min(0, range[0]), Math.max(0, range[1])] : range);
        const middle = (share) => {
          const cut = Math.floor(finite.length * (0.5 - 0.5 * share) + 1e-9);
          return zero([at(cut), at(last - cut)]);
        };
        out = { 1: zero([at(0), at(last)]), 0.98: middle(0.98), 0.9: middle(0.9), invalid };
      }
    }
    frame.kept.set(key, out);
    return out;
  }

  /** The pictures so far, which ranges of colors go by. */
  remember(frame, field) {
    const now = this.stats(frame, field);
    if (!now) return;
    const join = (a, b) => (a ? [Math.min(a[0], b[0]), Math.max(a[1], b[1])] : b);
    const known = this.usual.get(field.name) ?? {};
    this.usual.set(field.name, Object.fromEntries([1, 0.98, 0.9].map((share) => [share, join(known[share], now[share])])));
  }

  forgetRanges() {
    this.usual.clear();
    this.mostForce = 0;
  }

  get hasForces() { return this.head.forces; }
  get hasFibers() { return this.head.fibers; }
  largestForce() { return this.mostForce; }

  frameRange(field, frame, share = 1) { return this.pick(this.stats(frame, field), share); }
  runRange(field, share = 1) { return this.pick(this.usual.get(field.name), share); }

  pick(ranges, share) {
    if (!ranges) return null;
    return ranges[share][1] > ranges[share][0] ? ranges[share] : ranges[1];
  }

  /** Of the shadow: a table's, where there is one below the bodies. */
  groundHeight() {
    const axis = this.head.up === 'y' ? 1 : 2;
    let lowest = Infinity, table = null;
    for (let i = axis; i < 3 * this.bodyVertices; i += 3) lowest = Math.min(lowest, this.rest[i]);
    this.head.parts.forEach((part, p) => {
      if (!part.obstacle) return;
      const heights = [];
      this.trianglePart.forEach((q, t) => { if (q === p) for (let k = 0; k < 3; ++k) heights.push(this.rest[3 * this.triangles[3 * t + k] + axis]); });
      const low = Math.min(...heights.slice(0, 5000)), high = Math.max(...heights.slice(0, 5000));
      if (high - low < 0.02 && low <= lowest + 0.05) table = high;
    });
    return table;
  }

  invalid(frame, field) { return this.stats(frame, field)?.invalid ?? 0; }
  cutPosition() { return 0.5; }

  cutAxis() {
    const { low, high } = this.head.box;
    const extent = low.map((v, i) => high[i] - v);
    return 'xyz'[extent.indexOf(Math.min(...extent))];
  }
}
