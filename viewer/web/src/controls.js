// The panel beside the view, the transport below it, and the keyboard.
import { DISPLAY_KEYS, DisplayPanel, helpOn, isOnButton, isOnSlider, isTyping } from './display_panel.js';
import { el } from './dom.js';
import { icon } from './layout.js';
import { videoType } from './video.js';
import { copyLink } from './view_link.js';

export class Controls extends DisplayPanel {
  constructor(viewer) {
    super(viewer);
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
    const button = (text, title, action) => el('button', { type: 'button', class: 'word', title, onclick: action }, text);
    this.filmButton = button('Video', 'The run from its beginning as a film (WebM)', () => (viewer.video ? viewer.endFilm() : viewer.film()));
    this.filmButton.hidden = !viewer.stage || videoType() === null || frames.length < 2;
    const keep = viewer.stage ? [button('PNG', 'The picture as a file (P)', () => viewer.savePicture(viewer.pictureName)), this.filmButton,
      button('Link', 'An address that shows this view (L)', () => copyLink(viewer))] : [];
    viewer.page.transport.append(this.playButton, step('back', 'Previous frame', -1), step('next', 'Next frame', 1), this.slider, this.counter, speed, ...keep);
    viewer.page.transport.hidden = frames.length < 2;
    this.playingChanged();
  }

  playingChanged() {
    const { playing } = this.viewer.state;
    this.playButton.replaceChildren(icon(playing ? 'pause' : 'play'));
    this.playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
  }

  filmChanged() {
    const on = Boolean(this.viewer.video);
    this.filmButton.textContent = on ? 'Stop' : 'Video';
    this.filmButton.classList.toggle('on', on);
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
    const { run, page, stage } = this.viewer;
    page.controls.append(...this.groups([['run', 'All frames'], ['frame', 'This frame'], ['custom', 'Custom']]),
      helpOn([['Space', 'play or pause'], ['← →', 'previous, next frame'], ['Home End', 'first, last frame'], ['P', 'picture'], ['L', 'link of the view'], ...DISPLAY_KEYS]));
    page.controls.hidden = !stage;
    this.rangeBox.hidden = run.frameCount === 0;
    this.showRange();
    this.cutChanged();
  }

  key(event) {
    const { viewer } = this;
    if (isTyping(event)) return;
    const onSlider = isOnSlider(event);
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (by && !event.shiftKey && !onSlider) {
      viewer.play(false);
      viewer.go(viewer.state.frame + by);
      event.preventDefault();
    } else if (event.key === ' ') {
      if (isOnButton(event)) return;
      viewer.play(!viewer.state.playing);
      event.preventDefault();
    } else if (event.key === 'Home' || event.key === 'End') {
      if (!onSlider) viewer.go(event.key === 'Home' ? 0 : viewer.run.frameCount - 1);
    } else if (event.key === 'p') {
      viewer.savePicture(viewer.pictureName);
    } else if (event.key === 'l') {
      copyLink(viewer);
    } else {
      this.displayKey(event);
    }
  }
}
