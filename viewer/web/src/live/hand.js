// Pulling, pinning and pushing with the pointer, and how it is drawn over the picture.
import * as THREE from 'three';
import { placeLabels } from '../labels.js';
import { bodyFragment, bodyVertex } from '../shaders.js';
import { significant, unitScale } from '../numbers.js';

export const TOOLS = [['pull', 'Pull', 'Drag a body: a spring pulls at it'], ['pin', 'Pin', 'Click a body to hold it there, a pin to let go'],
  ['push', 'Push', 'Drag on a body: a sphere pushes it'], ['turn', 'Turn', 'Dragging turns the view']];
const LETTER = 8, LINE = 16; // pixels that a letter of a force is wide at most, and a line of it high
const NEAR = 16; // pixels from which a handle is taken

const svg = (name, attributes = {}) => {
  const node = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  return node;
};

export class Hand {
  constructor(viewer) {
    this.viewer = viewer;
    this.tool = 'pull';
    this.handles = [];
    this.spheres = new Map();
    this.marks = new Map();
    this.layer = svg('svg', { class: 'hand', 'aria-hidden': 'true' });
    const { stage } = viewer.page;
    stage.querySelector('.labels').before(this.layer);
    // Before the camera's own listener: what takes hold of a body does not turn the view.
    stage.addEventListener('pointerdown', (event) => this.down(event), { capture: true });
    viewer.stage.canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const name of ['pointerup', 'pointercancel']) viewer.stage.canvas.addEventListener(name, (event) => this.up(event));
  }

  down(event) {
    const { viewer } = this;
    if (event.target !== viewer.stage.canvas || event.button !== 0 || !viewer.drives || this.drag) return;
    const known = this.near(event);
    if (known && this.tool === 'pin') {
      viewer.send({ do: 'release', handle: known.id });
    } else if (known && this.tool !== 'turn') {
      this.begin(event, { id: known.id, keep: true, point: viewer.run.toWorld(known.to) });
    } else {
      const hit = this.tool === 'turn' ? null : viewer.pickAt(event);
      if (!hit) return;
      const { triangle, weights, point } = hit;
      viewer.send({ do: this.tool, triangle, weights });
      // The handle is the next one that turns up.
      if (this.tool !== 'pin') this.begin(event, { id: null, after: Math.max(0, ...this.handles.map((h) => h.id)), kind: this.tool, point });
    }
    event.preventDefault();
    event.stopPropagation();
  }

  begin(event, drag) {
    const { camera, canvas } = this.viewer.stage;
    const normal = camera.getWorldDirection(new THREE.Vector3());
    const point = new THREE.Vector3(...drag.point);
    this.drag = { ...drag, plane: new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point), start: point, to: null, offset: null };
    this.drag.grip = this.onPlane(event)?.sub(point) ?? new THREE.Vector3();
    canvas.setPointerCapture(event.pointerId);
  }

  onPlane(event) {
    const { stage } = this.viewer;
    const { left, top, width, height } = stage.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, stage.camera);
    return caster.ray.intersectPlane(this.drag.plane, new THREE.Vector3());
  }

  move(event) {
    if (!this.drag) return;
    const point = this.onPlane(event);
    if (!point) return;
    this.drag.to = point.sub(this.drag.grip);
    this.follow();
  }

  /** Tells where the handle is wanted, once it is known which one it is. */
  follow() {
    const { drag, viewer } = this;
    if (!drag.to || drag.id === null) return;
    // A sphere begins in front of the point at which it was set down.
    const offset = drag.offset ?? new THREE.Vector3();
    const to = viewer.run.toMeters(drag.to.clone().add(offset).toArray());
    viewer.connection.sendLatest(`move ${drag.id}`, { do: 'move', handle: drag.id, to }).then((refusal) => viewer.say(refusal));
  }

  up(event) {
    const { drag, viewer } = this;
    if (!drag) return;
    viewer.stage.canvas.releasePointerCapture?.(event.pointerId);
    this.drag = null;
    if (drag.keep || event.shiftKey) return; // with Shift what is held stays held
    if (drag.id !== null) viewer.send({ do: 'release', handle: drag.id });
    else this.orphan = drag; // not here yet: let go as soon as it comes
  }

  near(event) {
    const { left, top } = this.viewer.stage.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - left, event.clientY - top];
    return this.handles.find((h) => {
      const p = this.project(h.kind === 'push' ? h.at : h.to);
      return p && Math.hypot(p[0] - x, p[1] - y) < NEAR;
    });
  }

  /** Meters to pixels of the stage; null behind the camera. */
  project(meters) {
    const { stage, run } = this.viewer;
    const p = new THREE.Vector3(...run.toWorld(meters)).project(stage.camera);
    return Math.abs(p.z) > 1 ? null : [((p.x + 1) / 2) * stage.host.clientWidth, ((1 - p.y) / 2) * stage.host.clientHeight];
  }

  /** The handles of a picture. */
  update(handles) {
    this.handles = handles;
    for (const waiting of [this.drag, this.orphan]) {
      if (!waiting || waiting.id !== null) continue;
      const found = handles.find((h) => h.id > waiting.after && h.kind === waiting.kind);
      if (!found) continue;
      waiting.id = found.id;
      if (waiting.kind === 'push') waiting.offset = new THREE.Vector3(...this.viewer.run.toWorld(found.at)).sub(waiting.start);
      if (waiting === this.orphan) {
        this.viewer.send({ do: 'release', handle: found.id });
        this.orphan = null;
      } else {
        this.follow();
      }
    }
    this.updateSpheres();
  }

  updateSpheres() {
    const { run, stage } = this.viewer;
    const wanted = new Set();
    for (const h of this.handles.filter((one) => one.kind === 'push')) {
      wanted.add(h.id);
      let mesh = this.spheres.get(h.id);
      if (!mesh) {
        const geometry = new THREE.SphereGeometry(h.radius * run.scale, 32, 24);
        const color = new Float32Array(geometry.attributes.position.count * 3).fill(0.72);
        geometry.setAttribute('solid', new THREE.BufferAttribute(color, 3));
        mesh = new THREE.Mesh(geometry, new THREE.ShaderMaterial({ uniforms: stage.body.uniforms, vertexShader: bodyVertex, fragmentShader: bodyFragment }));
        stage.scene.add(mesh);
        this.spheres.set(h.id, mesh);
      }
      mesh.position.set(...run.toWorld(h.at));
    }
    for (const [id, mesh] of this.spheres) {
      if (wanted.has(id)) continue;
      stage.scene.remove(mesh);
      mesh.geometry.dispose();
      mesh.material.dispose();
      this.spheres.delete(id);
    }
  }

  /** Forces beside their springs, over neither each other nor other words on the picture. */
  placeWords(words) {
    if (words.length === 0) return;
    const { host, overlays } = this.viewer.stage;
    const bounds = { width: host.clientWidth, height: host.clientHeight };
    placeLabels(words, bounds, [...overlays.taken(host), ...overlays.placed]).forEach((place, i) => {
      const { mark, x, y } = words[i];
      // Where there is no room, a force is said all the same.
      mark.text.setAttribute('x', (place ? place.x : x + 12).toFixed(1));
      mark.text.setAttribute('y', (place ? place.y + 0.8 * LINE : y - 8).toFixed(1));
    });
  }

  /** Springs and pins over the picture, which has just been drawn. */
  place() {
    const seen = new Set();
    const words = [];
    for (const h of this.handles) {
      const at = this.project(h.at), to = this.project(h.to);
      if (!at || !to) continue;
      seen.add(h.id);
      let mark = this.marks.get(h.id);
      if (!mark) {
        mark = { group: svg('g', { class: h.kind }), line: svg('line'), from: svg('circle', { r: 3.5 }), end: svg('circle', { r: 7 }), text: svg('text') };
        mark.group.append(mark.line, mark.from, mark.end, mark.text);
        this.layer.append(mark.group);
        this.marks.set(h.id, mark);
      }
      const put = (node, values) => { for (const [key, v] of Object.entries(values)) node.setAttribute(key, v.toFixed(1)); };
      put(mark.line, { x1: at[0], y1: at[1], x2: to[0], y2: to[1] });
      put(mark.from, { cx: at[0], cy: at[1] });
      put(mark.end, { cx: to[0], cy: to[1] });
      const scale = unitScale(h.force, 'N');
      const text = h.force > 0 ? `${significant(h.force * scale.factor, 2)} ${scale.unit}` : '';
      if (mark.text.textContent !== text) mark.text.textContent = text;
      words.push({ mark, x: to[0], y: to[1], width: LETTER * text.length, height: LINE });
    }
    this.placeWords(words);
    for (const [id, mark] of this.marks) {
      if (seen.has(id)) continue;
      mark.group.remove();
      this.marks.delete(id);
    }
  }
}
