// What a picture shows and how: field and colors, ghost, edges and cut. Of a run that is over and of one that goes on.
import { drawLegend } from './legend.js';
import { significant, unitScale } from './numbers.js';

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
      this.stage.invalidate();
    }
    if (replot) this.plots?.build();
  }

  currentRange() {
    const { run, state } = this;
    const { field } = state;
    if (field.kind === 'solid' || state.frame < 0) return null;
    if (state.rangeMode === 'custom' && state.custom) return state.custom;
    const of = (full) => (state.rangeMode === 'frame' ? run.frameRange(field, state.frame, full) : run.runRange(field, full));
    let range = of(state.full);
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

  /** All that the values span, where the colors do not. */
  rangeBeyond(range) {
    const { run, state } = this;
    if (!range || state.full || state.rangeMode === 'custom' || state.field.categories.length > 0) return null;
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
        field, range, beyond: this.rangeBeyond(range), parts: run.head.parts, perFrame: state.rangeMode === 'frame',
        invalid: frame ? run.invalid(frame, field) : 0,
      };
      // Made anew only when it says something else: the browser paints it over the picture.
      const says = JSON.stringify([field.name, range, legend.beyond, legend.perFrame, legend.invalid]);
      if (this.legendSays !== says) drawLegend(this.page.legend, legend);
      this.legendSays = says;
    }
    this.showDisplay();
  }

  /** Ghost, edges and cut. */
  showDisplay() {
    const { state, stage } = this;
    if (!stage) return;
    stage.body.setGhost(state.ghost);
    stage.body.setEdges(state.edges);
    const plane = this.cutPlane();
    stage.body.setCut(plane);
    stage.overlays.setCut(plane);
    stage.invalidate();
  }

  /** Unless asked for a side, the half between the cut and the camera goes away. */
  openCut() {
    const { cut } = this.state;
    if (!cut.axis || cut.flip !== null || !this.stage) return;
    cut.flip = this.stage.toCamera('xyz'.indexOf(cut.axis)) < 0;
  }

  cutPlane() {
    const { run, state: { cut } } = this;
    if (!cut.axis) return null;
    const axis = 'xyz'.indexOf(cut.axis);
    const { low, high } = run.head.box;
    // Just inside the extent, so that the ends of the slider still show something.
    const t = Math.min(0.9995, Math.max(0.0005, cut.at));
    const at = (low[axis] + t * (high[axis] - low[axis]) - run.center[axis]) * run.scale;
    const plane = [0, 0, 0, 0];
    plane[axis] = cut.flip ? -1 : 1;
    plane[3] = cut.flip ? at : -at;
    return plane;
  }

  /** Where the cut is, in the unit of the run. */
  cutText() {
    const { run, state: { cut } } = this;
    const axis = 'xyz'.indexOf(cut.axis);
    const { low, high } = run.head.box;
    const scale = unitScale(Math.max(...low.map((v, i) => high[i] - v)), 'm');
    // To a thousandth of the extent: the middle of a symmetric body is zero and not a rounding error.
    const step = (high[axis] - low[axis]) / 1000 || 1;
    const place = Math.round((low[axis] + cut.at * (high[axis] - low[axis])) / step) * step;
    return `${cut.axis} = ${significant(place * scale.factor, 3)} ${scale.unit}`;
  }
}
