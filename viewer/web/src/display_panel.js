// The panel of what is shown: color, edges, cut, camera; and its keys.
import { el } from './dom.js';
import { choice, toggle } from './layout.js';
import { VIEW_NAMES } from './stage.js';

export const group = (title, ...nodes) => el('fieldset', {}, el('legend', {}, title), ...nodes);

/** The keys of a page, for those who ask. */
export const helpOn = (keys) => el('details', { class: 'help' }, el('summary', {}, 'Keyboard'), el('dl', {},
  ...keys.flatMap(([key, what]) => [el('dt', {}, el('kbd', {}, key)), el('dd', {}, what)])));

export const DISPLAY_KEYS = [['C', 'next field'], ['E, G', 'edges, rest shape'], ['X, Y, Z', 'cut plane on or off'], ['F', 'keep the other half'],
  ['V', 'cut across the view'], ['A', 'arrows of contact forces'], ['R', 'reset the camera'], ['Shift + arrows', 'turn'], ['+ −', 'zoom']];

export class DisplayPanel {
  constructor(viewer) {
    this.viewer = viewer;
  }

  /** ranges: what colors may span, as choice() takes them. */
  groups(ranges) {
    const { viewer } = this;
    const { state } = viewer;
    const select = el('select', { id: 'field', onchange: () => this.chooseField(viewer.fields[Number(select.value)]) },
      ...viewer.fields.map((f, i) => el('option', { value: i, selected: f === state.field }, f.label || f.name)));
    this.fieldSelect = select;
    this.rangeChoice = choice('Color range', ranges, state.rangeMode, (mode) => {
      state.custom ??= viewer.currentRange();
      state.rangeMode = mode;
      viewer.showField();
      this.showRange();
    });
    const number = (label, k) => el('input', {
      type: 'number', step: 'any', 'aria-label': label,
      onchange: (event) => {
        const range = [...(viewer.currentRange() ?? [0, 1])];
        range[k] = event.target.valueAsNumber;
        if (!range.every(Number.isFinite) || !(range[1] > range[0])) { this.showRange(); return; }
        state.custom = range;
        state.rangeMode = 'custom';
        this.rangeChoice.set('custom');
        viewer.showField();
      },
    });
    this.bounds = [number('Lowest color', 0), number('Highest color', 1)];
    this.boundsUnit = el('span', { class: 'unit' });
    this.shares = choice('Values that colors span', [[1, 'all'], [0.98, '98 %'], [0.9, '90 %']], viewer.share, (share) => { state.share = share; viewer.showField(); this.showRange(); });
    this.shares.node.title = 'Of the points: with less than all of them no hot spot sets the colors';
    this.rangeBox = el('div', { class: 'row bounds' }, this.bounds[0], el('span', {}, 'to'), this.bounds[1], this.boundsUnit);

    this.edges = toggle('Mesh edges', 'E', state.edges, (on) => { state.edges = on; viewer.showDisplay(); });
    this.ghost = toggle('Rest shape', 'G', state.ghost, (on) => { state.ghost = on; viewer.showDisplay(); });

    this.cutChoice = choice('Cut plane', [[null, 'Off'], ['x', 'x'], ['y', 'y'], ['z', 'z'], ['free', 'Any']], state.cut.axis, (axis) => this.setCut(axis));
    this.cutSlider = el('input', { type: 'range', min: 0, max: 1, step: 0.002, value: state.cut.at, 'aria-label': 'Position of the cut', oninput: () => { state.cut.at = viewer.cutPlaces[state.cut.axis] = Number(this.cutSlider.value); this.cutChanged(); } });
    this.cutText = el('output', { class: 'counter' });
    this.cutFlip = el('button', { type: 'button', class: 'quiet', title: 'Keep the other half (F)', onclick: () => { state.cut.flip = !state.cut.flip; this.cutChanged(); } }, 'Flip');
    this.cutBox = el('div', { class: 'row' }, this.cutSlider, this.cutText, this.cutFlip);
    this.buildAngles();

    const views = el('div', { class: 'choice wrap', role: 'group', 'aria-label': 'Camera' },
      ...VIEW_NAMES.map((name) => el('button', { type: 'button', onclick: () => viewer.stage?.look(name) }, name)));
    return [
      group('Color', select, this.rangeChoice.node, this.rangeBox, this.shares.node),
      group('Show', this.edges.node, this.ghost.node, ...this.arrowToggles()),
      ...this.partsGroup(),
      group('Cut', this.cutChoice.node, this.cutBox, this.angles),
      group('Camera', views),
    ];
  }

  async chooseField(field) {
    const { viewer, viewer: { state } } = this;
    state.field = field;
    state.custom = null;
    if (state.rangeMode === 'custom') { state.rangeMode = 'run'; this.rangeChoice.set('run'); }
    await viewer.run.prepare?.(field);
    if (state.field !== field) return;
    viewer.showField();
    this.showRange();
  }

  /** Around and up: where the plane faces. */
  buildAngles() {
    const { viewer, viewer: { state: { cut } } } = this;
    this.angleRows = [['azimuth', 'around', -180, 180], ['elevation', 'up', -90, 90]].map(([name, text, min, max]) => {
      const output = el('output', {});
      const slider = el('input', { type: 'range', min, max, step: 1, 'aria-label': `Cut, ${text}`, oninput: () => { cut[name] = Number(slider.value); this.cutChanged(); } });
      return { name, slider, output, node: el('label', { class: 'angle' }, el('span', {}, text), slider, output) };
    });
    const face = el('button', { type: 'button', class: 'quiet', title: 'Across the line of sight (V)', onclick: () => this.faceCut() }, 'Across the view');
    this.angles = el('div', {}, ...this.angleRows.map((row) => row.node), face);
  }

  faceCut() {
    const { viewer, viewer: { state: { cut } } } = this;
    if (!viewer.stage) return;
    const fresh = cut.axis === null;
    viewer.faceCut();
    if (fresh) cut.at = 0.5;
    this.cutSlider.value = cut.at;
    this.cutChoice.set('free');
    this.cutChanged();
  }

  arrowToggles() {
    const { viewer, viewer: { state, run } } = this;
    const one = (name, text, key) => toggle(text, key, state.arrows[name], (on) => { state.arrows[name] = on; viewer.arrowsChanged?.(); viewer.showDisplay(); });
    this.forces = run.hasForces ? one('forces', 'Contact forces', 'A') : null;
    this.fibers = run.hasFibers ? one('fibers', 'Fibers', '') : null;
    return [this.forces, this.fibers].filter(Boolean).map((t) => t.node);
  }

  /** Where there is more than one part each may be shown, faded or hidden. */
  partsGroup() {
    const { viewer, viewer: { state, run: { head: { parts } } } } = this;
    if (parts.length < 2) return [];
    this.lookChoices = parts.map((part, p) => choice(`How ${part.name || `part ${p + 1}`} is shown`, [['shown', 'show'], ['faded', 'fade'], ['hidden', 'hide']], state.looks[p], (look) => {
      state.looks[p] = look;
      viewer.showDisplay();
    }));
    return [group('Bodies', el('ul', { class: 'parts' }, ...parts.map((part, p) => el('li', {},
      el('span', { class: 'name', title: part.name }, part.name || `part ${p + 1}`), this.lookChoices[p].node))))];
  }

  showRange() {
    const { viewer } = this;
    const range = viewer.currentRange();
    const ordered = range !== null && viewer.state.field.categories.length === 0;
    this.rangeBox.hidden = !ordered;
    this.rangeChoice.node.hidden = !ordered;
    this.shares.node.hidden = !ordered || viewer.state.rangeMode === 'custom';
    this.shares.set(viewer.share);
    if (!ordered) return;
    // Plain numbers in the unit of the run: they are meant to be edited.
    // To a thousandth of the range, however far from zero it lies (J is always near one).
    const place = 10 ** Math.floor(Math.log10((range[1] - range[0]) / 1000) + 1e-9);
    this.bounds.forEach((input, k) => { input.value = Number((Math.round(range[k] / place) * place).toPrecision(10)); });
    this.boundsUnit.textContent = viewer.state.field.unit;
  }

  setCut(axis) {
    const { cut } = this.viewer.state;
    cut.axis = cut.axis === axis ? null : axis;
    cut.flip = null;
    if (cut.axis) cut.at = this.cutSlider.value = this.viewer.cutPlaces[cut.axis];
    this.viewer.openCut();
    this.cutChoice.set(cut.axis);
    this.cutChanged();
  }

  cutChanged() {
    const { viewer } = this;
    const { cut } = viewer.state;
    const on = cut.axis !== null;
    this.cutBox.hidden = !on;
    this.angles.hidden = cut.axis !== 'free';
    for (const { name, slider, output } of this.angleRows) {
      slider.value = cut[name];
      output.textContent = `${Math.round(cut[name])}°`.replace('-', '\u2212');
    }
    if (on) this.cutText.textContent = viewer.cutText();
    viewer.showDisplay();
  }

  /** Whether the key is one of these. */
  displayKey(event) {
    const { viewer } = this;
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (arrow && event.shiftKey) {
      viewer.stage?.turn(8 * arrow[0], 8 * arrow[1]);
      event.preventDefault();
      return true;
    }
    const flip = (control) => { control.input.checked = !control.input.checked; control.input.dispatchEvent(new Event('change')); };
    const actions = {
      e: () => flip(this.edges),
      g: () => flip(this.ghost),
      x: () => this.setCut('x'),
      y: () => this.setCut('y'),
      z: () => this.setCut('z'),
      f: () => this.cutFlip.click(),
      v: () => this.faceCut(),
      a: () => this.forces && flip(this.forces),
      r: () => viewer.stage?.look('iso'),
      c: () => {
        this.fieldSelect.value = String((Number(this.fieldSelect.value) + 1) % viewer.fields.length);
        this.fieldSelect.dispatchEvent(new Event('change'));
      },
      '+': () => viewer.stage?.dolly(0.85),
      '=': () => viewer.stage?.dolly(0.85),
      '-': () => viewer.stage?.dolly(1 / 0.85),
    };
    const action = actions[event.key];
    action?.();
    return action !== undefined;
  }
}

/** Whether somebody types or chooses there, and whether on a slider. */
export const isTyping = (event) => (event.target instanceof HTMLElement && event.target.matches('select, input[type=number]'))
  || event.ctrlKey || event.metaKey || event.altKey;
export const isOnSlider = (event) => event.target instanceof HTMLElement && event.target.matches('input[type=range]');
/** Space on a button presses that button. */
export const isOnButton = (event) => event.target instanceof HTMLElement && event.target.matches('button, input[type=checkbox], summary');
