// Where labels stand: beside their point, where no other label is yet.

const AWAY = 10; // pixels between a point and its label
const GAP = 2; // between labels

const meet = (a, b) => a.x < b.x + b.width + GAP && b.x < a.x + a.width + GAP && a.y < b.y + b.height + GAP && b.y < a.y + a.height + GAP;

/** Places around a point, the nearest first: to its right, left, above and below, then further off. */
function* placesAround(x, y, width, height) {
  for (let ring = 0; ring < 6; ++ring) {
    const far = ring * (height + GAP);
    for (const dy of ring === 0 ? [-height - 3, 3] : [-height - 3 - far, 3 + far]) {
      yield { x: x + AWAY, y: y + dy };
      yield { x: x - AWAY - width, y: y + dy };
    }
    yield { x: x - width / 2, y: y - AWAY - height - far };
    yield { x: x - width / 2, y: y + AWAY + far };
  }
}

/**
 * For each of the points { x, y, width, height } or null (not seen) where its label stands, or null where there is no
 * room. taken: boxes that are to stay free; bounds: width and height of the picture.
 */
export function placeLabels(points, bounds, taken = []) {
  const boxes = [...taken];
  return points.map((point) => {
    if (!point) return null;
    const { width, height } = point;
    for (const place of placesAround(point.x, point.y, width, height)) {
      const box = { ...place, width, height };
      if (box.x < 0 || box.y < 0 || box.x + width > bounds.width || box.y + height > bounds.height) continue;
      if (boxes.some((other) => meet(box, other))) continue;
      boxes.push(box);
      return place;
    }
    return null;
  });
}
