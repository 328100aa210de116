// What a page shows when it opens, read from its address (#key=value&...): pictures are taken this way.

const on = (text) => text !== null && text !== undefined && text !== '0' && text !== 'false';

export function readOptions(location) {
  const given = new URLSearchParams(`${location.search.slice(1)}&${location.hash.slice(1)}`);
  const range = (given.get('range') ?? '').split(',').map(Number);
  // cut=x:0.5 cuts at half the extent along x and takes the half toward the camera away; cut=+x:0.5 keeps the
  // half below the plane, cut=-x:0.5 the half above, from wherever one looks.
  const cut = /^([-+]?)([xyz])(?::([\d.]+))?$/.exec(given.get('cut') ?? '');
  return {
    shot: on(given.get('shot')),
    field: given.get('field'),
    frame: given.get('frame') ?? 'last',
    view: given.get('view') ?? 'iso',
    zoom: Number(given.get('zoom')) > 0 ? Number(given.get('zoom')) : 1,
    ghost: on(given.get('ghost')),
    edges: on(given.get('edges')),
    cut: cut ? { axis: cut[2], at: cut[3] === undefined ? 0.5 : Number(cut[3]), flip: cut[1] === '' ? null : cut[1] === '-' } : null,
    range: range.length === 2 && range.every(Number.isFinite) && range[1] > range[0] ? range : null,
    perFrame: given.get('range') === 'frame',
    theme: ['light', 'dark'].includes(given.get('theme')) ? given.get('theme') : null,
    legend: given.get('legend') !== '0',
    labels: given.get('labels') !== '0',
  };
}

/** "first", "last", a number, or "t=0.5" for the frame nearest to that time. */
export function frameNumber(text, frames) {
  const last = frames.length - 1;
  if (text === 'first') return 0;
  if (text === 'last') return last;
  if (text.startsWith('t=')) return nearestFrame(Number(text.slice(2)), frames);
  const number = Number(text);
  return Number.isFinite(number) ? Math.min(last, Math.max(0, Math.round(number))) : last;
}

export function nearestFrame(time, frames) {
  let best = 0;
  frames.forEach((f, i) => { if (Math.abs(f.time - time) < Math.abs(frames[best].time - time)) best = i; });
  return best;
}
