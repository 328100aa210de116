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
  const parent = new Int32Array(corners).map((_, i) => i);
  const find = (i) => {
    while (parent[i] !== i) { parent[i] = parent[parent[i]]; i = parent[i]; }
    return i;
  };
  const normals = faceNormals(rest, triangles);
  const smooth = (f, g) => {
    let d = 0, ff = 0, gg = 0;
    for (let k = 0; k < 3; ++k) {
      d += normals[3 * f + k] * normals[3 * g + k];
      ff += normals[3 * f + k] ** 2;
      gg += normals[3 * g + k] ** 2;
    }
    return d >= CREASE_COSINE * Math.sqrt(ff * gg);
  };
  const closed = new Array(partCount).fill(true);
  const open = new Map(); // edge seen once so far -> its first corner
  const vertices = rest.length / 3;
  for (let c = 0; c < corners; ++c) {
    const f = Math.floor(c / 3);
    const next = c % 3 === 2 ? c - 2 : c + 1;
    const [a, b] = [triangles[c], triangles[next]];
    const twin = open.get(b * vertices + a);
    if (twin === undefined) {
      // Two triangles along an edge in the same direction: not an oriented surface, never filled.
      if (open.has(a * vertices + b)) closed[trianglePart[f]] = false;
      open.set(a * vertices + b, c);
      continue;
    }
    open.delete(b * vertices + a);
    const g = Math.floor(twin / 3);
    if (trianglePart[f] !== trianglePart[g]) { closed[trianglePart[f]] = closed[trianglePart[g]] = false; continue; }
    if (!smooth(f, g)) continue;
    const twinNext = twin % 3 === 2 ? twin - 2 : twin + 1;
    parent[find(c)] = find(twinNext);
    parent[find(next)] = find(twin);
  }
  for (const c of open.values()) closed[trianglePart[Math.floor(c / 3)]] = false;

  const group = new Int32Array(corners);
  const number = new Map();
  for (let c = 0; c < corners; ++c) {
    const root = find(c);
    if (!number.has(root)) number.set(root, number.size);
    group[c] = number.get(root);
  }
  return { group, groupCount: number.size, closed };
}

/**
 * For each triangle whether it bounds a hollow inside a closed part: nothing of that is seen from outside while
 * the part is whole. Such a piece of surface encloses a negative volume and lies in the box of one that encloses a
 * positive volume.
 */
export function hollows(rest, triangles, trianglePart, closed) {
  const count = trianglePart.length;
  const parent = new Int32Array(rest.length / 3).map((_, i) => i);
  const find = (i) => {
    while (parent[i] !== i) { parent[i] = parent[parent[i]]; i = parent[i]; }
    return i;
  };
  for (let c = 0; c < triangles.length; c += 3) {
    parent[find(triangles[c])] = find(triangles[c + 1]);
    parent[find(triangles[c])] = find(triangles[c + 2]);
  }
  const pieces = new Map();
  const pieceOf = new Array(count);
  for (let f = 0; f < count; ++f) {
    const root = find(triangles[3 * f]);
    let piece = pieces.get(root);
    if (!piece) {
      piece = { part: trianglePart[f], volume: 0, low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
      pieces.set(root, piece);
    }
    pieceOf[f] = piece;
    if (piece.part !== trianglePart[f]) piece.part = -1; // two parts share a node
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[3 * f + k]);
    const [ax, ay, az, bx, by, bz, cx, cy, cz] = [
      rest[a], rest[a + 1], rest[a + 2], rest[b], rest[b + 1], rest[b + 2], rest[c], rest[c + 1], rest[c + 2]];
    piece.volume += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
    for (let k = 0; k < 3; ++k) {
      piece.low[k] = Math.min(piece.low[k], rest[a + k], rest[b + k], rest[c + k]);
      piece.high[k] = Math.max(piece.high[k], rest[a + k], rest[b + k], rest[c + k]);
    }
  }
  const all = [...pieces.values()];
  for (const piece of all) {
    piece.hollow = closed[piece.part] === true && piece.volume < 0 && all.some((other) => other.part === piece.part && other.volume > 0
      && [0, 1, 2].every((k) => other.low[k] < piece.low[k] && other.high[k] > piece.high[k]));
  }
  return Uint8Array.from(pieceOf, (piece) => (piece.hollow ? 1 : 0));
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
export function sliceSurface(triangles, positions, plane) {
  const out = [];
  const side = (v) => plane[0] * positions[3 * v] + plane[1] * positions[3 * v + 1] + plane[2] * positions[3 * v + 2] + plane[3] || 1e-7;
  for (let f = 0; f < triangles.length; f += 3) {
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
