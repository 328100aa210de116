// Reads what viewer/results_page.cpp wrote: a JSON head and one compressed block for the rest state and
// for each frame. Frames are unpacked when first shown, so a long run opens as fast as a short one.

import { RELATIVE, apartFromCommon, quantiles, verticesOfBodies } from './rigid.js';

const INVALID_CODE = 65535; // a value that was NaN or infinite
const FIELD_LEVELS = 4095;
const AHEAD_BYTES = 100e6; // of frames unpacked before they are asked for

/** Base64 of a zlib stream to its bytes. */
export async function inflate(base64) {
  const text = atob(base64);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < packed.length; ++i) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Walks the bytes of one block in the order the writer packed them. */
class BlockReader {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  take(length) {
    const from = this.at;
    this.at += length;
    if (this.at > this.bytes.length) throw new Error('the data of this page is cut short');
    return this.bytes.subarray(from, this.at);
  }

  // Integers come as differences to their predecessor with their bytes in separate planes: that is what
  // makes neighboring vertices compress well.
  integers(count, ArrayType) {
    const width = ArrayType.BYTES_PER_ELEMENT;
    const planes = this.take(count * width);
    const out = new ArrayType(count);
    let value = 0;
    if (width === 2) {
      for (let i = 0; i < count; ++i) {
        value = (value + (planes[i] | (planes[count + i] << 8))) & 65535;
        out[i] = value;
      }
      return out;
    }
    for (let i = 0; i < count; ++i) {
      let step = 0;
      for (let k = width - 1; k >= 0; --k) step = (step << 8) | planes[k * count + i];
      value = (value + step) | 0;
      out[i] = value;
    }
    return out;
  }

  u16(count) { return this.integers(count, Uint16Array); }
  u32(count) { return this.integers(count, Uint32Array); }

  floats(count) {
    return new Float32Array(this.take(count * 4).slice().buffer);
  }

  // A count and that many points.
  points() {
    const count = new DataView(this.take(4).slice().buffer).getUint32(0, true);
    return this.floats(count * 3);
  }
}

/** Everything the page shows, in world coordinates scaled to a sphere of radius one. */
export class RunData {
  constructor(head, blocks) {
    this.head = head;
    this.blocks = blocks;
    this.frames = new Array(head.frames.length).fill(null);
    this.ranges = new Map();
    const { low, high } = head.box;
    this.center = low.map((v, i) => 0.5 * (v + high[i]));
    const diagonal = Math.hypot(...low.map((v, i) => high[i] - v));
    this.scale = diagonal > 0 ? 2 / diagonal : 1;
  }

  static async open(doc) {
    const element = doc.getElementById('isochor-head');
    if (!element) throw new Error('this page holds no results');
    const head = JSON.parse(element.textContent);
    if (head.format !== 1) throw new Error(`the data of this page has format ${head.format}, expected 1`);
    const run = new RunData(head, [...doc.querySelectorAll('script.isochor-block')]);
    await run.readStatic();
    return run;
  }

  async bytesOf(index) {
    const element = this.blocks[index];
    if (!element) throw new Error(`block ${index} of this page is missing`);
    const bytes = await inflate(element.textContent.trim());
    element.remove(); // the text is the larger half of the memory
    return bytes;
  }

  async readStatic() {
    const { head } = this;
    const reader = new BlockReader(await this.bytesOf(0));
    this.rest = this.toWorld(this.codes(reader), head.restBox);
    this.triangles = reader.u32(head.triangles * 3);
    this.trianglePart = reader.u16(head.triangles);
    this.edgeMask = reader.u16(head.triangles);
    this.cells = reader.u32(head.cells * 4);
  }

  codes(reader) {
    const n = this.head.vertices;
    return [reader.u16(n), reader.u16(n), reader.u16(n)];
  }

  /** Quantized coordinates of one box to scene coordinates, xyz a vertex. */
  toWorld(codes, box) {
    const n = codes[0].length;
    const out = new Float32Array(n * 3);
    for (let axis = 0; axis < 3; ++axis) {
      const step = ((box[axis + 3] - box[axis]) / 65535) * this.scale;
      const origin = (box[axis] - this.center[axis]) * this.scale;
      const code = codes[axis];
      for (let i = 0; i < n; ++i) out[3 * i + axis] = origin + code[i] * step;
    }
    return out;
  }

  worldPoints(points) {
    return points.map((v, i) => (v - this.center[i % 3]) * this.scale);
  }

  get frameCount() { return this.frames.length; }

  /** One frame, unpacked on first use. */
  frame(index) {
    this.frames[index] ??= this.readFrame(index);
    return this.frames[index];
  }

  /** Unpacks the rest while nothing else is to do, up to the memory a page may well take. */
  unpackAhead() {
    const { head } = this;
    const bytes = 2 * head.fields.reduce((sum, f) => sum + (f.place === 'triangle' ? head.triangles : head.vertices), 3 * head.vertices);
    const most = Math.min(this.frameCount, Math.floor(AHEAD_BYTES / Math.max(1, bytes)));
    const idle = window.requestIdleCallback ?? ((work) => setTimeout(work, 30));
    const next = (index) => {
      while (index < most && this.frames[index]) ++index;
      if (index < most) idle(() => this.frame(index).then(() => next(index + 1), () => {})); // who asks for it hears of it
    };
    next(0);
  }

  async readFrame(index) {
    const { head } = this;
    const info = head.frames[index];
    const reader = new BlockReader(await this.bytesOf(index + 1));
    const codes = this.codes(reader);
    const fields = head.fields.map((f) => reader.u16(f.place === 'triangle' ? head.triangles : head.vertices));
    const lines = head.lines.map(() => this.worldPoints(reader.points()));
    const probes = this.worldPoints(reader.points());
    const contacts = this.worldPoints(reader.points());
    const forces = reader.points();
    for (let i = 0; i < forces.length; i += 9) for (let k = 0; k < 3; ++k) forces[i + k] = (forces[i + k] - this.center[k]) * this.scale;
    const fibers = this.worldPoints(reader.points());
    return { index, info, codes, fields, lines, probes, contacts, forces, fibers };
  }

  /** Kept for the frame asked for last: its shape, its displacements and its section all need them. */
  positions(frame) {
    if (this.placed?.index !== frame.index) {
      this.placed = { index: frame.index, points: this.toWorld(frame.codes, frame.info.box) };
    }
    return this.placed.points;
  }

  /** Values of a field in one frame (physical units; NaN where the run had none). */
  values(frame, field) {
    if (field.kind === 'solid') return null;
    if (field.kind === 'relative') return this.relative(frame);
    if (field.kind === 'displacement') {
      const now = this.positions(frame);
      const out = new Float32Array(this.head.vertices);
      for (let i = 0; i < out.length; ++i) {
        out[i] = Math.hypot(now[3 * i] - this.rest[3 * i], now[3 * i + 1] - this.rest[3 * i + 1],
          now[3 * i + 2] - this.rest[3 * i + 2]) / this.scale;
      }
      return out;
    }
    const [low, high] = frame.info.ranges[field.index];
    const codes = frame.fields[field.index];
    const out = new Float32Array(codes.length);
    const step = (high - low) / FIELD_LEVELS;
    for (let i = 0; i < codes.length; ++i) out[i] = codes[i] === INVALID_CODE ? NaN : low + codes[i] * step;
    return out;
  }

  /** Displacements less the common motion of each body; kept for the frame asked for last. */
  relative(frame) {
    if (this.apart?.index !== frame.index) {
      this.bodies ??= verticesOfBodies(this);
      const values = apartFromCommon(this.rest, this.positions(frame), this.bodies).map((v) => v / this.scale);
      this.apart = { index: frame.index, values };
    }
    return this.apart.values;
  }

  /** What has to be known of all frames before a field can be shown: the range of what the page itself computes. */
  async prepare(field) {
    if (field.kind !== 'relative' || this.relativeRanges) return;
    const ranges = [];
    for (let i = 0; i < this.frameCount; ++i) ranges.push(quantiles(this.relative(await this.frame(i)), this.bodies));
    this.relativeRanges = ranges;
  }

  get hasForces() { return this.head.frames.some((f) => f.force > 0); }
  get hasFibers() { return this.head.fibers === true; }
  largestForce() { return this.mostForce ??= this.head.frames.reduce((most, f) => Math.max(most, f.force ?? 0), 0); }

  /** How many values of a field in one frame are not finite. */
  invalid(frame, field) { return field.kind === 'given' ? frame.info.ranges[field.index][2] : 0; }

  /** The fields of the run and the two that every run has. */
  fieldList() {
    const given = this.head.fields.map((f, index) => ({ ...f, kind: 'given', index }));
    const names = new Set(given.map((f) => f.name));
    const list = [...given];
    if (!names.has('displacement') && this.frameCount > 0) {
      list.push({ name: 'displacement', label: 'Displacement', unit: 'm', kind: 'displacement', place: 'vertex',
        diverging: false, center: 0, categories: [] });
    }
    if (this.frameCount > 0) list.push(RELATIVE);
    list.push({ name: 'solid', label: 'None (solid color)', unit: '', kind: 'solid', place: 'vertex',
      categories: [] });
    return list;
  }

  /**
   * Range of the finite values of a field in one frame: all of them, or the share of them in the middle, which a hot
   * spot does not stretch. Null when there is none.
   */
  frameRange(field, index, share = 1) {
    const info = this.head.frames[index];
    if (field.kind === 'displacement') return [0, info.displacement];
    if (field.kind === 'relative') return this.relativeRanges?.[index][share] ?? null;
    const range = info.ranges[field.index];
    if (range[0] === null) return null;
    const [low, high] = { 0.98: [range[3], range[4]], 0.9: [range[5], range[6]] }[share] ?? [range[0], range[1]];
    // Where a share leaves nothing, all of it is shown.
    return high > low ? [low, high] : [range[0], range[1]];
  }

  /** The same over the whole run. */
  runRange(field, share = 1) {
    const key = `${share} ${field.name}`;
    if (field.kind === 'relative' && !this.relativeRanges) return null;
    if (this.ranges.has(key)) return this.ranges.get(key);
    let out = null;
    for (let i = 0; i < this.frameCount; ++i) {
      const range = this.frameRange(field, i, share);
      if (range) out = out ? [Math.min(out[0], range[0]), Math.max(out[1], range[1])] : range;
    }
    this.ranges.set(key, out);
    return out;
  }

  /** Of the shadow: the lowest that anything gets to. */
  groundHeight() {
    const axis = this.head.up === 'y' ? 1 : 2;
    return (this.head.box.low[axis] - this.center[axis]) * this.scale;
  }

  /** Where a cut across this axis opens, as a part of the extent of the run. */
  cutPosition(axis) {
    const { low, high } = this.head.box;
    const { section } = this.head;
    if (!section || !(high[axis] > low[axis])) return 0.5;
    return Math.min(1, Math.max(0, (section.at[axis] - low[axis]) / (high[axis] - low[axis])));
  }

  /** The axis to cut across: the one the run names, or the one along which everything is shortest. */
  cutAxis() {
    const { low, high } = this.head.box;
    if (this.head.section) return this.head.section.axis;
    const extent = low.map((v, i) => high[i] - v);
    return 'xyz'[extent.indexOf(Math.min(...extent))];
  }
}
