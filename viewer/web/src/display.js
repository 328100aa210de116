// What a picture shows and how: field and colors, ghost, edges and cut. Of a run that is over and of one that goes on.
import { FORCE_COLORS } from './arrows.js';
import { anglesOf, cutNormal, spanOf } from './cut.js';
import { el } from './dom.js';
import { drawLegend } from './legend.js';
import { significant, unitScale } from './numbers.js';
import { canvasFor, paintPicture, saveAs } from './picture.js';
import { pick } from './pick.js';
import { Video } from './video.js';

/** Who extends it has `state`, `page` and, where the browser can draw, `stage`. */
export class Display {
  constructor(run, options) {
    this.run = run;
    this.options = options;
  }

  setTheme(theme) {
    if (theme) document.documentElement.dataset.theme = theme;
  }

  themeChanged(replot = true) {
    if (this.stage) {
      const value = getComputedStyle(document.documentElement).getPropertyValue('--ghost').trim().split(' ').map(Number);
      this.stage.body.ghostColor.set(...value.map((v) => v / 255));
      const floor = getComputedStyle(document.documentElement).getPropertyValue('--floor').trim().split(' ').map(Number);
      this.stage.setFloor([...floor.slice(0, 3).map((v) => v / 255), floor[3]]);
      this.stage.invalidate();
    }
    if (replot) this.plots?.build();
  }

  currentRange() {
    const { run, state } = this;
    const { field } = state;
    if (field.kind === 'solid' || state.frame < 0) return null;
    if (state.rangeMode === 'custom' && state.custom) return state.custom;
    const of = (share) => (state.rangeMode === 'frame' ? run.frameRange(field, state.frame, share) : run.runRange(field, share));
    let range = of(this.share);
    if (!range) return null;
    if (field.diverging) {
      // Both sides get the same length of color, or the neutral color would not mean the center.
      const reach = Math.max(Math.abs(range[0] - field.center), Math.abs(range[1] - field.center));
      range = [field.center - reach, field.center + reach];
    }
    if (!(range[1] > range[0])) {
      const pad = Math.abs(range[0]) * 1e-3 || 1;
      // Nothing below zero where the run has nothing below zero.
      range = [field.diverging || range[0] < 0 ? range[0] - pad : Math.max(0, range[0] - pad), range[1] + pad];
    }
    return range;
  }

  /** The share of the values that colors span; of those around a center the ends, which are few and far out, count less. */
  get share() { return this.state.share ?? (this.state.field.diverging ? 0.9 : 0.98); }

  /** All that the values span, where the colors do not. */
  rangeBeyond(range) {
    const { run, state } = this;
    if (!range || this.share === 1 || state.rangeMode === 'custom' || state.field.categories.length > 0) return null;
    const all = state.rangeMode === 'frame' ? run.frameRange(state.field, state.frame) : run.runRange(state.field);
    return all && (all[0] < range[0] || all[1] > range[1]) ? all : null;
  }

  showField() {
    const { run, state, frame } = this;
    const { field } = state;
    const range = this.currentRange();
    if (this.stage) {
      const values = frame && field.kind !== 'solid' ? run.values(frame, field) : null;
      this.stage.body.setValues(field, values);
      if (range) this.stage.body.setRange(...range);
    }
    if (this.options.legend) {
      const legend = {
        field, range, share: this.share, beyond: this.rangeBeyond(range), parts: run.head.parts, perFrame: state.rangeMode === 'frame',
        invalid: frame ? run.invalid(frame, field) : 0,
      };
      // Made anew only when it says something else: the browser paints it over the picture.
      const says = JSON.stringify([field.name, range, legend.beyond, legend.share, legend.perFrame, legend.invalid]);
      if (this.legendSays !== says) drawLegend(this.page.legend, legend);
      this.legendSays = says;
    }
    this.showDisplay();
  }

  /** Ghost, edges, parts, arrows and cut. */
  showDisplay() {
    const { state, stage } = this;
    if (!stage) return;
    state.looks.forEach((look, part) => { if (stage.body.looks[part] !== look) stage.setLook(part, look); });
    stage.body.setGhost(state.ghost);
    stage.body.setEdges(state.edges);
    this.showArrows();
    stage.setCut(this.cutPlane());
    this.tellArrows();
    stage.invalidate();
  }

  showArrows() {
    const { run, state, stage: { overlays: { arrows } } } = this;
    arrows.shows = state.arrows;
    arrows.largest = run.largestForce?.() ?? 0;
  }

  /** What arrows mean, beside the picture. */
  tellArrows() {
    const { page, state, stage } = this;
    const { longest } = stage.overlays.arrows;
    const scale = unitScale(longest, 'N');
    const up = longest > 0 ? `, up to ${significant(longest * scale.factor, 2)} ${scale.unit}` : ', none now';
    const key = (color, text) => el('span', {}, el('i', { style: `background:${color}` }), text);
    const lines = [];
    if (state.arrows.forces) lines.push([FORCE_COLORS.normal, `contact forces${up}`], [FORCE_COLORS.friction, 'friction']);
    if (state.arrows.fibers) lines.push(['#3a1f5d', 'fibers']);
    const says = JSON.stringify(lines);
    if (this.arrowsSay === says) return;
    this.arrowsSay = says;
    page.arrowKey.hidden = lines.length === 0;
    page.arrowKey.replaceChildren(...lines.map(([color, text]) => key(color, text)));
  }

  /** Unless asked for a side, the half between the cut and the camera goes away. */
  openCut() {
    const { cut } = this.state;
    if (!cut.axis || cut.flip !== null || !this.stage) return;
    cut.flip = this.stage.toCamera(cutNormal(cut, this.run.head.up)) < 0;
  }

  /** A cut across the line of sight. */
  faceCut() {
    const { cut } = this.state;
    const toward = ['x', 'y', 'z'].map((_, k) => this.stage.toCamera([+(k === 0), +(k === 1), +(k === 2)]));
    [cut.azimuth, cut.elevation] = anglesOf(toward, this.run.head.up).map(Math.round);
    cut.axis = 'free';
    cut.flip = false;
  }

  cutPlane() {
    const { run, state: { cut } } = this;
    if (!cut.axis) return null;
    const n = cutNormal(cut, run.head.up);
    const [low, high] = spanOf(run.head.box, n);
    // Just inside the extent, so that the ends of the slider still show something.
    const t = Math.min(0.9995, Math.max(0.0005, cut.at));
    const center = run.center.reduce((sum, c, k) => sum + c * n[k], 0);
    const at = (low + t * (high - low) - center) * run.scale;
    return cut.flip ? [...n.map((v) => -v), at] : [...n, -at];
  }

  /** Where the cut is, in the unit of the run. */
  cutText() {
    const { run, state: { cut } } = this;
    const n = cutNormal(cut, run.head.up);
    const [low, high] = spanOf(run.head.box, n);
    const box = run.head.box;
    const scale = unitScale(Math.max(...box.low.map((v, i) => box.high[i] - v)), 'm');
    // To a thousandth of the extent: the middle of a symmetric body is zero and not a rounding error.
    const step = (high - low) / 1000 || 1;
    const place = Math.round((low + cut.at * (high - low)) / step) * step;
    const text = `${significant(place * scale.factor, 3)} ${scale.unit}`;
    return cut.axis === 'free' ? text : `${cut.axis} = ${text}`;
  }

  /** What is under a point of the window, if anything. */
  pickAt(event) { return this.stage ? pick(this.stage, event) : null; }

  /** The picture as a file. */
  savePicture(name) {
    const { stage } = this;
    if (!stage) return;
    const copy = canvasFor(stage);
    stage.draw();
    paintPicture(this, copy);
    copy.toBlob((blob) => {
      saveAs(blob, `${name}.png`);
      this.saved = blob.size; // for tests
    });
  }

  /** A film of what is drawn from now on. */
  startVideo() {
    if (!this.stage || this.video) return;
    this.stage.draw();
    this.video = new Video(this);
    this.stage.onDrawn = () => this.video?.add();
  }

  async endVideo(name) {
    const { video } = this;
    if (!video) return;
    this.video = null;
    this.stage.onDrawn = null;
    const film = await video.end();
    saveAs(film, `${name}.webm`);
    this.filmed = film; // for tests
  }
}
