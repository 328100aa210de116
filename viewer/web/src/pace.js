// How finely to draw while something moves. A picture at rest is always drawn at its best; without a graphics
// card that takes too long to play a run or to turn a body, so quality gives way until motion is smooth.

/** From best to quickest: share of the resolution of the screen, and whether edges are smoothed (four samples a pixel). */
export const QUALITIES = [
  { share: 1, smooth: true }, { share: 1, smooth: false }, { share: 0.75, smooth: false }, { share: 0.5, smooth: false },
];

const SLOW = 40; // ms a picture: 20 to 25 pictures a second
const FAST = 20; // ms a picture: twice the work would still do
const PATIENCE = 40; // pictures

export class Pace {
  constructor() {
    this.quality = 0;
    this.recent = [];
    this.quick = 0;
    this.patience = PATIENCE;
  }

  /** A moving picture took so long. One slow picture (a first one, a busy moment) decides nothing. */
  took(ms) {
    this.quick = ms < FAST ? this.quick + 1 : 0;
    this.recent.push(ms);
    if (this.recent.length > 3) this.recent.shift();
    if (this.recent.length === 3 && [...this.recent].sort((a, b) => a - b)[1] > SLOW) {
      if (this.quality < QUALITIES.length - 1) this.change(1);
    } else if (this.quick >= this.patience && this.quality > 0) {
      this.change(-1);
      this.patience *= 4; // a try that fails is not soon repeated
    }
  }

  change(by) {
    this.quality += by;
    this.recent = [];
    this.quick = 0;
  }
}
