// Opens the page: reads the data, builds the views and joins them through one state.
import 'uplot/dist/uPlot.min.css';
import './style.css';
import { Controls } from './controls.js';
import { CursorValue } from './cursor_value.js';
import { RunData } from './data.js';
import { Display } from './display.js';
import { el } from './dom.js';
import { buildPage } from './layout.js';
import { significant, unitScale } from './numbers.js';
import { frameNumber, looksOf, nearestFrame, readOptions } from './options.js';
import { Plots } from './plots.js';
import { Stage } from './stage.js';

class Viewer extends Display {
  constructor(run, options) {
    super(run, options);
    this.fields = run.fieldList();
    const wanted = this.fields.find((f) => f.name === options.field);
    this.state = {
      frame: run.frameCount > 0 ? frameNumber(options.frame, run.head.frames) : -1,
      field: wanted ?? this.fields[0],
      share: options.share, // of the values that colors span; null: by the field
      rangeMode: options.range ? 'custom' : options.perFrame ? 'frame' : 'run',
      custom: options.range,
      ghost: options.ghost,
      edges: options.edges,
      cut: options.cut,
      looks: looksOf(options, run.head.parts),
      arrows: { ...options.arrows },
      playing: false,
      speed: 1,
    };
    const { cut } = this.state;
    if (cut.axis === 'auto') cut.axis = run.cutAxis();
    this.cutPlaces = Object.fromEntries(['x', 'y', 'z'].map((axis, i) => [axis, run.cutPosition(i)]));
    this.cutPlaces.free = 0.5;
    if (cut.axis && cut.at !== null) this.cutPlaces[cut.axis] = cut.at;
    cut.at = cut.axis ? this.cutPlaces[cut.axis] : 0.5;
    // What was asked for and is not there, for whoever takes pictures.
    this.problems = [...options.problems];
    if (options.field && !wanted) {
      this.problems.push(`This run has no field "${options.field}"; it has ${this.fields.map((f) => f.name).join(', ')}.`);
    }
    const frames = run.frameCount;
    if (/^\d+$/.test(options.frame) && Number(options.frame) >= frames) {
      this.problems.push(`frame=${options.frame}: this run has frames 0 to ${frames - 1}.`);
    }
    this.notes = [...this.problems, ...run.head.notes];
  }

  async start() {
    const { run, options } = this;
    this.setTheme(options.theme);
    this.page = buildPage(run.head);
    document.getElementById('app').append(this.page.root);
    document.documentElement.classList.toggle('shot', options.shot);
    this.page.root.classList.toggle('unlabeled', !options.labels);
    this.page.root.classList.toggle('no-legend', !options.legend);
    try {
      if (run.head.triangles === 0 && run.head.lines.length === 0) throw new Error('this run has no surface');
      this.stage = new Stage(run, this.page.stage);
    } catch (error) {
      this.page.stage.replaceChildren(el('p', { class: 'empty' }, `No 3D view: ${error.message}.`));
      this.notes.push(`No 3D view: ${error.message}.`);
    }
    this.page.notes.append(...this.notes.map((text) => el('p', {}, text)));
    if (!options.shot) {
      if (this.stage) this.cursor = new CursorValue(this);
      this.plots = new Plots(run, this.page.plots, (x) => this.go(nearestFrame(x, run.head.frames)));
      this.controls = new Controls(this);
      const dark = window.matchMedia('(prefers-color-scheme: dark)');
      dark.addEventListener('change', () => this.themeChanged());
      this.page.theme.addEventListener('click', () => {
        const isDark = getComputedStyle(document.documentElement).getPropertyValue('--dark').trim() === '1';
        this.setTheme(isDark ? 'light' : 'dark');
        this.themeChanged();
      });
    }
    this.themeChanged(false);
    await run.prepare(this.state.field);
    await this.showFrame();
    if (this.stage) {
      this.stage.fitPoints = await this.pointsToFit();
      this.stage.look(options.view, options.zoom);
      if (options.camera) this.stage.stand(options.camera);
      this.openCut();
      this.showDisplay();
      this.stage.open();
    }
  }

  /** The camera is set once so that the whole motion stays in view. */
  async pointsToFit() {
    const { run } = this;
    const out = [run.rest];
    if (run.frameCount === 0) return out;
    let widest = 0;
    run.head.frames.forEach((f, i) => { if (f.displacement > run.head.frames[widest].displacement) widest = i; });
    for (const i of new Set([widest, this.state.frame])) {
      const frame = await run.frame(i);
      out.push(run.positions(frame), ...frame.lines, frame.probes);
    }
    return out;
  }

  async go(frame) {
    if (this.run.frameCount === 0) return;
    this.state.frame = Math.min(this.run.frameCount - 1, Math.max(0, frame));
    await this.showFrame();
  }

  /** Unpacks the current frame and shows it; a newer request wins over one still unpacking. */
  async showFrame() {
    const { run, state } = this;
    const wanted = state.frame;
    const frame = wanted >= 0 ? await run.frame(wanted) : null;
    if (wanted !== state.frame) return;
    this.frame = frame;
    if (this.stage) {
      this.stage.body.setShape(frame ? run.positions(frame) : run.rest);
      if (frame) this.stage.overlays.setFrame(frame);
    }
    this.showField();
    const info = frame?.info;
    if (info) {
      this.timeScale ??= unitScale(run.head.frames.reduce((m, f) => Math.max(m, Math.abs(f.time)), 0), run.head.x.unit);
      const { factor, unit } = this.timeScale;
      this.page.stamp.replaceChildren(
        el('b', {}, `${run.head.x.symbol} = ${significant(info.time * factor, 4)} ${unit}`),
        el('span', {}, info.label || (run.head.x.symbol === 't' ? '' : run.head.x.label)));
      this.plots?.setTime(info.time, state.playing);
    }
    this.controls?.frameShown();
    this.cursor?.later();
  }

  get pictureName() { return `${this.run.head.title || 'isochor'} ${this.state.frame}`.replace(/[^\w.-]+/g, '_'); }

  /** From the first frame to the last, as a film. */
  async film() {
    const { run } = this;
    if (this.video || run.frameCount < 2) return;
    this.play(false);
    await this.go(0);
    this.startVideo();
    this.controls.filmChanged();
    this.play(true);
    this.filmEnds = true;
  }

  async endFilm() {
    this.filmEnds = false;
    this.play(false);
    await this.endVideo(this.pictureName);
    this.controls.filmChanged();
  }

  play(on) {
    const { state, run } = this;
    const was = state.playing;
    state.playing = on && run.frameCount > 1;
    this.stage?.setPlaying(state.playing);
    this.controls?.playingChanged();
    if (!state.playing) {
      if (was && this.frame) this.plots?.setTime(this.frame.info.time); // the key of the charts kept a slower pace
      return;
    }
    if (state.frame === run.frameCount - 1) this.go(0);
    // Short runs are stretched to about four seconds, long ones run at thirty frames a second.
    const rate = Math.min(30, Math.max(5, run.frameCount / 4)) * state.speed;
    let last = performance.now();
    const step = async (now) => {
      if (!state.playing || this.playToken !== token) return;
      if (now - last >= 1000 / rate - 2) {
        last = now;
        await this.advance();
      }
      requestAnimationFrame(step);
    };
    const token = (this.playToken = {});
    requestAnimationFrame(step);
  }

  /** The next frame, drawn; those after it are unpacked meanwhile. */
  async advance() {
    const { run, state, stage } = this;
    if (this.filmEnds && state.frame === run.frameCount - 1) { await this.endFilm(); return; }
    await this.go((state.frame + 1) % run.frameCount);
    if (stage?.pending) stage.drawChange();
    for (let k = 1; k <= 3; ++k) run.frame((state.frame + k) % run.frameCount).catch(() => {}); // who shows it hears of it
  }
}

async function open() {
  try {
    const run = await RunData.open(document);
    document.title = run.head.title || 'Isochor results';
    const viewer = new Viewer(run, readOptions(window.location));
    await viewer.start();
    window.isochorViewer = viewer; // for tests and for the curious
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  } catch (error) {
    document.getElementById('app').append(el('p', { class: 'empty' }, `These results cannot be shown: ${error.message}.`));
    window.isochorError = String(error.message);
    console.error(error);
  }
  window.isochorProblems = window.isochorViewer?.problems ?? []; // options that cannot be had: no picture of these
  window.isochorReady = true;
  window.isochorOpened = performance.now(); // ms since the browser set out for this page: the first picture is shown
  window.isochorViewer?.run.unpackAhead();
}

open();
