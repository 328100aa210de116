// A slider for every number of the scene that can be changed while it runs.
import { group } from '../display_panel.js';
import { el } from '../dom.js';
import { unitScale } from '../numbers.js';

const STEPS = 1000;
const HOLD = 500; // ms: for so long after a touch a slider is where the hand has put it, not where the server says

class DialRow {
  constructor(dial, index, viewer) {
    Object.assign(this, { dial, index, viewer });
    this.touched = -Infinity;
    const scale = unitScale(Math.max(Math.abs(dial.low), Math.abs(dial.high)) * (dial.log ? 0.02 : 1), dial.unit);
    // A power of ten instead of a prefix is for charts.
    this.factor = scale.unit.startsWith('×') ? 1 : scale.factor;
    this.unit = scale.unit.startsWith('×') ? dial.unit : scale.unit;
    const touch = (value) => this.set(value);
    this.slider = el('input', {
      type: 'range', min: 0, max: STEPS, step: 1, 'aria-label': dial.name, oninput: () => touch(this.valueAt(Number(this.slider.value) / STEPS)),
    });
    this.number = el('input', {
      type: 'number', step: 'any', 'aria-label': `${dial.name}, number`,
      onchange: () => { if (Number.isFinite(this.number.valueAsNumber)) touch(this.number.valueAsNumber / this.factor); },
    });
    this.node = el('div', { class: 'dial' }, el('span', { class: 'dial-name', title: dial.name }, dial.name), this.number,
      el('span', { class: 'unit' }, this.unit), this.slider);
  }

  valueAt(t) {
    const { low, high, log } = this.dial;
    // Both ends exactly: 0.5 is a Poisson's ratio, 0.4999999 is another.
    if (t <= 0) return low;
    if (t >= 1) return high;
    const value = log ? low * (high / low) ** t : low + t * (high - low);
    // Zero is where the slider passes it, not next to it.
    return !log && Math.abs(value) < (0.6 * (high - low)) / STEPS ? 0 : value;
  }

  placeOf(value) {
    const { low, high, log } = this.dial;
    const t = log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    return Math.round(STEPS * Math.min(1, Math.max(0, t)));
  }

  set(value) {
    const kept = Math.min(this.dial.high, Math.max(this.dial.low, value));
    this.touched = performance.now();
    this.show(kept, true);
    this.viewer.setDial(this.index, kept);
  }

  /** What the server says, unless the hand is on it. */
  update(value) {
    if (value === null || performance.now() - this.touched < HOLD) return;
    if (this.shown !== value) this.show(value, false);
  }

  show(value, touched) {
    this.shown = value;
    if (document.activeElement !== this.slider || !touched) this.slider.value = this.placeOf(value);
    if (document.activeElement !== this.number) this.number.value = Number((value * this.factor).toPrecision(4));
  }
}

/** Six sliders for each thing that can be put elsewhere would bury the rest. */
const folded = (title, nodes) => el('details', { class: 'folded' }, el('summary', {}, title), ...nodes);

export class Dials {
  constructor(viewer, host) {
    this.rows = viewer.run.head.dials.map((dial, index) => new DialRow(dial, index, viewer));
    const groups = new Map();
    for (const row of this.rows) {
      if (!groups.has(row.dial.group)) groups.set(row.dial.group, []);
      groups.get(row.dial.group).push(row.node);
    }
    const hand = groups.get('Hand');
    groups.delete('Hand');
    if (hand) groups.set('Hand', hand); // last: it is of the tool, not of the scene
    for (const [title, nodes] of groups) host.append(title.startsWith('Pose of ') ? folded(title, nodes) : group(title, ...nodes));
  }

  update(values) {
    this.rows.forEach((row, i) => row.update(values[i]));
  }

  enable(on) {
    for (const { slider, number } of this.rows) slider.disabled = number.disabled = !on;
  }
}
