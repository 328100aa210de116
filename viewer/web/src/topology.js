// What stays the same in every frame: which corners share a normal, which parts are closed.

// Faces that meet at less than this angle look like one smooth surface; sharper edges stay sharp.
const CREASE_COSINE = Math.cos((42 * Math.PI) / 180);

export function faceNormals(positions, triangles, out = new Float32Array(triangles.length)) {
  for (let f = 0; f < triangles.length; f += 3) {
    const a = 3 * triangles[f], b = 3 * triangles[f + 1], c = 3 * triangles[f + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
    out[f] = uy * vz - uz * vy;
    out[f + 1] = uz * vx - ux * vz;
    out[f + 2] = ux * vy - uy * vx;
  }
  return out;
}

/**
 * For each corner of each triangle the group whose normals are averaged, and for each part whether every
 * edge is shared by two triangles that run along it in opposite directions (then it can be filled).
 */
export function buildTopology(rest, triangles, trianglePart, partCount) {
  const corners = triangles.length;
  const { parent, find } = sets(corners);
  const normals = faceNormals(rest, triangles);
  const smooth = (f, g) => {
    let d = 0, ff = 0, gg = 0;
    for (let k = 0; k < 3; ++k) {
      const p = normals[3 * f + k], q = normals[3 * g + k];
      d += p * q;
      ff += p * p;
      gg += q * q;
    }
    return d >= CREASE_COSINE * Math.sqrt(ff * gg);
  };
  const closed = new Array(partCount).fill(true);
  const next = (c) => (c % 3 === 2 ? c - 2 : c + 1);
  // Edges seen once so far, by their first vertex: chains of the corners they start at.
  const first = new Int32Array(rest.length / 3).fill(-1), link = new Int32Array(corners).fill(-1);
  const ending = (from, to) => {
    let c = first[from];
    while (c >= 0 && triangles[next(c)] !== to) c = link[c];
    return c;
  };
  const remove = (from, corner) => {
    if (first[from] === corner) { first[from] = link[corner]; return; }
    let c = first[from];
    while (link[c] !== corner) c = link[c];
    link[c] = link[corner];
  };
  for (let c = 0; c < corners; ++c) {
    const f = (c - (c % 3)) / 3;
    const a = triangles[c], b = triangles[next(c)];
    const twin = ending(b, a);
    if (twin < 0) {
      // Two triangles along an edge in the same direction: not an oriented surface, never filled.
      const same = ending(a, b);
      if (same >= 0) { closed[trianglePart[f]] = false; remove(a, same); }
      link[c] = first[a];
      first[a] = c;
      continue;
    }
    remove(b, twin);
    const g = (twin - (twin % 3)) / 3;
    if (trianglePart[f] !== trianglePart[g]) { closed[trianglePart[f]] = closed[trianglePart[g]] = false; continue; }
    if (!smooth(f, g)) continue;
    parent[find(c)] = find(next(twin));
    parent[find(next(c))] = find(twin);
  }
  for (let c of first) for (; c >= 0; c = link[c]) closed[trianglePart[(c - (c % 3)) / 3]] = false;

  const { number: group, count: groupCount } = numbered(corners, find);
  return { group, groupCount, closed };
}

/** Disjoint sets of 0 to count - 1, joined by setting the parent of one root to another. */
function sets(count) {
  const parent = new Int32Array(count);
  for (let i = 0; i < count; ++i) parent[i] = i;
  const find = (i) => {
    while (parent[i] !== i) { parent[i] = parent[parent[i]]; i = parent[i]; }
    return i;
  };
  return { parent, find };
}

/** The set of each element, numbered in the order they are met. */
function numbered(elements, find) {
  const known = new Int32Array(elements).fill(-1), number = new Int32Array(elements);
  let count = 0;
  for (let i = 0; i < elements; ++i) {
    const root = find(i);
    if (known[root] < 0) known[root] = count++;
    number[i] = known[root];
  }
  return { number, count };
}

/**
 * For each triangle whether it bounds a hollow inside a closed part: nothing of that is seen from outside while
 * the part is whole. Such a piece of surface encloses a negative volume and lies in the box of one that encloses a
 * positive volume.
 */
export function hollows(rest, triangles, trianglePart, closed) {
  const { parent, find } = sets(rest.length / 3);
  for (let c = 0; c < triangles.length; c += 3) {
    parent[find(triangles[c])] = find(triangles[c + 1]);
    parent[find(triangles[c])] = find(triangles[c + 2]);
  }
  const { number, count } = numbered(rest.length / 3, find);
  const part = new Int32Array(count).fill(-1), volume = new Float64Array(count);
  const low = new Float32Array(3 * count).fill(Infinity), high = new Float32Array(3 * count).fill(-Infinity);
  for (let c = 0; c < triangles.length; c += 3) {
    const piece = number[triangles[c]];
    part[piece] = trianglePart[c / 3];
    const i = 3 * triangles[c], j = 3 * triangles[c + 1], k = 3 * triangles[c + 2];
    volume[piece] += rest[i] * (rest[j + 1] * rest[k + 2] - rest[j + 2] * rest[k + 1])
      + rest[i + 1] * (rest[j + 2] * rest[k] - rest[j] * rest[k + 2]) + rest[i + 2] * (rest[j] * rest[k + 1] - rest[j + 1] * rest[k]);
  }
  for (let v = 0; v < number.length; ++v) {
    for (let k = 0, at = 3 * number[v]; k < 3; ++k, ++at) {
      low[at] = Math.min(low[at], rest[3 * v + k]);
      high[at] = Math.max(high[at], rest[3 * v + k]);
    }
  }
  // Nodes inside a body are pieces of their own and of no part.
  const outer = [], inner = [];
  for (let p = 0; p < count; ++p) if (part[p] >= 0 && closed[part[p]]) (volume[p] > 0 ? outer : inner).push(p);
  const within = (p, q) => part[p] === part[q] && [0, 1, 2].every((k) => low[3 * q + k] < low[3 * p + k] && high[3 * q + k] > high[3 * p + k]);
  const hollow = new Uint8Array(count);
  for (const p of inner) hollow[p] = volume[p] < 0 && outer.some((q) => within(p, q)) ? 1 : 0;
  const out = new Uint8Array(trianglePart.length);
  for (let f = 0; f < out.length; ++f) out[f] = hollow[number[triangles[3 * f]]];
  return out;
}

/** Area-weighted unit normals, one a smooth group. */
export function groupNormals(faces, topology, out = new Float32Array(topology.groupCount * 3)) {
  out.fill(0);
  const { group } = topology;
  for (let c = 0; c < group.length; ++c) {
    const f = c - (c % 3);
    const g = 3 * group[c];
    out[g] += faces[f];
    out[g + 1] += faces[f + 1];
    out[g + 2] += faces[f + 2];
  }
  for (let g = 0; g < out.length; g += 3) {
    const length = Math.hypot(out[g], out[g + 1], out[g + 2]) || 1;
    out[g] /= length;
    out[g + 1] /= length;
    out[g + 2] /= length;
  }
  return out;
}

/**
 * The cut of tetrahedra with a plane: triangles with the value of the field carried to their corners.
 * plane: [nx, ny, nz, d] with n.x + d = 0 on it.
 */
export function sliceCells(cells, positions, values, plane) {
  const points = [];
  const carried = [];
  const count = positions.length / 3;
  const side = new Float32Array(count);
  for (let i = 0; i < count; ++i) {
    // Never exactly zero: a node on the plane would give degenerate pieces.
    side[i] = plane[0] * positions[3 * i] + plane[1] * positions[3 * i + 1] + plane[2] * positions[3 * i + 2] + plane[3] || 1e-7;
  }
  const cross = (i, j) => {
    const t = side[i] / (side[i] - side[j]);
    for (let k = 0; k < 3; ++k) points.push(positions[3 * i + k] + t * (positions[3 * j + k] - positions[3 * i + k]));
    carried.push(values ? values[i] + t * (values[j] - values[i]) : 0);
  };
  for (let c = 0; c < cells.length; c += 4) {
    const above = [], below = [];
    for (let k = 0; k < 4; ++k) (side[cells[c + k]] > 0 ? above : below).push(cells[c + k]);
    if (above.length === 0 || below.length === 0) continue;
    if (above.length === 2) {
      const [a, b] = above, [p, q] = below;
      cross(a, p); cross(a, q); cross(b, q);
      cross(a, p); cross(b, q); cross(b, p);
    } else {
      const [single, others] = above.length === 1 ? [above[0], below] : [below[0], above];
      for (const other of others) cross(single, other);
    }
  }
  return { points: new Float32Array(points), values: new Float32Array(carried) };
}

/** Where the surface meets the plane: pairs of points, the outline of the section. */
export function sliceSurface(triangles, positions, plane, wanted = () => true) {
  const out = [];
  const side = (v) => plane[0] * positions[3 * v] + plane[1] * positions[3 * v + 1] + plane[2] * positions[3 * v + 2] + plane[3] || 1e-7;
  for (let f = 0; f < triangles.length; f += 3) {
    if (!wanted(f / 3)) continue;
    for (let k = 0; k < 3; ++k) {
      const i = triangles[f + k], j = triangles[f + ((k + 1) % 3)];
      const a = side(i), b = side(j);
      if (a > 0 === b > 0) continue; // either no edge of a triangle crosses or two do
      const t = a / (a - b);
      for (let axis = 0; axis < 3; ++axis) out.push(positions[3 * i + axis] + t * (positions[3 * j + axis] - positions[3 * i + axis]));
    }
  }
  return out;
}
