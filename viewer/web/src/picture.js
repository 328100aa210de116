// The picture with what stands over it - background, stamp, legend, labels - on a canvas of its own: for files.
import { gradient } from './colors.js';

const style = (node) => getComputedStyle(node);

/** Makes ready to write as the element does. */
function pen(ink, node) {
  const { fontStyle, fontWeight, fontSize, fontFamily, color } = style(node);
  ink.font = `${fontStyle} ${fontWeight} ${fontSize} ${fontFamily}`;
  ink.fillStyle = color;
  ink.textBaseline = 'middle';
}

/** A label with its ground, where the page has it. */
function writeLabel(ink, node, from) {
  const box = node.getBoundingClientRect();
  const [x, y] = [box.left - from.left, box.top - from.top];
  ink.fillStyle = style(node).backgroundColor;
  ink.fillRect(x, y, box.width, box.height);
  pen(ink, node);
  ink.fillText(node.textContent, x + parseFloat(style(node).paddingLeft), y + box.height / 2);
}

/** Leaves of an element with their texts. */
function leaves(node) {
  const texts = [];
  const walk = document.createTreeWalker(node, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) if (walk.currentNode.textContent.trim()) texts.push(walk.currentNode);
  return texts;
}

function writeLines(ink, host, from) {
  for (const text of leaves(host)) {
    const range = document.createRange();
    range.selectNodeContents(text);
    pen(ink, text.parentElement);
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
    stops.forEach((color, i) => ramp.addColorStop(i / (stops.length - 1), color));
    ink.fillStyle = ramp;
    ink.fillRect(box.left - from.left, box.top - from.top, box.width, box.height);
  }
}

/** Swatches beside names. */
function drawSwatches(ink, host, from) {
  for (const swatch of host.querySelectorAll('i')) {
    const box = swatch.getBoundingClientRect();
    ink.fillStyle = style(swatch).backgroundColor;
    ink.fillRect(box.left - from.left, box.top - from.top, box.width, box.height);
  }
}

/** Springs and pins of the hand. */
function drawHandles(ink, layer) {
  const number = (node, name) => Number(node.getAttribute(name));
  for (const node of layer.querySelectorAll('line, circle, text')) {
    const { display, stroke, fill, strokeWidth, strokeDasharray } = style(node);
    if (display === 'none') continue;
    ink.strokeStyle = stroke;
    ink.fillStyle = fill;
    ink.lineWidth = parseFloat(strokeWidth);
    ink.setLineDash(node.tagName === 'line' && strokeDasharray !== 'none' ? strokeDasharray.split(',').map(parseFloat) : []);
    ink.beginPath();
    if (node.tagName === 'line') {
      ink.moveTo(number(node, 'x1'), number(node, 'y1'));
      ink.lineTo(number(node, 'x2'), number(node, 'y2'));
      ink.stroke();
    } else if (node.tagName === 'circle') {
      ink.arc(number(node, 'cx'), number(node, 'cy'), number(node, 'r'), 0, 2 * Math.PI);
      ink.fill();
      ink.stroke();
    } else {
      pen(ink, node);
      ink.textBaseline = 'alphabetic';
      ink.strokeText(node.textContent, number(node, 'x'), number(node, 'y'));
      ink.fillStyle = fill;
      ink.fillText(node.textContent, number(node, 'x'), number(node, 'y'));
    }
  }
  ink.setLineDash([]);
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
  if (!page.legend.hidden) drawBars(ink, page.legend, from, viewer.state.field);
  for (const host of [page.stamp, page.legend, page.arrowKey]) {
    if (host.hidden || style(host).display === 'none') continue;
    drawSwatches(ink, host, from);
    writeLines(ink, host, from);
  }
  const hand = stage.host.querySelector('svg.hand');
  if (hand) drawHandles(ink, hand);
  for (const label of stage.overlays.labels) if (!label.hidden && label.offsetWidth > 0) writeLabel(ink, label, from);
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
