// The skeleton of the page and its tables.
import { el } from './dom.js';
import { significant, unitScale } from './numbers.js';
import { chartScale } from './plots.js';

const ICONS = {
  play: 'M8 5v14l11-7z', pause: 'M7 5h4v14H7zm6 0h4v14h-4z', back: 'M6 5h2v14H6zm3 7l9-7v14z', next: 'M16 5h2v14h-2zM6 5l9 7-9 7z',
  reset: 'M12 5V1L7 6l5 5V7a5 5 0 1 1-5 5H5a7 7 0 1 0 7-7z',
};

export function icon(name) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 24 24');
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  path.setAttribute('d', ICONS[name]);
  svg.append(path);
  return svg;
}

const svgElement = (className) => {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('class', className);
  svg.setAttribute('viewBox', '0 0 64 64');
  svg.setAttribute('aria-hidden', 'true');
  return svg;
};

/** Numbers of a table entry in the unit that the charts have. */
function entryText([, value, numbers, unit], scaleOf) {
  if (!numbers) return value;
  const scale = scaleOf(unit, Math.max(...numbers.map(Math.abs)));
  return numbers.reduce((text, v, k) => text.replace(`#${k}`, `${significant(v * scale.factor, 5)} ${scale.unit}`.trim()), value);
}

function table(caption, rows, scaleOf) {
  if (rows.length === 0) return '';
  return el('section', { class: 'card' }, el('h2', {}, caption), el('table', {}, el('tbody', {},
    ...rows.map((row) => el('tr', {}, el('th', { scope: 'row' }, row[0]), el('td', {}, entryText(row, scaleOf)))))));
}

export function buildPage(head) {
  const page = {};
  page.stage = el('div', { class: 'stage' },
    el('canvas', { tabindex: '0', role: 'img', 'aria-label': 'The deformed body. Shift and arrow keys turn it, plus and minus zoom.' }),
    el('div', { class: 'labels' }), el('div', { class: 'stamp' }), el('div', { class: 'legend', hidden: true }),
    el('div', { class: 'arrow-key', hidden: true }), svgElement('triad'));
  page.stamp = page.stage.querySelector('.stamp');
  page.legend = page.stage.querySelector('.legend');
  page.arrowKey = page.stage.querySelector('.arrow-key');
  page.transport = el('div', { class: 'transport', role: 'group', 'aria-label': 'Playback' });
  page.controls = el('aside', { class: 'card controls', 'aria-label': 'Display' });
  page.theme = el('button', { class: 'quiet', type: 'button', title: 'Switch between light and dark' }, 'Theme');
  page.plots = el('section', { class: 'plots', 'aria-label': 'Time series' });
  page.notes = el('div', { class: 'notes', role: 'status' });
  const header = el('header', {},
    el('div', {}, el('h1', {}, head.title || 'Results'), head.subtitle ? el('p', { class: 'subtitle' }, head.subtitle) : ''),
    page.theme);
  const counts = `${head.vertices.toLocaleString('en-US')} vertices, ${head.triangles.toLocaleString('en-US')} triangles, `
    + `${head.frames.length.toLocaleString('en-US')} ${head.frames.length === 1 ? 'frame' : 'frames'}`;
  const scaleOf = (unit, magnitude) => chartScale(head.series, unit) ?? unitScale(magnitude, unit);
  page.root = el('div', { class: 'page' }, header, page.notes,
    el('main', {},
      el('div', { class: 'viewer' }, el('div', { class: 'card view' }, page.stage, page.transport), page.controls),
      page.plots,
      el('div', { class: 'tables' }, table('Summary', head.summary, scaleOf), table('Run', head.run, scaleOf))),
    el('footer', {}, el('span', {}, head.footer || 'Isochor'), el('span', {}, counts)));
  return page;
}

/** A labeled on/off switch. */
export function toggle(label, key, checked, change) {
  const input = el('input', { type: 'checkbox', checked, onchange: () => change(input.checked) });
  return { node: el('label', { class: 'toggle' }, input, el('span', {}, label), key ? el('kbd', {}, key) : ''), input };
}

/** One choice out of a few, as a row of buttons. */
export function choice(label, options, current, change) {
  const buttons = options.map(([value, text]) => el('button', {
    type: 'button', 'aria-pressed': String(value === current), onclick: () => { set(value); change(value); },
  }, text));
  const set = (value) => buttons.forEach((b, i) => b.setAttribute('aria-pressed', String(options[i][0] === value)));
  return { node: el('div', { class: 'choice', role: 'group', 'aria-label': label }, ...buttons), set };
}
