// The address of a page that shows what it shows now. Behind #, which browsers send to nobody.
import { asWritten, readOptions } from './options.js';

/** Options of a live page: those of results, and `token`. */
export function readLink(location) {
  const given = asWritten(location.hash.slice(1));
  const token = given.get('token') ?? '';
  given.delete('token');
  return { ...readOptions({ search: location.search, hash: `#${given}` }), token };
}

const partsThat = (state, look) => state.looks.flatMap((l, p) => (l === look ? [p] : [])).join();

/** What is behind # of an address that shows the same. */
export function linkOf(viewer) {
  const { state, stage, connection } = viewer;
  const values = new URLSearchParams(connection?.token ? { token: connection.token } : {});
  values.set('field', state.field.name);
  if (!connection && state.frame >= 0) values.set('frame', state.frame);
  if (stage) {
    const { camera, controls } = stage;
    values.set('camera', [...camera.position.toArray(), ...controls.target.toArray()].map((v) => Number(v.toPrecision(5))).join(','));
  }
  for (const key of ['ghost', 'edges']) if (state[key]) values.set(key, '1');
  const { cut } = state;
  if (cut.axis) {
    const way = cut.axis === 'free' ? `${cut.azimuth}/${cut.elevation}` : cut.axis;
    values.set('cut', `${cut.flip ? '-' : '+'}${way}:${Number(cut.at.toFixed(3))}`);
  }
  if (state.share !== null) values.set('span', { 1: 'all', 0.98: '98', 0.9: '90' }[state.share]);
  if (state.rangeMode === 'custom' && state.custom) values.set('range', state.custom.join(','));
  if (state.rangeMode === 'frame') values.set('range', 'frame');
  const arrows = Object.keys(state.arrows).filter((name) => state.arrows[name]).join();
  if (arrows) values.set('arrows', arrows);
  for (const [key, look] of [['hide', 'hidden'], ['fade', 'faded']]) if (partsThat(state, look)) values.set(key, partsThat(state, look));
  const { theme } = document.documentElement.dataset;
  if (theme) values.set('theme', theme);
  return values.toString().replaceAll('%2C', ',').replaceAll('%3A', ':').replaceAll('%2F', '/');
}

/** Puts the address into the bar of the browser and, where that is allowed, on the clipboard. */
export async function copyLink(viewer) {
  window.history.replaceState(null, '', `#${linkOf(viewer)}`);
  try { await navigator.clipboard.writeText(window.location.href); } catch { /* it stands in the address bar */ }
}
