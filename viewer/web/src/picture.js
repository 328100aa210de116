// The picture with what stands over it - background, stamp, legend, labels - on a canvas of its own: for files.
import { gradient } from './colors.js';

const style = (node) => getComputedStyle(node);

/** The text of an element where the page has it. */
function write(ink, node, from, scale) {
  const box = node.getBoundingClientRect();
  if (box.width === 0 || !node.textContent) return;
  const { font, color } = style(node);
  ink.font = font;
  ink.fillStyle = color;
  ink.textBaseline = 'middle';
  ink.fillText(node.textContent, box.left - from.left, box.top - from.top + box.height / 2);
}

/** Leaves of an element with their texts. */
function leaves(node) {
  const texts = [];
  const walk = document.createTreeWalker(node, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) if (walk.currentNode.textContent.trim()) texts.push(walk.currentNode);
  return texts;
}

function writeLines(ink, host, from) {
  if (!host || host.hidden) return;
  for (const text of leaves(host)) {
    const range = document.createRange();
    range.selectNodeContents(text);
    const { font, color } = style(text.parentElement);
    ink.font = font;
    ink.fillStyle = color;
    ink.textBaseline = 'middle';
    // Lines as the browser has broken them: rectangles that lie at the same height are one.
    const words = text.textContent.split(/(?<=\s)/);
    let at = 0, line = '', box = null;
    const put = () => { if (line.trim()) ink.fillText(line.trim(), box.left - from.left, box.top - from.top + box.height / 2); };
    for (const word of words) {
      range.setStart(text, at);
      range.setEnd(text, at + word.length);
      at += word.length;
      const here = range.getBoundingClientRect();
      if (here.width === 0 && here.height === 0) continue;
      if (box && Math.abs(here.top - box.top) > 2) { put(); line = ''; box = null; }
      box ??= here;
      line += word;
    }
    if (box) put();
  }
}

function drawBars(ink, legend, from, field) {
  for (const bar of legend.querySelectorAll('.bar')) {
    const box = bar.getBoundingClientRect();
    const ramp = ink.createLinearGradient(0, box.bottom - from.top, 0, box.top - from.top);
    const stops = gradient(field.diverging ? 'diverging' : 'sequential', 'to top').match(/rgb\([^)]*\)/g);
    stops.forEach((color, i) => ramp.addColorStop(i / (stops.length - 1), color.replace(/rgb\((\d+) (\d+) (\d+)\)/, 'rgb($1,$2,$3)')));
    ink.fillStyle = ramp;
    ink.fillRect(box.left - from.left, box.top - from.top, box.width, box.height);
  }
  for (const swatch of legend.querySelectorAll('.swatches i')) {
    const box = swatch.getBoundingClientRect();
    ink.fillStyle = style(swatch).backgroundColor;
    ink.fillRect(box.left - from.left, box.top - from.top, box.width, box.height);
  }
}

/** Of a viewer as it was drawn last; in the same task as the drawing, after which the canvas is empty. */
export function paintPicture(viewer, copy) {
  const { stage, page } = viewer;
  const from = stage.host.getBoundingClientRect();
  const scale = copy.width / from.width;
  const ink = copy.getContext('2d');
  ink.setTransform(1, 0, 0, 1, 0, 0);
  const css = style(document.documentElement);
  const backdrop = ink.createRadialGradient(copy.width / 2, copy.height / 5, 0, copy.width / 2, copy.height / 5, 1.1 * copy.width);
  const [inner, outer] = css.getPropertyValue('--dark').trim() === '1' ? ['#2b323a', '#14181c'] : ['#ffffff', '#dfe4e9'];
  backdrop.addColorStop(0, inner);
  backdrop.addColorStop(1, outer);
  ink.fillStyle = backdrop;
  ink.fillRect(0, 0, copy.width, copy.height);
  ink.drawImage(stage.canvas, 0, 0, copy.width, copy.height);
  ink.setTransform(scale, 0, 0, scale, 0, 0);
  if (page.legend && !page.legend.hidden) drawBars(ink, page.legend, from, viewer.state.field);
  for (const host of [page.stamp, page.legend, page.arrowKey]) writeLines(ink, host, from);
  for (const label of stage.overlays.labels) if (!label.hidden) write(ink, label, from, scale);
}

/** A canvas of the size of the picture, with even sides as films want them. */
export function canvasFor(stage) {
  const ratio = stage.ratio ?? 1;
  const even = (v) => Math.max(2, 2 * Math.round((v * ratio) / 2));
  return Object.assign(document.createElement('canvas'), { width: even(stage.host.clientWidth), height: even(stage.host.clientHeight) });
}

/** A file that the reader's browser saves. */
export function saveAs(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
