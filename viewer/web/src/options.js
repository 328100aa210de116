// What a page shows when it opens, read from its address (#key=value&...): pictures are taken this way.

const FLAG = { test: (text) => ['0', '1', 'true', 'false'].includes(text), wants: '0 or 1' };
const pattern = (regex, wants) => ({ test: (text) => regex.test(text), wants });
const NUMBER = '[-+]?(\\d+\\.?\\d*|\\.\\d+)(e[-+]?\\d+)?';
const VIEWS = ['iso', 'front', 'back', 'right', 'left', 'top', 'bottom'];
const CUT = /^([-+]?)(auto|[xyz]|-?\d+(?:\.\d+)?\/-?\d+(?:\.\d+)?)(?::(0?\.\d+|[01](?:\.\d*)?))?$/;
const PARTS = pattern(/^\d+(,\d+)*$/, 'numbers of parts from 0, as in 0,2');

const isRange = (text) => {
  const range = text.split(',');
  return range.length === 2 && range.every((v) => v.trim() !== '' && Number.isFinite(Number(v))) && Number(range[1]) > Number(range[0]);
};

const isList = (text, count) => { const list = text.split(','); return list.length === count && list.every((v) => v.trim() !== '' && Number.isFinite(Number(v))); };

/** Every option, how its value is tested, and what it wants. */
const OPTIONS = {
  shot: FLAG,
  field: { test: () => true, wants: 'the name of a field' }, // tested where the fields are known
  frame: pattern(new RegExp(`^(first|last|\\d+|t=${NUMBER})$`, 'i'), 'first, last, a number from 0 or t=SECONDS'),
  view: pattern(new RegExp(`^(${VIEWS.join('|')}|${NUMBER},${NUMBER})$`, 'i'), `${VIEWS.join(', ')} or AZIMUTH,ELEVATION in degrees`),
  zoom: { test: (text) => Number(text) > 0 && Number.isFinite(Number(text)), wants: 'a positive number' },
  ghost: FLAG,
  edges: FLAG,
  cut: { test: (text) => CUT.test(text) && !(Number(CUT.exec(text)[3]) > 1), wants: 'x, y, z, auto or AROUND/UP in degrees, where wanted with the place from 0 to 1 as in x:0.5' },
  camera: { test: (text) => isList(text, 6), wants: 'six numbers: where it stands, what it looks at' },
  hide: PARTS,
  fade: PARTS,
  arrows: pattern(/^(forces|fibers)(,(forces|fibers))?$/, 'forces, fibers or both with a comma'),
  span: pattern(/^(all|98|90)$/, 'all, 98 or 90 percent of the values'),
  range: { test: (text) => text === 'frame' || isRange(text), wants: 'LOW,HIGH or frame' },
  full: FLAG,
  theme: pattern(/^(light|dark)$/, 'light or dark'),
  legend: FLAG,
  labels: FLAG,
};

const on = (text) => text === '1' || text === 'true';

/** key=value&... of an address, in which a plus is a plus: it says which half of a cut stays. */
export const asWritten = (text) => new URLSearchParams(text.replaceAll('+', '%2B'));

/** The options, and under `problems` one sentence for each that is unknown or has a value it cannot have. */
export function readOptions(location) {
  const given = asWritten(`${location.search.slice(1)}&${location.hash.slice(1)}`);
  const problems = [];
  for (const [key, value] of [...given]) {
    if (!(key in OPTIONS)) problems.push(`There is no option "${key}"; there are ${Object.keys(OPTIONS).join(', ')}.`);
    else if (!OPTIONS[key].test(value)) {
      problems.push(`${key}=${value}: ${key} wants ${OPTIONS[key].wants}.`);
      given.delete(key); // as if it had not been given
    }
  }
  // cut=x:0.5 cuts at half the extent along x and takes the half toward the camera away; cut=+x:0.5 keeps the
  // half below the plane, cut=-x:0.5 the half above, from wherever one looks; cut=30/20:0.5 faces 30 degrees around and 20 up. Without a place it goes through
  // what the run has inside; cut=auto also finds the axis.
  const cut = CUT.exec(given.get('cut') ?? '');
  const range = given.get('range') ?? '';
  return {
    problems,
    shot: on(given.get('shot')),
    field: given.get('field'),
    frame: given.get('frame') ?? 'last',
    view: given.get('view') ?? 'iso',
    zoom: Number(given.get('zoom') ?? 1),
    ghost: on(given.get('ghost')),
    edges: on(given.get('edges')),
    cut: readCut(cut),
    camera: given.has('camera') ? given.get('camera').split(',').map(Number) : null,
    hide: numbers(given.get('hide')),
    fade: numbers(given.get('fade')),
    arrows: { forces: /forces/.test(given.get('arrows') ?? ''), fibers: /fibers/.test(given.get('arrows') ?? '') },
    range: isRange(range) ? range.split(',').map(Number) : null,
    perFrame: range === 'frame',
    share: on(given.get('full')) ? 1 : { all: 1, 98: 0.98, 90: 0.9 }[given.get('span')] ?? null,
    theme: given.get('theme'),
    legend: given.get('legend') === null || on(given.get('legend')),
    labels: given.get('labels') === null || on(given.get('labels')),
  };
}

const numbers = (text) => (text ? text.split(',').map(Number) : []);

function readCut(found) {
  const cut = { axis: null, at: null, flip: null, azimuth: 0, elevation: 0 };
  if (!found) return cut;
  cut.flip = found[1] === '' ? null : found[1] === '-';
  if (found[3] !== undefined) cut.at = Number(found[3]);
  cut.axis = found[2];
  if (found[2].includes('/')) {
    cut.axis = 'free';
    [cut.azimuth, cut.elevation] = found[2].split('/').map(Number);
  }
  return cut;
}

/** How each part is shown. */
export const looksOf = (options, parts) => parts.map((_, p) => (options.hide.includes(p) ? 'hidden' : options.fade.includes(p) ? 'faded' : 'shown'));

/** "first", "last", a number, or "t=0.5" for the frame nearest to that time. */
export function frameNumber(text, frames) {
  const last = frames.length - 1;
  if (text === 'first') return 0;
  if (text === 'last') return last;
  if (text.startsWith('t=')) return nearestFrame(Number(text.slice(2)), frames);
  return Math.min(last, Number(text));
}

export function nearestFrame(time, frames) {
  let best = 0;
  frames.forEach((f, i) => { if (Math.abs(f.time - time) < Math.abs(frames[best].time - time)) best = i; });
  return best;
}
