// Numbers of the scene over time, as it goes on.
import uPlot from 'uplot';
import { el } from '../dom.js';
import { significant, unitScale } from '../numbers.js';
import { DARK, LIGHT } from '../plots.js';

const HEIGHT = 150;
const KEPT = 1500; // samples
const PAUSE = 120; // ms between drawings

export class ScrollPlots {
  constructor(run, host) {
    Object.assign(this, { run, host, times: [], samples: run.head.measures.map(() => []), drawn: -Infinity });
    this.observer = new ResizeObserver(() => this.charts.forEach(({ plot, body }) => {
      if (body.clientWidth > 0 && body.clientWidth !== plot.width) plot.setSize({ width: body.clientWidth, height: HEIGHT });
    }));
    this.build();
  }

  /** Measures of one group and unit share a chart. */
  groups() {
    const all = new Map();
    this.run.head.measures.forEach((m, index) => {
      const key = `${m.group} ${m.unit}`;
      if (!all.has(key)) all.set(key, { name: m.group, unit: m.unit, members: [] });
      all.get(key).members.push({ ...m, index });
    });
    return [...all.values()];
  }

  build() {
    this.charts?.forEach(({ plot }) => plot.destroy());
    this.observer.disconnect();
    this.host.replaceChildren();
    const css = getComputedStyle(document.documentElement);
    const color = (name) => css.getPropertyValue(name).trim();
    const palette = color('--dark') === '1' ? DARK : LIGHT;
    this.charts = this.groups().map(({ name, unit, members }) => {
      const body = el('div', { class: 'plot-body' });
      const unitText = el('span', { class: 'unit' });
      this.host.append(el('figure', { class: 'card plot' }, el('figcaption', {}, name, ' ', unitText), body));
      const chart = { body, unit, members, unitText };
      const font = '11px system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif';
      const axis = { stroke: color('--muted'), font, ticks: { stroke: color('--grid'), width: 1, size: 4 }, grid: { stroke: color('--grid'), width: 1 } };
      const format = (_, values) => values.map((v) => significant(v, 4));
      chart.plot = new uPlot({
        width: Math.max(200, body.clientWidth), height: HEIGHT, padding: [8, 12, 0, 0],
        scales: { x: { time: false }, y: { range: (_, low, high) => {
          const pad = high > low ? 0.08 * (high - low) : Math.abs(high) * 0.1 || 1;
          return [low - pad, high + pad];
        } } },
        cursor: { points: { size: 6 }, drag: { x: false, y: false } }, legend: { live: true },
        axes: [{ ...axis, size: 26, values: format }, { ...axis, size: 52, values: format }],
        series: [{}, ...members.map((m, i) => ({
          label: m.name, stroke: palette[i % palette.length], width: 1.75, points: { show: false },
          value: (_, v) => (v === null || v === undefined ? '–' : significant(v, 4)),
        }))],
      }, [[], ...members.map(() => [])], body);
      this.observer.observe(body);
      return chart;
    });
    this.draw();
  }

  add(time, values) {
    const last = this.times.at(-1);
    if (time < last) this.clear();
    if (time === last) return;
    this.times.push(time);
    this.samples.forEach((s, i) => s.push(values[i]));
    if (this.times.length > KEPT) {
      const half = KEPT / 2;
      this.times.splice(0, half);
      this.samples.forEach((s) => s.splice(0, half));
    }
    if (performance.now() - this.drawn > PAUSE) this.draw();
  }

  clear() {
    this.times.length = 0;
    this.samples.forEach((s) => { s.length = 0; });
  }

  draw() {
    this.drawn = performance.now();
    for (const { plot, unit, members, unitText, body } of this.charts) {
      const { top, bottom } = body.getBoundingClientRect();
      if (bottom < 0 || top > window.innerHeight) continue; // what nobody sees costs nothing
      const lists = members.map((m) => this.samples[m.index]);
      const most = lists.reduce((m, list) => list.reduce((n, v) => Math.max(n, Math.abs(v ?? 0)), m), 0);
      const scale = unitScale(most, unit);
      if (unitText.textContent !== scale.unit) unitText.textContent = scale.unit;
      plot.setData([[...this.times], ...lists.map((list) => list.map((v) => (v === null ? null : v * scale.factor)))]);
    }
  }
}
