// A film of what is drawn, as WebM, where the browser can.
import { canvasFor, paintPicture } from './picture.js';

const TYPES = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'];
const BITS_A_PIXEL = 6; // a second, at thirty pictures: smooth shading shows blocks below that

export const videoType = () => (typeof MediaRecorder === 'undefined' || !HTMLCanvasElement.prototype.captureStream
  ? null : TYPES.find((type) => MediaRecorder.isTypeSupported(type)) ?? null);

export class Video {
  constructor(viewer) {
    this.viewer = viewer;
    this.copy = canvasFor(viewer.stage);
    this.pictures = 0;
    paintPicture(viewer, this.copy);
    this.stream = this.copy.captureStream();
    this.recorder = new MediaRecorder(this.stream, {
      mimeType: videoType(), videoBitsPerSecond: Math.min(24e6, Math.max(2e6, BITS_A_PIXEL * this.copy.width * this.copy.height)),
    });
    this.parts = [];
    this.recorder.addEventListener('dataavailable', (event) => { if (event.data.size > 0) this.parts.push(event.data); });
    this.recorder.start(1000);
  }

  /** The stage has just drawn. */
  add() {
    paintPicture(this.viewer, this.copy);
    ++this.pictures;
  }

  /** The film. */
  end() {
    return new Promise((done) => {
      this.recorder.addEventListener('stop', () => {
        for (const track of this.stream.getTracks()) track.stop();
        done(new Blob(this.parts, { type: 'video/webm' }));
      });
      this.recorder.stop();
    });
  }
}
