// Camera, canvas and drawing on demand.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Body } from './body.js';
import { Ground } from './ground.js';
import { Overlays } from './overlays.js';
import { Pace, QUALITIES } from './pace.js';
import { copyFragment, copyVertex } from './shaders.js';

// Colors are those of the display from end to end, wherever they are drawn to.
THREE.ColorManagement.enabled = false;

const SHADING = 7; // times what shadows take are left for everything else, while something moves
const REST = 160; // ms without a change, then the picture is drawn at its best

const VIEWS = {
  iso: [-55, 24], front: [-90, 0], back: [90, 0], right: [0, 0], left: [180, 0], top: [-90, 89.99], bottom: [-90, -89.99],
};
export const VIEW_NAMES = Object.keys(VIEWS);
const AXIS_COLORS = { x: '#d6453d', y: '#3d9a50', z: '#3b74d1' };

/** Left, right, bottom and top of the points on the picture, -1 to 1. */
function extent(lists, m) {
  let [l, r, b, t] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const points of lists) {
    for (let i = 0; i < points.length; i += 3) {
      const x = points[i], y = points[i + 1], z = points[i + 2];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      const across = (m[0] * x + m[4] * y + m[8] * z + m[12]) / w;
      const up = (m[1] * x + m[5] * y + m[9] * z + m[13]) / w;
      if (across < l) l = across;
      if (across > r) r = across;
      if (up < b) b = up;
      if (up > t) t = up;
    }
  }
  return [l, r, b, t];
}

export class Stage {
  constructor(run, host) {
    this.run = run;
    this.host = host;
    this.canvas = host.querySelector('canvas');
    // Smoothing of edges is a matter of each picture (pace.js), which the canvas itself does not allow.
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: false, alpha: true, stencil: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.renderer.setClearColor(0, 0);
    this.renderer.info.autoReset = false;
    this.pace = new Pace();
    this.playing = false;
    this.changed = -Infinity; // when something last changed
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(26, 1, 0.05, 100);
    this.up = run.head.up === 'y' ? 'y' : 'z';
    this.camera.up.set(0, this.up === 'y' ? 1 : 0, this.up === 'z' ? 1 : 0);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false; // a picture must not depend on when it was taken
    this.controls.zoomToCursor = true;
    this.controls.minDistance = 0.3;
    this.controls.maxDistance = 40;
    this.controls.addEventListener('change', () => this.invalidate());
    this.controls.addEventListener('start', () => { this.view = null; });
    this.body = new Body(run);
    this.overlays = new Overlays(run, host.querySelector('.labels'));
    this.triad = host.querySelector('.triad');
    this.ground = new Ground(run, this.up, run.groundHeight?.() ?? null);
    this.scene.add(this.body.object, this.overlays.object, this.ground.object);
    this.shading = { at: -Infinity, cost: 0 };
    this.fitPoints = [run.rest];
    this.resize();
  }

  /** From here on every change is drawn; what led up to the first picture was not worth one of its own. */
  open() {
    this.opened = true;
    this.draw();
    new ResizeObserver(() => this.resize()).observe(this.host);
  }

  /** Something has changed: there will be a picture of it, one for all that changes until then. */
  invalidate() {
    if (this.pending || !this.opened) return;
    this.pending = true;
    requestAnimationFrame(() => { if (this.pending) this.drawChange(); });
  }

  /** From now on until it is over the picture moves all the time. */
  setPlaying(on) {
    this.playing = on;
    if (!on) this.settle();
  }

  /** A single change is drawn at its best at once; one of many as quickly as the machine asks for. */
  drawChange() {
    const now = performance.now();
    const moves = this.playing || now - this.changed < REST;
    this.changed = now;
    if (moves) this.drawMoving(now);
    else this.draw();
  }

  drawMoving(now = performance.now()) {
    this.drawAt(this.pace.quality, true);
    this.measure(now);
    this.settle();
  }

  /** What was drawn in haste is drawn again once nothing moves. */
  settle() {
    clearTimeout(this.rest);
    const hasty = () => this.drawn !== 0 || this.unshaded;
    if (this.playing || !hasty()) return;
    this.rest = setTimeout(() => { if (!this.playing && hasty()) this.draw(); }, REST);
  }

  /** Tells the pace how long a picture took, as soon as the browser knows that it is done. */
  measure(start) {
    if (this.measured) return;
    const gl = this.renderer.getContext();
    const { pace } = this;
    this.measured = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!this.measured) return; // the context is lost
    gl.flush();
    const look = (now) => {
      const done = gl.getSyncParameter(this.measured, gl.SYNC_STATUS) === gl.SIGNALED;
      if (!done && !gl.isContextLost()) { requestAnimationFrame(look); return; }
      gl.deleteSync(this.measured);
      this.measured = null;
      pace.took(now - start);
    };
    requestAnimationFrame(look);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.host;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    if (width === 0 || height === 0 || this.size === `${width} ${height} ${ratio}`) return;
    this.size = `${width} ${height} ${ratio}`;
    this.ratio = ratio;
    this.resolution = null;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.view) this.look(this.view, this.zoom); // until the reader has moved the camera
    if (this.opened) this.draw();
  }

  /** Pixels of the canvas for one of the window. */
  setResolution(resolution) {
    if (this.resolution === resolution) return;
    this.resolution = resolution;
    this.renderer.setPixelRatio(resolution);
    this.body.uniforms.pixel.value = resolution;
    this.overlays.resize(resolution);
  }

  /** At its best, now. */
  draw() { this.drawAt(0); }

  drawAt(quality, moving = false) {
    this.pending = false;
    this.drawn = quality;
    const { share, smooth } = QUALITIES[quality];
    this.setResolution(this.ratio * share);
    const up = this.body.uniforms.upEye.value.copy(this.camera.up);
    this.camera.updateMatrixWorld();
    up.transformDirection(this.camera.matrixWorldInverse);
    // All of it lies in a sphere of radius one.
    this.body.setInside(this.camera.position.length() < 1 + 2 * this.camera.near);
    this.ground.seenFrom(this.camera);
    this.shade(moving);
    this.renderer.info.reset();
    if (smooth) this.renderSmooth();
    else this.renderer.render(this.scene, this.camera);
    this.overlays.placeLabels(this.camera, this.host, moving);
    this.drawTriad();
    this.onDrawn?.();
  }

  /** Shadows follow what moves as often as a part of the time allows, and what rests at once. */
  shade(moving) {
    this.unshaded = this.body.shadedShape !== this.body.positions || this.cutMoved;
    const start = performance.now();
    if (!this.unshaded || (moving && start - this.shading.at < SHADING * this.shading.cost)) return;
    this.ground.setShape(this.body.positions);
    this.body.shade();
    this.unshaded = this.cutMoved = false;
    const end = performance.now();
    this.shading = { at: end, cost: end - start };
  }

  /** plane: as Body.setCut() takes it. */
  setCut(plane) {
    this.body.setCut(plane);
    this.overlays.setCut(plane);
    this.cutMoved = this.cutMoved || JSON.stringify(plane) !== JSON.stringify(this.ground.cut);
    this.ground.setCut(plane);
    this.invalidate();
  }

  /** look: 'shown', 'faded' or 'hidden'. */
  setLook(part, look) {
    this.body.setLook(part, look);
    this.ground.setParts((p) => this.body.looks[p] === 'shown');
    this.invalidate();
  }

  setFloor(color) {
    this.ground.setFloor(color);
    if (Number.isFinite(this.ground.height)) this.ground.lay();
  }

  /** Four samples a pixel, resolved and copied to the canvas as they are. */
  renderSmooth() {
    const { renderer } = this;
    const { width, height } = this.canvas;
    if (!this.samples) {
      this.samples = new THREE.WebGLRenderTarget(width, height, {
        samples: 4, stencilBuffer: true, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter,
      });
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
      this.copy = new THREE.Mesh(geometry, new THREE.ShaderMaterial({
        uniforms: { picture: { value: this.samples.texture } }, vertexShader: copyVertex, fragmentShader: copyFragment,
        depthTest: false, depthWrite: false, blending: THREE.NoBlending,
      }));
      this.copy.frustumCulled = false;
    }
    this.samples.setSize(width, height);
    renderer.setRenderTarget(this.samples);
    renderer.render(this.scene, this.camera);
    renderer.setRenderTarget(null);
    renderer.render(this.copy, this.camera);
  }

  drawTriad() {
    const seen = this.camera.matrixWorldInverse.elements.slice(0, 11).join();
    if (this.triadSeen === seen) return; // new elements would have the browser paint again what lies over the picture
    this.triadSeen = seen;
    const p = new THREE.Vector3();
    const arms = ['x', 'y', 'z'].map((axis, i) => {
      p.set(+(i === 0), +(i === 1), +(i === 2)).transformDirection(this.camera.matrixWorldInverse);
      return { axis, x: 32 + 21 * p.x, y: 32 - 21 * p.y, tx: 32 + 28 * p.x, ty: 32 - 28 * p.y, depth: p.z };
    }).sort((a, b) => a.depth - b.depth);
    this.triad.innerHTML = arms.map((a) =>
      `<g stroke="${AXIS_COLORS[a.axis]}" fill="${AXIS_COLORS[a.axis]}"><line x1="32" y1="32" x2="${a.x}" y2="${a.y}"/>`
      + `<text x="${a.tx}" y="${a.ty}" stroke="none">${a.axis}</text></g>`).join('');
  }

  /** A named view or "azimuth,elevation" in degrees, framed on the body. */
  look(view, zoom = 1) {
    const angles = VIEWS[view] ?? String(view).split(',').map(Number);
    const [azimuth, elevation] = angles.length === 2 && angles.every(Number.isFinite) ? angles : VIEWS.iso;
    const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
    const flat = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    this.direction = new THREE.Vector3(...(this.up === 'z' ? flat : [flat[0], flat[2], -flat[1]]));
    this.fit(zoom);
    this.view = view;
    this.zoom = zoom;
  }

  /** Where it stands and what it looks at: six numbers. */
  stand(camera) {
    this.view = null;
    this.camera.position.set(...camera.slice(0, 3));
    this.controls.target.set(...camera.slice(3));
    this.controls.update();
    this.invalidate();
  }

  /** Centers the projected body in the space the legend leaves free. */
  fit(zoom) {
    const { camera, controls } = this;
    const target = new THREE.Vector3();
    let distance = 5;
    const right = new THREE.Vector3(), upward = new THREE.Vector3();
    const projection = new THREE.Matrix4();
    const width = Math.max(1, this.host.clientWidth);
    const legend = this.host.querySelector('.legend');
    // As wide as the legend is now, with some air to its left and what it keeps to its right.
    const reserved = legend && !legend.hidden ? Math.min(0.4, (width - legend.offsetLeft + 14) / width) : 0;
    for (let pass = 0; pass < 4; ++pass) {
      camera.position.copy(target).addScaledVector(this.direction, distance);
      camera.lookAt(target);
      camera.updateMatrixWorld();
      camera.updateProjectionMatrix();
      projection.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
      const [l, r, b, t] = extent(this.fitPoints, projection.elements);
      if (!(r >= l)) break;
      const halfHeight = distance * Math.tan((camera.fov * Math.PI) / 360);
      right.setFromMatrixColumn(camera.matrixWorld, 0);
      upward.setFromMatrixColumn(camera.matrixWorld, 1);
      target.addScaledVector(right, ((l + r) / 2) * halfHeight * camera.aspect);
      target.addScaledVector(upward, ((b + t) / 2) * halfHeight);
      const fill = Math.max((r - l) / 2 / (0.86 - reserved), (t - b) / 2 / 0.76);
      distance = Math.min(30, Math.max(0.5, distance * fill));
    }
    distance /= zoom;
    const halfWidth = distance * Math.tan((camera.fov * Math.PI) / 360) * camera.aspect;
    target.addScaledVector(right, reserved * halfWidth); // the body moves left, the legend stands right
    camera.position.copy(target).addScaledVector(this.direction, distance);
    controls.target.copy(target);
    controls.update();
    this.invalidate();
  }

  /** How far the camera stands along a direction from what it looks at. */
  toCamera(direction) {
    return this.camera.position.clone().sub(this.controls.target).dot(new THREE.Vector3(...direction));
  }

  /** Orbit by keyboard, in degrees. */
  turn(horizontal, vertical) {
    this.view = null;
    const offset = this.camera.position.clone().sub(this.controls.target);
    const up = this.camera.up;
    offset.applyAxisAngle(up, (horizontal * Math.PI) / 180);
    const side = new THREE.Vector3().crossVectors(up, offset).normalize();
    const turned = offset.clone().applyAxisAngle(side, (vertical * Math.PI) / 180);
    if (Math.abs(turned.clone().normalize().dot(up)) < 0.999) offset.copy(turned);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.invalidate();
  }

  dolly(factor) {
    this.view = null;
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.invalidate();
  }
}
