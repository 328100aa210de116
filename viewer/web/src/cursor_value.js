// The value under the cursor.
import { el } from './dom.js';
import { significant, unitScale } from './numbers.js';
import { pick } from './pick.js';

export class CursorValue {
  constructor(viewer) {
    this.viewer = viewer;
    this.node = el('output', { class: 'under-cursor', hidden: true });
    viewer.page.stage.append(this.node);
    const { canvas } = viewer.stage;
    canvas.addEventListener('pointermove', (event) => {
      this.event = event.buttons === 0 ? event : null;
      this.later();
    });
    canvas.addEventListener('pointerleave', () => { this.event = null; this.later(); });
  }

  /** Once a picture at most: the cursor moves more often than anybody reads. */
  later() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.show(); });
  }

  show() {
    const text = this.event ? this.text(this.event) : null;
    this.node.hidden = text === null;
    if (text === null) return;
    if (this.node.textContent !== text) this.node.textContent = text;
    const box = this.viewer.page.stage.getBoundingClientRect();
    const left = Math.min(this.event.clientX - box.left + 16, box.width - this.node.offsetWidth - 6);
    this.node.style.transform = `translate(${left}px, ${Math.max(4, this.event.clientY - box.top - 30)}px)`;
  }

  text(event) {
    const { viewer } = this;
    const { run, frame, stage, state: { field } } = viewer;
    const values = frame ? run.values(frame, field) : null;
    const hit = values ? pick(stage, event) : null;
    const part = hit ? run.head.parts[run.trianglePart[hit.triangle]] : null;
    if (!hit || part?.obstacle) return null;
    const corners = [0, 1, 2].map((k) => values[run.triangles[3 * hit.triangle + k]]);
    const value = field.place === 'triangle' ? values[hit.triangle] : corners.reduce((sum, v, k) => sum + v * hit.weights[k], 0);
    if (field.categories.length > 0) return field.categories[Math.round(value)] ?? null;
    if (!Number.isFinite(value)) return 'not finite';
    const range = viewer.currentRange() ?? [value, value];
    const scale = unitScale(Math.max(Math.abs(range[0]), Math.abs(range[1])), field.unit);
    return `${significant(value * scale.factor, 3)} ${scale.unit}`.trim();
  }
}
