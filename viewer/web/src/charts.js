// Opens a page of diagrams: text, charts, bars and tables of a study.
import 'uplot/dist/uPlot.min.css';
import './style.css';
import './charts.css';
import uPlot from 'uplot';
import { el } from './dom.js';
import { significant } from './numbers.js';

const LIGHT = ['#1f6fb5', '#d1571b', '#2a8a57', '#a4388f', '#8a6d00', '#5b55c9', '#c22f4b', '#45707f', '#7a5230', '#3f3f3f', '#7fa81f', '#e05fa8'];
const DARK = ['#6db3f2', '#f59a62', '#6ccb97', '#e08bd0', '#dcc04f', '#a9a4ff', '#f5839a', '#93bccb', '#d0a27a', '#cfcfcf', '#b9dc62', '#ff9fd0'];
const HEIGHT = 380;
const FONT = '11px system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif';

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const dark = () => css('--dark') === '1';

/** One color for one name on the whole page: a formulation looks the same in every diagram. */
const colors = new Map();
function colorOf(name) {
  if (!colors.has(name)) colors.set(name, colors.size);
  const palette = dark() ? DARK : LIGHT;
  return palette[colors.get(name) % palette.length];
}

/** Range of an axis with a little room; logarithmic axes by decades. */
function paddedRange(values, log) {
  const low = Math.min(...values), high = Math.max(...values);
  if (log) return [low / 1.4, high * 1.4];
  const pad = high > low ? 0.05 * (high - low) : Math.abs(high) * 0.1 || 1;
  return [low - pad, high + pad];
}

/** Ticks of a logarithmic axis: decades, and where these are few also 2 and 5 times them. */
function logTicks(low, high) {
  const decades = Math.log10(high / low);
  const steps = decades < 2.5 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / 9));
  const out = [];
  for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); ++k) {
    if (k % every !== 0) continue;
    for (const m of steps) {
      const v = m * 10 ** k;
      if (v >= low && v <= high) out.push(v);
    }
  }
  return out.length > 1 ? out : [low, high];
}

function lineData(line, log) {
  const fits = (v, isLog) => Number.isFinite(v) && !(isLog && v <= 0);
  const order = line.x.map((_, i) => i).filter((i) => fits(line.x[i], log.x) && fits(line.y[i], log.y));
  order.sort((a, b) => line.x[a] - line.x[b]);
  // Joined tables have one value at one x: of points that share theirs the later one is moved by a hair.
  const x = [];
  for (const i of order) {
    const last = x.at(-1);
    x.push(last !== undefined && line.x[i] <= last ? last * (1 + 1e-9) + 1e-300 : line.x[i]);
  }
  return { table: [x, order.map((i) => line.y[i])], hints: order.map((i) => line.hints[i] ?? '') };
}

function nearestValue(values, index) {
  for (let d = 0; d < values.length; ++d) {
    for (const i of [index - d, index + d]) if (values[i] !== null && values[i] !== undefined) return i;
  }
  return index;
}

class Diagram {
  constructor(diagram) {
    this.diagram = diagram;
    this.body = el('div', { class: 'plot-body' });
    this.hint = el('p', { class: 'hint' }, ' ');
    this.root = el('figure', { class: 'card plot diagram' }, el('figcaption', {}, diagram.title),
      diagram.text ? el('p', { class: 'explain' }, diagram.text) : '', this.body, this.hint);
  }

  build() {
    this.plot?.destroy();
    this.body.replaceChildren();
    const { diagram } = this;
    const log = { x: diagram.logX, y: diagram.logY };
    const drawn = diagram.lines.map((line) => ({ line, ...lineData(line, log) })).filter((d) => d.table[0].length > 0);
    if (drawn.length === 0) {
      this.body.append(el('p', { class: 'empty' }, 'No values.'));
      return;
    }
    const data = drawn.length === 1 ? drawn[0].table : uPlot.join(drawn.map((d) => d.table));
    const hints = drawn.map((d) => new Map(d.table[0].map((x, i) => [x, d.hints[i]])));
    const axis = { stroke: css('--muted'), font: FONT, labelFont: FONT, labelSize: 18, labelGap: 0,
      ticks: { stroke: css('--grid'), width: 1, size: 4 }, grid: { stroke: css('--grid'), width: 1 } };
    const format = (_, values) => values.map((v) => (v === null ? '' : significant(v, 4)));
    const width = (_, values) => 14 + 6.6 * Math.max(1, ...(values ?? []).map((v) => (v ?? '').length));
    const ticks = (isLog) => (isLog ? { splits: (_, i, low, high) => logTicks(low, high), filter: (_, values) => values } : {});
    const scale = (isLog, pick) => {
      const range = paddedRange(drawn.flatMap(pick), isLog);
      return { time: false, distr: isLog ? 3 : 1, range: () => range };
    };
    this.plot = new uPlot({
      width: Math.max(260, this.body.clientWidth), height: HEIGHT,
      scales: { x: scale(log.x, (d) => d.table[0]), y: scale(log.y, (d) => d.table[1]) },
      padding: [10, 14, 0, 0],
      cursor: { points: { size: 8 }, drag: { x: false, y: false }, focus: { prox: 24 } },
      legend: { live: false },
      focus: { alpha: 0.25 },
      axes: [
        { ...axis, ...ticks(log.x), label: diagram.x, size: 32, values: format },
        { ...axis, ...ticks(log.y), label: diagram.y, size: width, values: format },
      ],
      series: [{}, ...drawn.map(({ line }) => ({
        label: line.name,
        stroke: line.front ? css('--front') : line.dashed ? css('--muted') : colorOf(line.name),
        width: line.front ? 9 : 1.75,
        dash: line.dashed ? [5, 5] : undefined,
        spanGaps: true,
        paths: line.steps ? uPlot.paths.stepped({ align: 1 }) : undefined,
        points: { show: !line.front && !line.dashed && !line.steps, size: 6 },
      }))],
      hooks: {
        setSeries: [(u, index) => { this.focused = index; this.point(u, hints); }],
        setCursor: [(u) => this.point(u, hints)],
      },
    }, data, this.body);
  }

  /** The point under the cursor in words. */
  point(u, hints) {
    const { idx } = u.cursor;
    const s = this.focused;
    let text = '';
    if (idx !== null && idx !== undefined && s > 0) {
      // The line need not have a point at the place that is nearest of all lines.
      const at = nearestValue(u.data[s] ?? [], idx);
      const x = u.data[0][at], y = u.data[s]?.[at];
      if (y !== null && y !== undefined) {
        const hint = hints[s - 1].get(x);
        text = `${u.series[s].label}${hint ? `, ${hint}` : ''}: ${significant(x, 4)}, ${significant(y, 4)}`;
      }
    }
    this.hint.textContent = text || ' ';
  }

  resize() {
    if (this.plot && this.body.clientWidth > 0 && this.body.clientWidth !== this.plot.width) this.plot.setSize({ width: this.body.clientWidth, height: HEIGHT });
  }
}

function bars({ title, unit, bars: rows }) {
  const names = [...new Set(rows.flatMap((r) => r.parts.map(([name]) => name)))];
  const total = (r) => r.parts.reduce((sum, [, v]) => sum + Math.max(0, v), 0);
  const widest = Math.max(...rows.map(total), Number.MIN_VALUE);
  const key = names.length > 1 ? el('p', { class: 'key' }, ...names.map((name) => el('span', {}, el('i', { style: `background:${colorOf(name)}` }), name))) : '';
  return el('figure', { class: 'card plot diagram' }, el('figcaption', {}, title), key, el('div', { class: 'bars' }, ...rows.flatMap((row) => [
    el('span', { class: 'bar-name' }, row.name),
    el('span', { class: 'bar-track' }, ...row.parts.filter(([, v]) => v > 0).map(([name, v]) => el('i', {
      style: `width:${(100 * v) / widest}%;background:${colorOf(name)}`, title: `${name}: ${significant(v, 3)} ${unit}`,
    }))),
    el('span', { class: 'bar-value' }, `${significant(row.parts.reduce((sum, [, v]) => sum + v, 0), 3)} ${unit}`),
  ])));
}

function table({ title, head, rows, failed }) {
  const bad = new Set(failed);
  return el('div', { class: 'card sheet' }, title ? el('h3', {}, title) : '', el('div', { class: 'scroll' }, el('table', {},
    el('thead', {}, el('tr', {}, ...head.map((h) => el('th', {}, h)))),
    el('tbody', {}, ...rows.map((row, i) => el('tr', bad.has(i) ? { class: 'failed' } : {}, ...row.map((c) => el('td', c.length > 60 ? { class: 'long' } : {}, c))))))));
}

/**
 * For pictures: "#section=2" leaves only that section, "#section=2&figure=1" only its first diagram or bars, and
 * "&tables=0" no tables. All count from 1.
 */
function wantedSections(sections) {
  const options = new URLSearchParams(window.location.hash.slice(1));
  const wanted = Number(options.get('section')), figure = Number(options.get('figure'));
  if (!(wanted >= 1 && wanted <= sections.length)) return null;
  const section = { ...sections[wanted - 1] };
  if (figure >= 1) {
    const diagrams = section.diagrams.length;
    section.text = '';
    section.bars = section.bars.slice(Math.max(0, figure - 1 - diagrams), Math.max(0, figure - diagrams));
    section.diagrams = section.diagrams.slice(figure - 1, figure);
  }
  if (figure >= 1 || options.get('tables') === '0') section.tables = [];
  return [section];
}

/** One sentence for each option that is unknown or asks for what is not there. */
function problemsOf(sections) {
  const options = new URLSearchParams(window.location.hash.slice(1));
  const wanted = Number(options.get('section'));
  const section = sections[wanted - 1];
  const figures = section ? section.diagrams.length + section.bars.length : 0;
  const upTo = (most) => (text) => /^\d+$/.test(text) && Number(text) >= 1 && Number(text) <= most;
  const known = {
    section: [upTo(sections.length), `a number from 1 to ${sections.length}`],
    figure: [upTo(figures), section ? `a number from 1 to ${figures} in section ${wanted}` : 'a section beside it'],
    tables: [(text) => text === '0' || text === '1', '0 or 1'],
    shot: [() => true, ''],
  };
  return [...options].flatMap(([key, value]) => {
    if (!(key in known)) return [`There is no option "${key}"; there are ${Object.keys(known).join(', ')}.`];
    return known[key][0](value) ? [] : [`${key}=${value}: ${key} wants ${known[key][1]}.`];
  });
}

function build(page) {
  window.isochorProblems = problemsOf(page.sections);
  page.notes = [...window.isochorProblems, ...page.notes];
  const only = wantedSections(page.sections);
  const diagrams = [];
  const make = (d) => {
    diagrams.push(new Diagram(d));
    return diagrams.at(-1).root;
  };
  const theme = el('button', { type: 'button' }, 'Light / dark');
  const section = (s) => el('section', {}, el('h2', {}, s.title), s.text ? el('p', { class: 'explain' }, s.text) : '',
    el('div', { class: 'grid' }, ...s.diagrams.map(make), ...s.bars.map(bars)), ...s.tables.map(table));
  const root = only ? el('div', { class: 'page charts' }) : el('div', { class: 'page charts' },
    el('header', {}, el('div', {}, el('h1', {}, page.title), el('p', { class: 'subtitle' }, page.subtitle)), theme),
    el('div', { class: 'notes' }, ...page.notes.map((n) => el('p', {}, n))),
    ...page.sections.map(section),
    el('section', {}, el('h2', {}, 'What was run'), table({ title: '', head: ['', ''], rows: page.run, failed: [] })),
    el('footer', {}, el('span', {}, page.footer)));
  if (only) root.append(...only.map(section));
  document.getElementById('app').append(root);
  diagrams.forEach((d) => d.build());
  theme.addEventListener('click', () => {
    document.documentElement.dataset.theme = dark() ? 'light' : 'dark';
    diagrams.forEach((d) => d.build());
  });
  new ResizeObserver(() => diagrams.forEach((d) => d.resize())).observe(root);
}

try {
  build(JSON.parse(document.getElementById('isochor-charts').textContent));
} catch (error) {
  window.isochorError = error.message;
  document.getElementById('app').append(el('p', { class: 'empty' }, `This page cannot be shown: ${error.message}`));
}
requestAnimationFrame(() => { window.isochorReady = true; });
