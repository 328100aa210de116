// Color maps built in OKLab, where equal steps look equally large.

const oklabToLinear = ([L, a, b]) => {
  const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (L - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
};

const encode = (v) => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);

/** Lightness, chroma and hue (degrees) to sRGB; chroma shrinks until the color can be displayed. */
function lch(L, chroma, hue) {
  const h = (hue * Math.PI) / 180;
  for (let c = chroma; ; c -= 0.002) {
    const linear = oklabToLinear([L, Math.max(c, 0) * Math.cos(h), Math.max(c, 0) * Math.sin(h)]);
    if (c <= 0 || linear.every((v) => v >= 0 && v <= 1)) {
      return linear.map((v) => Math.round(255 * encode(Math.min(1, Math.max(0, v)))));
    }
  }
}

const mix = (a, b, t) => a + (b - a) * t;

/** Piecewise linear in t through (t, L, chroma, hue). */
function along(stops, t) {
  let i = 1;
  while (i < stops.length - 1 && t > stops[i][0]) ++i;
  const [a, b] = [stops[i - 1], stops[i]];
  const s = (t - a[0]) / (b[0] - a[0]);
  return lch(mix(a[1], b[1], s), mix(a[2], b[2], s), mix(a[3], b[3], s));
}

// Lightness rises linearly, so order survives gray printing and color blindness. The dark end stays light
// enough that shading can still be seen on it.
const SEQUENTIAL = [
  [0, 0.4, 0.16, 296],
  [0.25, 0.53, 0.14, 256],
  [0.5, 0.66, 0.12, 196],
  [0.75, 0.79, 0.16, 142],
  [1, 0.92, 0.18, 102],
];
const DIVERGING = [
  [0, 0.44, 0.15, 258],
  [0.25, 0.66, 0.11, 250],
  [0.4999, 0.93, 0.012, 245],
  [0.5001, 0.93, 0.012, 45],
  [0.75, 0.67, 0.13, 38],
  [1, 0.46, 0.17, 28],
];

const table = (stops) => {
  const out = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) out.set([...along(stops, i / 255), 255], 4 * i);
  return out;
};

const STOPS = { sequential: SEQUENTIAL, diverging: DIVERGING };
const tables = {};

/** 256 colors as RGBA bytes; made when first asked for. */
export const colorTable = (name) => (tables[name] ??= table(STOPS[name]));

// Solid colors of parts and categories: equal weight, told apart without color vision by order of lightness.
const CATEGORY = [
  [0.72, 0.085, 235], [0.76, 0.12, 60], [0.68, 0.11, 160], [0.66, 0.14, 25], [0.65, 0.11, 300],
  [0.82, 0.12, 100], [0.6, 0.08, 210], [0.76, 0.09, 345],
].map((c) => lch(...c));

export const categoryColor = (index) => CATEGORY[((index % CATEGORY.length) + CATEGORY.length) % CATEGORY.length];
export const cssColor = (rgb) => `rgb(${rgb.join(' ')})`;

/** "#rrggbb" of the run, or the palette color of this index. */
export function colorOr(text, index) {
  const match = /^#([0-9a-f]{6})$/i.exec(text ?? '');
  if (!match) return categoryColor(index);
  const value = parseInt(match[1], 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}

/** Color of a part; obstacles stay out of the palette of the bodies. */
export function partColor(part, index) {
  return part.obstacle && !part.color ? [176, 181, 188] : colorOr(part.color, index);
}

/** CSS gradient of a table, low at the start. */
export function gradient(name, direction) {
  const t = colorTable(name);
  const stops = [];
  for (let i = 0; i <= 32; ++i) {
    const k = Math.round((i / 32) * 255) * 4;
    stops.push(cssColor([...t.subarray(k, k + 3)]));
  }
  return `linear-gradient(${direction}, ${stops.join(', ')})`;
}
