// The address of a live page: the token, and what the picture shows. Behind #, which browsers send to nobody.
import { readOptions } from '../options.js';

/** Options as of a results page, with `token` and `camera` (where it stands, what it looks at). */
export function readLink(location) {
  const given = new URLSearchParams(location.hash.slice(1));
  const token = given.get('token') ?? '';
  const camera = (given.get('camera') ?? '').split(',').map(Number);
  given.delete('token');
  given.delete('camera');
  const options = readOptions({ search: location.search, hash: `#${given}` });
  return { ...options, token, camera: camera.length === 6 && camera.every(Number.isFinite) ? camera : null };
}

/** An address that shows the scene as this viewer does now. */
export function makeLink(viewer, location) {
  const { state, stage, connection } = viewer;
  const values = new URLSearchParams({ token: connection.token, field: state.field.name });
  if (stage) {
    const { camera, controls } = stage;
    values.set('camera', [...camera.position.toArray(), ...controls.target.toArray()].map((v) => Number(v.toPrecision(5))).join(','));
  }
  for (const key of ['ghost', 'edges', 'full']) if (state[key]) values.set(key, '1');
  if (state.cut.axis) values.set('cut', `${state.cut.flip ? '-' : '+'}${state.cut.axis}:${Number(state.cut.at.toFixed(3))}`);
  if (state.rangeMode === 'custom' && state.custom) values.set('range', state.custom.join(','));
  if (state.rangeMode === 'frame') values.set('range', 'frame');
  const { theme } = document.documentElement.dataset;
  if (theme) values.set('theme', theme);
  return `${location.origin}/#${values.toString().replaceAll('%2C', ',').replaceAll('%3A', ':')}`;
}
