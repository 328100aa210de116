// Time series, a chart a group (two units at most), with a marker at the time of the frame shown.
import uPlot from 'uplot';
import { el } from './dom.js';
import { significant, unitScale } from './numbers.js';

export const LIGHT = ['#1f6fb5', '#d1571b', '#2a8a57', '#a4388f', '#8a6d00', '#5b55c9', '#c22f4b', '#45707f'];
export const DARK = ['#6db3f2', '#f59a62', '#6ccb97', '#e08bd0', '#dcc04f', '#a9a4ff', '#f5839a', '#93bccb'];
const HEIGHT = 210;

/** Series of one group, cut into charts of at most two units each. */
function charts(series) {
  const groups = new Map();
  for (const s of series) {
    if (!groups.has(s.group)) groups.set(s.group, []);
    groups.get(s.group).push(s);
  }
  const out = [];
  for (const [name, members] of groups) {
    const units = [...new Set(members.map((s) => s.unit))];
    for (let i = 0; i < units.length; i += 2) {
      const pair = units.slice(i, i + 2);
      out.push({ name, units: pair, series: members.filter((s) => pair.includes(s.unit)) });
    }
  }
  return out;
}

/** The scale of a unit in the values of a chart. */
function scaleOfValues(series, unit) {
  const values = series.filter((s) => s.unit === unit).flatMap((s) => s.y).filter(Number.isFinite);
  return { values, ...unitScale(values.reduce((m, v) => Math.max(m, Math.abs(v)), 0), unit) };
}

/** How the first chart that has this unit shows it; null where none has. */
export function chartScale(series, unit) {
  const chart = charts(series).find((c) => c.units.includes(unit) && !c.series.every((s) => s.log));
  const scale = chart && scaleOfValues(chart.series, unit);
  return scale && scale.values.some((v) => v !== 0) ? scale : null;
}

/** Lines of a logarithmic axis at powers of ten: those between would be a gray band. */
const decades = (lines) => ({
  ...lines,
  filter: (_, splits) => splits.map((v) => (v > 0 && Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-6 ? v : null)),
});

const finiteOrNull = (v) => (Number.isFinite(v) ? v : null);

export class Plots {
  constructor(run, host, onPick) {
    this.run = run;
    this.host = host;
    this.onPick = onPick;
    this.time = run.head.frames[0]?.time ?? null;
    this.plots = [];
    this.waiting = new Map();
    this.readTime = -Infinity;
    this.observer = new ResizeObserver(() => this.resize());
    // A chart is drawn when it comes near the window: those below it cost nothing while the page opens.
    this.near = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) if (isIntersecting) this.draw(target);
    }, { rootMargin: '40px' });
    this.build();
  }

  build() {
    this.plots.forEach((p) => p.plot.destroy());
    this.observer.disconnect();
    this.near.disconnect();
    this.plots = [];
    this.waiting.clear();
    this.host.replaceChildren();
    const css = getComputedStyle(document.documentElement);
    const color = (name) => css.getPropertyValue(name).trim();
    this.theme = { text: color('--muted'), grid: color('--grid'), palette: color('--dark') === '1' ? DARK : LIGHT };
    for (const chart of charts(this.run.head.series)) {
      const body = el('div', { class: 'plot-body' });
      const card = el('figure', { class: 'card plot' }, el('figcaption', {}, chart.name), body);
      this.host.append(card);
      const drawn = chart.series.filter((s) => s.x.length > 0 && s.y.some(Number.isFinite));
      const missing = chart.series.filter((s) => !drawn.includes(s)).map((s) => s.name).join(', ');
      if (drawn.length > 0) {
        this.waiting.set(body, { ...chart, series: drawn });
        body.style.minHeight = `${HEIGHT + 30}px`; // so that nothing moves when it is drawn
        this.near.observe(body);
      }
      if (missing) body.append(el('p', { class: 'empty' }, `No finite value: ${missing}`));
    }
    this.host.hidden = this.run.head.series.length === 0;
  }

  draw(body) {
    const chart = this.waiting.get(body);
    if (!chart) return;
    this.waiting.delete(body);
    this.near.unobserve(body);
    body.style.minHeight = '';
    const plot = this.plot(chart, body);
    this.plots.push({ body, plot });
    this.observer.observe(body);
    if (this.time !== null) this.readAt(plot);
  }

  /** For pictures of the whole page. */
  drawAll() {
    for (const body of [...this.waiting.keys()]) this.draw(body);
  }

  plot(chart, body) {
    const { theme } = this;
    const log = chart.series.every((s) => s.log);
    const scaleOf = new Map(chart.units.map((unit, i) => {
      const { values, ...shown } = scaleOfValues(chart.series, unit);
      const magnitude = values.reduce((m, v) => Math.max(m, Math.abs(v)), 0);
      // Rounding noise around zero is read as zero, except where a logarithmic axis is about just that.
      const settle = log ? (v) => v : (v) => (Math.abs(v) < 1e-12 * magnitude * scale.factor ? 0 : v);
      const scale = log ? { factor: 1, unit } : shown;
      return [unit, { key: `y${i}`, values, settle, ...scale }];
    }));
    const tables = chart.series.map((s) => {
      const { factor } = scaleOf.get(s.unit);
      const y = s.y.slice(0, s.x.length).map((v) => (Number.isFinite(v) && !(log && v <= 0) ? v * factor : null));
      // Series need not share their times; sorted, because joining expects it.
      const order = s.x.map((_, i) => i).filter((i) => finiteOrNull(s.x[i]) !== null && i < y.length).sort((a, b) => s.x[a] - s.x[b]);
      return [order.map((i) => s.x[i]), order.map((i) => y[i])];
    });
    const data = tables.length === 1 ? tables[0] : uPlot.join(tables);
    const font = '11px system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif';
    const axis = { stroke: theme.text, font, labelFont: font, labelSize: 16, labelGap: 0, ticks: { stroke: theme.grid, width: 1, size: 4 }, grid: { stroke: theme.grid, width: 1 } };
    const width = (_, values) => 12 + 6.6 * Math.max(1, ...(values ?? []).map((v) => (v ?? '').length));
    const format = (_, values) => values.map((v) => (v === null ? '' : significant(v, 5)));
    const { x } = this.run.head;
    const used = chart.units.filter((unit) => scaleOf.get(unit).values.length > 0);
    // A single point stands in the middle of a short axis.
    const single = data[0].length === 1 ? [data[0][0] - 0.5, data[0][0] + 0.5] : null;
    const scales = { x: { time: false, range: (_, low, high) => single ?? [low, high] } };
    for (const unit of used) {
      scales[scaleOf.get(unit).key] = log ? { distr: 3 } : {
        range: (_, low, high) => {
          // A constant is a line in the middle, not noise blown up to full height.
          const pad = high > low ? 0.08 * (high - low) : Math.abs(high) * 0.1 || 1;
          return [low >= 0 && low - pad < 0 ? 0 : low - pad, high + pad];
        },
      };
    }
    return new uPlot({
      width: Math.max(200, body.clientWidth), height: HEIGHT,
      scales,
      padding: [8, used.length > 1 ? 0 : 12, 0, 0],
      cursor: { points: { size: 6 }, drag: { x: true, y: false } },
      legend: { live: true },
      axes: [
        { ...axis, label: x.unit ? `${x.label} [${x.unit}]` : x.label, size: 30, values: format },
        ...used.map((unit, i) => {
          const s = scaleOf.get(unit);
          const names = chart.series.filter((m) => m.unit === unit);
          const label = names.length === 1 ? names[0].name : '';
          return {
            ...axis, scale: s.key, ...(log ? { ticks: decades(axis.ticks), grid: decades(axis.grid) } : {}), side: i === 0 ? 3 : 1, size: width, values: format, labelSize: 18,
            label: [label, s.unit ? `[${s.unit}]` : ''].filter(Boolean).join(' ') || undefined,
            ...(i === 0 ? {} : { grid: { show: false } }),
          };
        }),
      ],
      series: [
        { label: x.label, value: (_, v) => (v === null || v === undefined ? '–' : significant(v, 4)) },
        ...chart.series.map((s, i) => {
          const at = scaleOf.get(s.unit);
          return {
            label: s.name, scale: at.key, stroke: theme.palette[i % theme.palette.length], width: 1.75, spanGaps: tables.length > 1,
            points: { show: s.x.length < 2 },
            value: (_, v) => (v === null || v === undefined ? '–' : `${significant(at.settle(v), 4)}${at.unit ? ` ${at.unit}` : ''}`),
          };
        }),
      ],
      hooks: {
        draw: [(u) => this.placeMarker(u)],
        setCursor: [(u) => { if (u.cursor.left < 0) this.readAt(u); }],
        ready: [(u) => {
          u.marker = el('div', { class: 'marker' });
          u.over.append(u.marker);
          this.placeMarker(u);
          u.over.addEventListener('click', () => {
            if (u.cursor.left >= 0) this.onPick(u.posToVal(u.cursor.left, 'x'));
          });
        }],
      },
    }, data, body);
  }

  /** The vertical line at the time of the frame: an element, so that playing draws no chart again. */
  placeMarker(u) {
    if (!u.marker) return;
    const x = this.time === null ? NaN : u.valToPos(this.time, 'x');
    const inside = x >= -1 && x <= u.bbox.width / uPlot.pxRatio + 1;
    u.marker.hidden = !inside;
    if (inside) u.marker.style.transform = `translateX(${Math.round(x)}px)`;
  }

  /** Values at the time shown stand in the key while nobody points at the chart. */
  readAt(u) {
    const x = u.data[0];
    if (this.time === null || x.length === 0) return;
    let best = 0;
    for (let i = 1; i < x.length; ++i) if (Math.abs(x[i] - this.time) < Math.abs(x[best] - this.time)) best = i;
    u.setLegend({ idx: best });
  }

  /** While playing, the numbers in the keys change a few times a second: faster than that nobody reads. */
  setTime(time, playing = false) {
    this.time = time;
    const now = performance.now();
    const read = !playing || now - this.readTime > 250;
    if (read) this.readTime = now;
    for (const { plot } of this.plots) {
      this.placeMarker(plot);
      if (read) this.readAt(plot);
    }
  }

  resize() {
    for (const { plot, body } of this.plots) {
      if (body.clientWidth > 0 && body.clientWidth !== plot.width) plot.setSize({ width: body.clientWidth, height: HEIGHT });
    }
  }
}
