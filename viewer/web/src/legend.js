// The color legend: label, unit, round ticks; swatches for categories.
import { categoryColor, cssColor, gradient, partColor } from './colors.js';
import { fixed, niceTicks, significant, unitScale } from './numbers.js';
import { el } from './dom.js';

export function drawLegend(host, { field, range, share, beyond, parts, invalid, perFrame }) {
  host.replaceChildren();
  host.hidden = false;
  if (field.kind === 'solid' || field.categories.length > 0) {
    const names = field.kind === 'solid' ? parts.map((p) => p.name) : field.categories;
    host.hidden = names.filter(Boolean).length === 0 || (field.kind === 'solid' && names.length < 2);
    if (field.kind !== 'solid') host.append(el('div', { class: 'legend-title' }, field.label || field.name));
    host.append(el('ul', { class: 'swatches' }, ...names.map((name, i) => el('li', {},
      el('i', { style: `background:${cssColor(field.kind === 'solid' ? partColor(parts[i], i) : categoryColor(i))}` }),
      name || `${i}`))));
    return;
  }
  const table = field.diverging ? 'diverging' : 'sequential';
  if (!range) {
    host.append(el('div', { class: 'legend-title' }, field.label || field.name),
      el('div', { class: 'legend-note' }, 'no finite value'));
    return;
  }
  const [low, high] = range;
  const scale = unitScale(Math.max(Math.abs(low), Math.abs(high)), field.unit);
  host.append(el('div', { class: 'legend-title' }, field.label || field.name,
    scale.unit ? el('span', { class: 'unit' }, scale.unit) : ''));
  const bar = el('div', { class: 'bar', style: `background:${gradient(table, 'to top')}` });
  const { ticks, decimals } = niceTicks(low * scale.factor, high * scale.factor, 6);
  const span = (high - low) * scale.factor;
  for (const tick of ticks) {
    const at = span > 0 ? (tick - low * scale.factor) / span : 0.5;
    bar.append(el('span', { class: 'tick', style: `bottom:${(100 * at).toFixed(2)}%` }, fixed(tick, decimals)));
  }
  host.append(bar);
  if (beyond) {
    const number = (v) => significant(v * scale.factor, 3);
    host.append(el('div', { class: 'legend-note' },
      `colors span ${significant(50 * (1 - share), 2)} % to ${significant(50 * (1 + share), 3)} % of the points; all: ${number(beyond[0])} to ${number(beyond[1])}`));
  }
  if (perFrame) host.append(el('div', { class: 'legend-note' }, 'range of this frame'));
  if (invalid > 0) {
    host.append(el('div', { class: 'legend-note' }, el('i', { class: 'gray' }), `${invalid} not finite`));
  }
}
