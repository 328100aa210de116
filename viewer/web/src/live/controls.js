// What a live page is driven by: the row below the picture, the panels beside it, and the keyboard.
import { DISPLAY_KEYS, DisplayPanel, group, helpOn, isOnButton, isTyping } from '../display_panel.js';
import { el } from '../dom.js';
import { choice, icon } from '../layout.js';
import { significant } from '../numbers.js';
import { Dials } from './dials.js';
import { TOOLS } from './hand.js';
import { videoType } from '../video.js';

const SPEEDS = [[0.1, '0.1 ×'], [0.25, '¼ ×'], [0.5, '½ ×'], [1, 'real time'], [2, '2 ×'], [1000, 'as fast as it can']];

export class LiveControls extends DisplayPanel {
  constructor(viewer) {
    super(viewer);
    this.buildTransport();
    this.buildPanels();
    document.addEventListener('keydown', (event) => this.key(event));
  }

  buildTransport() {
    const { viewer } = this;
    const button = (content, title, action, className = '') => el('button', { type: 'button', title, 'aria-label': title, class: className, onclick: action }, content);
    this.playButton = button(icon('play'), 'Play or pause (space)', () => this.playOrPause(), 'play');
    this.stepButton = button(icon('next'), 'One step (.)', () => viewer.send({ do: 'step' }));
    this.resetButton = button(icon('reset'), 'Back to the beginning (Backspace)', () => viewer.send({ do: 'reset' }));
    this.pace = el('output', { class: 'pace' });
    this.speed = el('select', { 'aria-label': 'Speed, at most', title: 'Speed, at most', onchange: () => viewer.send({ do: 'speed', value: Number(this.speed.value) }) },
      ...SPEEDS.map(([v, text]) => el('option', { value: v, selected: v === 1 }, text)));
    this.recordButton = button('Record', 'Write the outputs of isochor run from here on', () => viewer.send({ do: viewer.frame?.info.recorded === null ? 'record' : 'stop_recording' }), 'record');
    this.recordButton.hidden = !viewer.run.head.records;
    this.filmButton = button('Video', 'A film of the picture from here on (WebM)', () => viewer.film(), 'film');
    this.filmButton.hidden = !viewer.stage || videoType() === null;
    this.driven = [this.playButton, this.stepButton, this.resetButton, this.speed, this.recordButton];
    viewer.page.transport.append(this.playButton, this.stepButton, this.resetButton, this.pace, this.speed, this.recordButton,
      button('PNG', 'The picture as a file (P)', () => viewer.savePicture(viewer.pictureName)), this.filmButton, button('Link', 'Copy an address that shows this view (L)', () => viewer.copyLink()));
  }

  buildPanels() {
    const { viewer } = this;
    const { page } = viewer;
    this.tools = choice('What dragging does', TOOLS.map(([name, text]) => [name, text]), 'pull', (name) => { if (viewer.hand) viewer.hand.tool = name; });
    this.tools.node.classList.add('tools');
    [...this.tools.node.children].forEach((node, i) => { node.title = `${TOOLS[i][2]} (${i + 1})`; });
    this.takeButton = el('button', { type: 'button', class: 'take', onclick: () => viewer.send({ do: 'take' }) }, 'Take over');
    this.role = el('span', { class: 'role' });
    page.audience.append(this.role, this.takeButton);
    if (viewer.stage) page.stage.append(this.tools.node);
    this.held = el('ul', { class: 'held' });
    this.heldGroup = group('Held', this.held);
    this.heldGroup.hidden = true;
    page.dials.append(this.heldGroup);
    this.dials = new Dials(viewer, page.dials);
    page.controls.append(...this.groups([['run', 'So far'], ['frame', 'Now'], ['custom', 'Custom']]),
      helpOn([['Space', 'play or pause'], ['.', 'one step'], ['Backspace', 'reset'], ['1 2 3 4', 'pull, pin, push, turn'], ['Shift', 'what is let go stays held'],
        ['P', 'picture'], ['L', 'link of the view'], ...DISPLAY_KEYS]));
    page.controls.hidden = !viewer.stage;
    this.showRange();
    this.cutChanged();
  }

  filmChanged() {
    this.say(this.filmButton, this.viewer.video ? 'End video' : 'Video');
    this.filmButton.classList.toggle('on', Boolean(this.viewer.video));
  }

  playOrPause() {
    this.viewer.send({ do: this.viewer.frame?.info.playing ? 'pause' : 'play' });
  }

  /** A picture has come. */
  update({ info }) {
    const { viewer } = this;
    const { playing } = info;
    if (this.playing !== playing) {
      this.playing = playing;
      this.playButton.replaceChildren(icon(playing ? 'pause' : 'play'));
      this.playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    }
    this.say(this.pace, this.paceText(info));
    if (document.activeElement !== this.speed) this.speed.value = String(info.speed);
    this.say(this.recordButton, info.recorded === null ? 'Record' : `Stop, ${info.recorded} steps`);
    this.recordButton.classList.toggle('on', info.recorded !== null);
    const { readonly } = viewer.run.head;
    this.say(this.role, readonly ? 'looking on' : info.drives ? (info.viewers > 1 ? `you drive, ${info.viewers} look on` : '') : 'another viewer drives');
    this.takeButton.hidden = readonly || info.drives;
    if (this.drives !== info.drives) {
      this.drives = info.drives;
      for (const node of this.driven) node.disabled = !info.drives;
      this.dials.enable(info.drives);
    }
    this.dials.update(info.dials);
    this.showHeld(info.handles);
  }

  say(node, text) {
    if (node.textContent !== text) node.textContent = text;
  }

  paceText(info) {
    const step = info.stepMs > 0 ? `${significant(info.stepMs, info.stepMs < 10 ? 2 : 3)} ms a step` : '';
    if (!info.playing) return ['paused', step].filter(Boolean).join(', ');
    if (info.failed) return 'waits for a change';
    if (info.settled) return ['in balance', step].filter(Boolean).join(', ');
    const rate = info.factor === null ? `${significant(info.perSecond, 2)} steps a second` : `${info.factor.toFixed(2)} × real time`;
    return [rate, step].filter(Boolean).join(', ');
  }

  showHeld(handles) {
    this.heldGroup.hidden = handles.length === 0;
    const ids = handles.map((h) => h.id).join();
    if (this.heldIds === ids) return;
    this.heldIds = ids;
    this.held.replaceChildren(...handles.map((h) => el('li', {}, `${{ pull: 'Spring', pin: 'Pin', push: 'Sphere' }[h.kind]} ${h.id}`,
      el('button', { type: 'button', onclick: () => this.viewer.send({ do: 'release', handle: h.id }) }, 'Release'))));
  }

  key(event) {
    if (isTyping(event)) return;
    const tool = TOOLS[Number(event.key) - 1];
    const actions = {
      ' ': () => isOnButton(event) || this.playOrPause(),
      '.': () => this.viewer.send({ do: 'step' }),
      Backspace: () => this.viewer.send({ do: 'reset' }),
      p: () => this.viewer.savePicture(this.viewer.pictureName),
      l: () => this.viewer.copyLink(),
    };
    if (tool) {
      this.tools.set(tool[0]);
      if (this.viewer.hand) this.viewer.hand.tool = tool[0];
    } else if (actions[event.key]) {
      if (event.key !== ' ' || !isOnButton(event)) event.preventDefault();
      actions[event.key]();
    } else {
      this.displayKey(event);
    }
  }
}
