// The panel beside the view, the transport below it, and the keyboard.
import { el } from './dom.js';
import { choice, icon, toggle } from './layout.js';
import { VIEW_NAMES } from './stage.js';

export class Controls {
  constructor(viewer) {
    this.viewer = viewer;
    this.buildTransport();
    this.buildPanel();
    document.addEventListener('keydown', (event) => this.key(event));
  }

  buildTransport() {
    const { viewer } = this;
    const { frames } = viewer.run.head;
    this.playButton = el('button', { type: 'button', class: 'play', title: 'Play or pause (space)', onclick: () => viewer.play(!viewer.state.playing) });
    const step = (name, title, by) => el('button', { type: 'button', title, 'aria-label': title, onclick: () => { viewer.play(false); viewer.go(viewer.state.frame + by); } }, icon(name));
    this.slider = el('input', {
      type: 'range', min: 0, max: Math.max(0, frames.length - 1), step: 1, 'aria-label': 'Frame',
      oninput: () => { viewer.play(false); viewer.go(Number(this.slider.value)); },
    });
    this.counter = el('output', { class: 'counter' });
    const speed = el('select', { 'aria-label': 'Playback speed', onchange: () => { viewer.state.speed = Number(speed.value); if (viewer.state.playing) viewer.play(true); } },
      ...[[0.25, '¼×'], [0.5, '½×'], [1, '1×'], [2, '2×'], [4, '4×']].map(([v, text]) => el('option', { value: v, selected: v === 1 }, text)));
    viewer.page.transport.append(this.playButton, step('back', 'Previous frame', -1), step('next', 'Next frame', 1), this.slider, this.counter, speed);
    viewer.page.transport.hidden = frames.length < 2;
    this.playingChanged();
  }

  playingChanged() {
    const { playing } = this.viewer.state;
    this.playButton.replaceChildren(icon(playing ? 'pause' : 'play'));
    this.playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
  }

  frameShown() {
    const { state, run } = this.viewer;
    if (state.frame < 0) return;
    this.slider.value = state.frame;
    this.counter.textContent = `${state.frame + 1} / ${run.frameCount}`;
    this.slider.setAttribute('aria-valuetext', `frame ${state.frame + 1} of ${run.frameCount}, ${this.viewer.page.stamp.textContent}`);
    if (state.rangeMode === 'frame') this.showRange();
  }

  buildPanel() {
    const { viewer } = this;
    const { state, run, page } = viewer;
    const select = el('select', { id: 'field', onchange: () => { state.field = viewer.fields[Number(select.value)]; state.custom = null; if (state.rangeMode === 'custom') { state.rangeMode = 'run'; this.rangeChoice.set('run'); } viewer.showField(); this.showRange(); } },
      ...viewer.fields.map((f, i) => el('option', { value: i, selected: f === state.field }, f.label || f.name)));
    this.fieldSelect = select;
    this.rangeChoice = choice('Color range', [['run', 'All frames'], ['frame', 'This frame'], ['custom', 'Custom']], state.rangeMode, (mode) => {
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
    this.full = toggle('Full range', '', state.full, (on) => { state.full = on; viewer.showField(); this.showRange(); });
    this.full.node.title = 'Off: colors span the values from 1 % to 99 % of the points, so that no hot spot sets them';
    this.rangeBox = el('div', { class: 'row bounds' }, this.bounds[0], el('span', {}, 'to'), this.bounds[1], this.boundsUnit);

    this.edges = toggle('Mesh edges', 'E', state.edges, (on) => { state.edges = on; viewer.showDisplay(); });
    this.ghost = toggle('Rest shape', 'G', state.ghost, (on) => { state.ghost = on; viewer.showDisplay(); });

    this.cutChoice = choice('Cut plane', [[null, 'Off'], ['x', 'x'], ['y', 'y'], ['z', 'z']], state.cut.axis, (axis) => this.setCut(axis));
    this.cutSlider = el('input', { type: 'range', min: 0, max: 1, step: 0.002, value: state.cut.at, 'aria-label': 'Position of the cut', oninput: () => { state.cut.at = viewer.cutPlaces[state.cut.axis] = Number(this.cutSlider.value); this.cutChanged(); } });
    this.cutText = el('output', { class: 'counter' });
    this.cutFlip = el('button', { type: 'button', class: 'quiet', title: 'Keep the other half (F)', onclick: () => { state.cut.flip = !state.cut.flip; this.cutChanged(); } }, 'Flip');
    this.cutBox = el('div', { class: 'row' }, this.cutSlider, this.cutText, this.cutFlip);

    const views = el('div', { class: 'choice wrap', role: 'group', 'aria-label': 'Camera' },
      ...VIEW_NAMES.map((name) => el('button', { type: 'button', onclick: () => viewer.stage?.look(name) }, name)));
    const help = el('details', { class: 'help' }, el('summary', {}, 'Keyboard'), el('dl', {},
      ...[['Space', 'play or pause'], ['← →', 'previous, next frame'], ['Home End', 'first, last frame'], ['C', 'next field'], ['E, G', 'edges, rest shape'],
        ['X, Y, Z', 'cut plane on or off'], ['F', 'keep the other half'], ['R', 'reset the camera'], ['Shift + arrows', 'turn'], ['+ −', 'zoom']]
        .flatMap(([key, what]) => [el('dt', {}, el('kbd', {}, key)), el('dd', {}, what)])));
    const group = (title, ...nodes) => el('fieldset', {}, el('legend', {}, title), ...nodes);
    page.controls.append(
      group('Color', select, this.rangeChoice.node, this.rangeBox, this.full.node),
      group('Show', this.edges.node, this.ghost.node),
      group('Cut', this.cutChoice.node, this.cutBox),
      group('Camera', views),
      help);
    page.controls.hidden = !viewer.stage;
    this.rangeBox.hidden = run.frameCount === 0;
    this.showRange();
    this.cutChanged();
  }

  showRange() {
    const { viewer } = this;
    const range = viewer.currentRange();
    const ordered = range !== null && viewer.state.field.categories.length === 0;
    this.rangeBox.hidden = !ordered;
    this.rangeChoice.node.hidden = !ordered;
    this.full.node.hidden = !ordered;
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
    const on = viewer.state.cut.axis !== null;
    this.cutBox.hidden = !on;
    if (on) this.cutText.textContent = viewer.cutText();
    viewer.showDisplay();
  }

  key(event) {
    const { viewer } = this;
    const typing = event.target instanceof HTMLElement && (event.target.matches('select, input[type=number]'));
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const onSlider = event.target instanceof HTMLElement && event.target.matches('input[type=range]');
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (arrow && event.shiftKey) { viewer.stage?.turn(8 * arrow[0], 8 * arrow[1]); event.preventDefault(); return; }
    if (arrow && arrow[0] !== 0 && !onSlider) { viewer.play(false); viewer.go(viewer.state.frame + arrow[0]); event.preventDefault(); return; }
    if (event.key === ' ') {
      // Space on a button presses that button.
      if (event.target instanceof HTMLElement && event.target.matches('button, input[type=checkbox], summary')) return;
      viewer.play(!viewer.state.playing);
      event.preventDefault();
      return;
    }
    const flip = (control) => { control.input.checked = !control.input.checked; control.input.dispatchEvent(new Event('change')); };
    const actions = {
      Home: () => onSlider || viewer.go(0),
      End: () => onSlider || viewer.go(viewer.run.frameCount - 1),
      e: () => flip(this.edges),
      g: () => flip(this.ghost),
      x: () => this.setCut('x'),
      y: () => this.setCut('y'),
      z: () => this.setCut('z'),
      f: () => this.cutFlip.click(),
      r: () => viewer.stage?.look('iso'),
      c: () => {
        this.fieldSelect.value = String((Number(this.fieldSelect.value) + 1) % viewer.fields.length);
        this.fieldSelect.dispatchEvent(new Event('change'));
      },
      '+': () => viewer.stage?.dolly(0.85),
      '=': () => viewer.stage?.dolly(0.85),
      '-': () => viewer.stage?.dolly(1 / 0.85),
    };
    actions[event.key]?.();
  }
}
