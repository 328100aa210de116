// Opens the page of a scene that runs: joins, shows picture after picture, and sends what the hand does.
import 'uplot/dist/uPlot.min.css';
import '../style.css';
import './live.css';
import { CursorValue } from '../cursor_value.js';
import { Display } from '../display.js';
import { el } from '../dom.js';
import { buildPage } from '../layout.js';
import { significant } from '../numbers.js';
import { looksOf } from '../options.js';
import { Stage } from '../stage.js';
import { Connection } from './connection.js';
import { LiveControls } from './controls.js';
import { LiveData } from './data.js';
import { Engine } from './engine.js';
import { Hand } from './hand.js';
import { ScrollPlots } from './scroll_plots.js';
import { copyLink, readLink } from '../view_link.js';

const AGAIN = 700; // ms, then a server that does not answer is asked again
const HIDDEN = 200; // ms: a page that nobody sees draws nothing, but goes on looking

class LiveViewer extends Display {
  constructor(connection, options, run) {
    super(run, options);
    this.connection = connection;
    this.fields = run.fieldList();
    this.frame = null;
    this.drives = false;
    this.pictures = 0;
    this.state = {
      frame: null, field: this.fields.find((f) => f.name === options.field) ?? this.firstField(), share: options.share,
      rangeMode: options.range ? 'custom' : options.perFrame ? 'frame' : 'run', custom: options.range,
      ghost: options.ghost, edges: options.edges, cut: options.cut,
      looks: looksOf(options, run.head.parts), arrows: { ...options.arrows },
    };
    const { cut } = this.state;
    if (cut.axis === 'auto') cut.axis = run.cutAxis();
    cut.at ??= 0.5;
    this.cutPlaces = { x: 0.5, y: 0.5, z: 0.5, free: 0.5 };
  }

  firstField() { return this.fields.find((f) => f.name === 'von_mises') ?? this.fields[0]; }

  start() {
    const { run, options } = this;
    this.setTheme(options.theme);
    this.page = buildPage(run.head);
    this.page.root.classList.add('live');
    this.page.dials = el('aside', { class: 'card controls dials', 'aria-label': 'What can be changed' });
    this.page.root.querySelector('.viewer').prepend(this.page.dials);
    this.page.audience = el('div', { class: 'audience' });
    this.page.theme.before(this.page.audience);
    this.page.said = el('p', { class: 'said', role: 'status', hidden: true });
    this.page.stage.append(this.page.said);
    document.getElementById('app').replaceChildren(this.page.root);
    document.title = `${run.head.title} · Isochor live`;
    this.page.root.classList.toggle('unlabeled', !options.labels);
    document.documentElement.classList.toggle('shot', options.shot);
    this.page.notes.append(...[...options.problems, ...run.head.notes].map((text) => el('p', {}, text)));
    try {
      this.stage = new Stage(run, this.page.stage);
      this.hand = new Hand(this);
      this.cursor = new CursorValue(this);
    } catch (error) {
      this.page.stage.replaceChildren(el('p', { class: 'empty' }, `No 3D view: ${error.message}.`));
    }
    this.plots = new ScrollPlots(run, this.page.plots);
    this.controls = new LiveControls(this);
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.themeChanged());
    this.page.theme.addEventListener('click', () => {
      const isDark = getComputedStyle(document.documentElement).getPropertyValue('--dark').trim() === '1';
      this.setTheme(isDark ? 'light' : 'dark');
      this.themeChanged();
    });
    this.themeChanged();
  }

  /** The first picture decides where the camera stands. */
  open(frame) {
    const { stage, options } = this;
    if (!stage) return;
    stage.fitPoints = [this.run.rest.subarray(0, 3 * this.run.bodyVertices), frame.positions.subarray(0, 3 * this.run.bodyVertices)];
    stage.look(options.view, 0.8 * options.zoom); // room for what moves
    if (options.camera) stage.stand(options.camera);
    this.openCut();
    stage.open();
  }

  /** Which field the server has to send along. */
  get asked() { return this.state.field.kind === 'given' ? this.state.field.name : ''; }

  /** What else it has to send. */
  get wants() { return Object.keys(this.state.arrows).filter((name) => this.state.arrows[name]).join(); }

  arrowsChanged() { this.connection.hurry?.(); }

  show(frame) {
    const first = this.frame === null;
    const { info } = frame;
    if (this.isShown(frame)) {
      this.frame.info = info;
      this.showWords(info);
      return;
    }
    if (this.frame && info.step < this.frame.info.step) this.run.forgetRanges();
    this.frame = this.state.frame = frame;
    const { state, stage, run } = this;
    const known = run.runRange(state.field) !== null;
    run.remember(frame, state.field);
    if (stage) {
      stage.body.setShape(frame.positions);
      stage.overlays.setFrame(frame);
      this.hand.update(info.handles);
      const moves = info.playing && !info.settled && !info.failed;
      if (stage.playing !== moves) stage.setPlaying(moves);
    }
    this.showField();
    this.showRangeSoon(known ? 400 : 0);
    this.plots.add(info.time, info.measures);
    this.showWords(info);
    if (first) this.open(frame);
    if (stage?.pending) stage.drawChange();
    this.hand?.place();
    this.cursor?.later();
  }

  /** What beside the picture changes: who drives, how fast it goes. */
  showWords(info) {
    this.drives = info.drives;
    this.controls.update({ info });
    this.tell(info);
    ++this.pictures;
  }

  /** The server answers after a while with the picture that is on the screen: there is nothing to draw. */
  isShown(frame) {
    const { frame: now } = this;
    return now !== null && now.info.number === frame.info.number && now.field === frame.field
      && now.forces.length === frame.forces.length && now.fibers.length === frame.fibers.length;
  }

  /** The numbers beside the colors follow them, but not faster than anybody reads, nor while somebody types. */
  showRangeSoon(wait) {
    if (this.rangeTimer && wait > 0) return;
    clearTimeout(this.rangeTimer);
    this.rangeTimer = setTimeout(() => {
      this.rangeTimer = null;
      if (!document.activeElement?.matches('.bounds input')) this.controls.showRange();
    }, wait);
  }

  /** Values that have not come yet leave the picture as it is, but for the shape. */
  showField() {
    const { state, frame, stage, run } = this;
    if (frame && state.field.kind === 'given' && run.values(frame, state.field) === null) {
      this.connection.hurry?.();
      stage?.body.refresh();
      this.showDisplay();
      return;
    }
    super.showField();
  }

  tell(info) {
    const { x } = this.run.head;
    const stamp = `${x.symbol} = ${significant(info.time, 4)} ${x.unit}`;
    if (this.stamp !== stamp) {
      this.stamp = stamp;
      this.page.stamp.replaceChildren(el('b', {}, stamp), el('span', {}, `step ${info.step}`));
    }
    if (this.lost) return;
    this.said(info.message, info.failed);
  }

  said(sentence, grave = false) {
    const { said } = this.page;
    const text = sentence ? sentence[0].toUpperCase() + sentence.slice(1) : '';
    if (said.textContent !== text) said.textContent = text;
    said.hidden = text === '';
    said.classList.toggle('grave', grave);
  }

  /** A refusal stands for a while; null says nothing. */
  say(refusal) {
    if (!refusal) return;
    const note = el('p', {}, refusal);
    this.page.notes.append(note);
    this.refusal?.remove();
    this.refusal = note;
    setTimeout(() => note.remove(), 6000);
  }

  async send(command) { this.say(await this.connection.send(command)); }

  setDial(index, value) {
    this.connection.sendLatest(`set ${index}`, { do: 'set', control: index, value }).then((refusal) => this.say(refusal));
  }

  /** What soft body is under a point of the window, if any. */
  pickAt(event) {
    const hit = super.pickAt(event);
    return hit && !this.run.head.parts[this.run.trianglePart[hit.triangle]].obstacle ? hit : null;
  }

  get pictureName() { return `${this.run.name}_${this.frame?.info.step ?? 0}`; }

  copyLink() { copyLink(this); }

  /** A film of what is to be seen from now on, or its end. */
  async film() {
    if (this.video) await this.endVideo(this.pictureName);
    else this.startVideo();
    this.controls.filmChanged();
  }
}

const nextFrame = () => new Promise((done) => {
  const late = setTimeout(done, HIDDEN);
  requestAnimationFrame(() => { clearTimeout(late); done(); });
});

/** When the last picture is on the screen: those that are drawn in advance would show what has been. */
async function nextPicture(stage) {
  const end = performance.now() + HIDDEN;
  do await nextFrame();
  while (stage?.measured && performance.now() < end);
}

/** Asks for pictures until the scene is another one or the server gone: each when it is about to be drawn. */
async function look(viewer, connection) {
  let after = 0;
  for (;;) {
    await nextPicture(viewer.stage);
    const field = viewer.asked, { wants } = viewer;
    const asked = connection.picture(after, field, wants);
    // A field that was chosen meanwhile is asked for at once.
    const hurry = new Promise((done) => { connection.hurry = () => { if (field !== viewer.asked || wants !== viewer.wants) done(null); }; });
    const message = await Promise.race([asked, hurry]);
    if (message === null) {
      asked.catch(() => {}); // nobody waits for it any more
      after = 0;
      continue;
    }
    const frame = viewer.run.read(message);
    after = frame.info.number;
    viewer.show(frame);
  }
}

async function open() {
  const app = document.getElementById('app');
  const options = readLink(window.location);
  const connection = Engine.isCarried() ? new Engine() : new Connection(options.token);
  let viewer = null;
  window.addEventListener('pagehide', () => connection.leave());
  for (;;) {
    try {
      const message = await connection.join();
      const again = viewer !== null && JSON.stringify(message.head.dials) === JSON.stringify(viewer.run.head.dials)
        && message.head.vertices === viewer.run.head.vertices;
      if (!again) {
        viewer = new LiveViewer(connection, options, new LiveData(message));
        viewer.start();
        window.isochorLive = viewer; // for tests and for the curious
      }
      viewer.lost = false;
      viewer.page.root.classList.remove('lost');
      window.isochorReady = true;
      await look(viewer, connection);
    } catch (error) {
      window.isochorError = String(error.message);
      if (!viewer || error.status === 401 || error.status === 403) {
        app.replaceChildren(el('p', { class: 'empty' }, `This scene cannot be shown: ${error.message}.`));
        if (error.status) return;
      } else if (error.status !== 410) {
        console.info(error); // the page says it as well
        viewer.lost = true;
        viewer.page.root.classList.add('lost');
        viewer.said(error.status ? `${error.message}` : connection.silence, true);
      }
      await new Promise((done) => setTimeout(done, error.status === 410 ? 0 : AGAIN));
    }
  }
}

open();
