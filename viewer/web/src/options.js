// What a page shows when it opens, read from its address (#key=value&...): pictures are taken this way.

const FLAG = { test: (text) => ['0', '1', 'true', 'false'].includes(text), wants: '0 or 1' };
const pattern = (regex, wants) => ({ test: (text) => regex.test(text), wants });
const NUMBER = '[-+]?(\\d+\\.?\\d*|\\.\\d+)(e[-+]?\\d+)?';
const VIEWS = ['iso', 'front', 'back', 'right', 'left', 'top', 'bottom'];
const CUT = /^([-+]?)(auto|[xyz])(?::(0?\.\d+|[01](?:\.\d*)?))?$/;

const isRange = (text) => {
  const range = text.split(',');
  return range.length === 2 && range.every((v) => v.trim() !== '' && Number.isFinite(Number(v))) && Number(range[1]) > Number(range[0]);
};

/** Every option, how its value is tested, and what it wants. */
const OPTIONS = {
  shot: FLAG,
  field: { test: () => true, wants: 'the name of a field' }, // tested where the fields are known
  frame: pattern(new RegExp(`^(first|last|\\d+|t=${NUMBER})$`, 'i'), 'first, last, a number from 0 or t=SECONDS'),
  view: pattern(new RegExp(`^(${VIEWS.join('|')}|${NUMBER},${NUMBER})$`, 'i'), `${VIEWS.join(', ')} or AZIMUTH,ELEVATION in degrees`),
  zoom: { test: (text) => Number(text) > 0 && Number.isFinite(Number(text)), wants: 'a positive number' },
  ghost: FLAG,
  edges: FLAG,
  cut: { test: (text) => CUT.test(text) && !(Number(CUT.exec(text)[3]) > 1), wants: 'x, y, z or auto, where wanted with the place from 0 to 1 as in x:0.5' },
  range: { test: (text) => text === 'frame' || isRange(text), wants: 'LOW,HIGH or frame' },
  full: FLAG,
  theme: pattern(/^(light|dark)$/, 'light or dark'),
  legend: FLAG,
  labels: FLAG,
};

const on = (text) => text === '1' || text === 'true';

/** The options, and under `problems` one sentence for each that is unknown or has a value it cannot have. */
export function readOptions(location) {
  const given = new URLSearchParams(`${location.search.slice(1)}&${location.hash.slice(1)}`);
  const problems = [];
  for (const [key, value] of [...given]) {
    if (!(key in OPTIONS)) problems.push(`There is no option "${key}"; there are ${Object.keys(OPTIONS).join(', ')}.`);
    else if (!OPTIONS[key].test(value)) {
      problems.push(`${key}=${value}: ${key} wants ${OPTIONS[key].wants}.`);
      given.delete(key); // as if it had not been given
    }
  }
  // cut=x:0.5 cuts at half the extent along x and takes the half toward the camera away; cut=+x:0.5 keeps the
  // half below the plane, cut=-x:0.5 the half above, from wherever one looks. Without a place it goes through
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
    cut: cut ? { axis: cut[2], at: cut[3] === undefined ? null : Number(cut[3]), flip: cut[1] === '' ? null : cut[1] === '-' } : null,
    range: isRange(range) ? range.split(',').map(Number) : null,
    perFrame: range === 'frame',
    full: on(given.get('full')),
    theme: given.get('theme'),
    legend: given.get('legend') === null || on(given.get('legend')),
    labels: given.get('labels') === null || on(given.get('labels')),
  };
}

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
