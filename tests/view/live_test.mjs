// Live scenes in a real browser: played, slid, pulled, failed and got over, by several viewers, by strangers, to the end.
// Nothing here depends on how fast the machine is: what is to come is waited for.
//   node live_test.mjs path/to/isochor
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { request } from 'node:http';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { Browser, MISSING, findChromium } from '../../viewer/chromium.mjs';

const [isochor] = process.argv.slice(2);
if (!findChromium()) {
  console.log(`SKIPPED: ${MISSING}`);
  process.exit(77);
}

const folder = mkdtempSync(join(tmpdir(), 'isochor-live-'));
const SMALL = ['finger', '--set', 'bodies[0].mesh.file=meshes/finger_small.msh', '--set', 'probes=[]', '--set', 'metrics=[]'];
// Few and long steps: the browser draws by the processor, and wants some of it.
const MOVING = [...SMALL, '--threads', '1', '--set', 'analysis.type=dynamic', '--set', 'analysis.duration=10', '--set', 'analysis.steps=150'];

/** A server that runs until it is told to end. */
class Live {
  static all = [];

  static async start(...args) {
    const live = new Live();
    Live.all.push(live);
    live.child = spawn(isochor, ['live', ...args, '--no-browser'], { stdio: ['ignore', 'pipe', 'pipe'] });
    live.err = '';
    live.child.stderr.on('data', (data) => { live.err += data; });
    live.gone = new Promise((done) => live.child.once('exit', (code, signal) => done({ code, signal })));
    let out = '';
    await new Promise((done, fail) => {
      live.child.stdout.on('data', (data) => { out += data; if (out.includes('\n')) done(); });
      live.gone.then(({ code }) => fail(new Error(`isochor live ended with ${code}: ${live.err}`)));
    });
    live.link = out.trim();
    live.url = new URL(live.link);
    live.token = live.url.hash.slice('#token='.length);
    return live;
  }

  async end() {
    this.child.kill('SIGINT');
    return this.gone;
  }

  /** A request with headers as they are given; the browser would not allow most of them. */
  ask(path, { method = 'GET', headers = {}, body = '' } = {}) {
    return new Promise((done, fail) => {
      const asked = request({ host: this.url.hostname, port: this.url.port, path, method, headers: { 'X-Isochor-Token': this.token, ...headers } }, (answer) => {
        let text = '';
        answer.on('data', (data) => { text += data; });
        answer.on('end', () => done({ status: answer.statusCode, headers: answer.headers, text }));
      });
      asked.on('error', fail);
      asked.end(body);
    });
  }
}

const browser = await Browser.launch();

async function view(live, { drives = true, width = 900, height = 640, ...options } = {}) {
  const page = await browser.open(live.link, { width, height, ...options });
  await page.waitFor('window.isochorLive?.frame && window.isochorLive.stage.opened');
  if (!drives) return page;
  await page.evaluate(`isochorLive.send({ do: 'take' })`);
  await page.waitFor('isochorLive.frame.info.drives');
  return page;
}

const info = (page, what) => page.evaluate(`isochorLive.frame.info.${what}`);
const dial = (name) => `isochorLive.controls.dials.rows.find((row) => row.dial.name === '${name}')`;
/** As a hand does it: the slider moves and tells. */
const slide = (page, name, t) => page.evaluate(`{ const { slider } = ${dial(name)}; slider.value = ${1000 * t}; slider.dispatchEvent(new Event('input')); }`);
const press = (page, button) => page.evaluate(`isochorLive.controls.${button}.click()`);

/** A point of the picture where the body is, away from its end that is held. */
const ON_BODY = `(() => {
  const { stage, run } = isochorLive;
  const { left, top, width, height } = stage.canvas.getBoundingClientRect();
  let best = null;
  for (let i = 0; i < run.bodyVertices; ++i) {
    const p = stage.camera.position.clone().set(...stage.body.positions.subarray(3 * i, 3 * i + 3));
    const x = run.rest[3 * i];
    const s = p.project(stage.camera);
    const at = { x: left + (s.x + 1) / 2 * width, y: top + (1 - s.y) / 2 * height };
    if (at.x < left + 5 || at.x > left + width - 170 || document.elementFromPoint(at.x, at.y) !== stage.canvas) continue;
    if (!best || x > best.rest) best = { ...at, rest: x };
  }
  return best;
})()`;

async function mouse(page, type, { x, y }, button = 'left') {
  await page.send('Input.dispatchMouseEvent', { type, x, y, button, buttons: type === 'mousePressed' || type === 'mouseMoved' ? 1 : 0, clickCount: 1 });
}

/**
 * A pixel near a point where the body is hit, and so are the pixels around it: what is given to the browser may be rounded,
 * and an edge of the body must not lie between. Of a world that rests.
 */
async function hitNear(page, at) {
  const found = await page.evaluate(`(() => {
    const { canvas } = isochorLive.stage;
    const hit = (x, y) => document.elementFromPoint(x, y) === canvas && isochorLive.pickAt({ clientX: x, clientY: y }) !== null;
    for (let r = 0; r < 120; r += 2) for (let k = 0; k < 24; ++k) {
      const x = Math.round(${at.x} + r * Math.cos(k * Math.PI / 12)), y = Math.round(${at.y} + r * Math.sin(k * Math.PI / 12));
      if ([[0, 0], [2, 0], [-2, 0], [0, 2], [0, -2], [2, 2], [-2, -2], [2, -2], [-2, 2]].every(([dx, dy]) => hit(x + dx, y + dy))) return { x, y };
    }
    return null;
  })()`);
  assert.ok(found, 'the body is in the picture');
  return found;
}

/** Stopped at its beginning, where it is the same however fast the machine is. */
async function rest(page) {
  await page.evaluate(`(async () => { for (const what of ['pause', 'reset']) await isochorLive.send({ do: what }); })()`);
  await page.waitFor('!isochorLive.frame.info.playing && isochorLive.frame.info.step === 0 && isochorLive.frame.info.handles.length === 0');
}

async function play(page, on) {
  await page.evaluate(`isochorLive.send({ do: '${on ? 'play' : 'pause'}' })`);
  await page.waitFor(`isochorLive.frame.info.playing === ${on}`);
}

async function finish(page) {
  assert.deepEqual(page.errors, [], 'the page complains');
  await page.close();
}

/** Of the scene that all share, whatever was done to it before. */
async function viewShared(options) {
  const page = await view(shared, options);
  await page.evaluate(`(async () => { for (const what of ['reset', 'play']) await isochorLive.send({ do: what }); })()`);
  await page.waitFor('isochorLive.frame.info.playing && isochorLive.frame.info.handles.length === 0');
  return page;
}

const shared = await Live.start(...MOVING);

const tests = {
  async 'a scene starts, plays, pauses, steps and begins again'() {
    const page = await viewShared();
    await page.waitFor('isochorLive.frame.info.step > 5');
    assert.equal(await info(page, 'playing'), true);
    await page.waitFor(`/× real time, [\\d.]+ ms a step/.test(isochorLive.controls.pace.textContent)`);
    await page.key(' ');
    await page.waitFor('!isochorLive.frame.info.playing');
    const step = await info(page, 'step');
    await press(page, 'stepButton');
    await page.waitFor(`isochorLive.frame.info.step === ${step + 1}`);
    await press(page, 'resetButton');
    await page.waitFor('isochorLive.frame.info.step === 0');
    assert.equal(await info(page, 'time'), 0);
    await page.key(' ');
    await page.waitFor('isochorLive.frame.info.step > 2');
    const colors = new Set((await page.picture()).toString('latin1').match(/.{4}/gs)).size;
    assert.ok(colors > 1000, 'there is something to see');
    await finish(page);
  },

  async 'a slider moves the body, and numbers may be typed'() {
    const page = await viewShared();
    const volume = 'isochorLive.frame.info.measures[1]';
    await page.waitFor('isochorLive.frame.info.time > 1.1');
    const before = await page.evaluate(volume);
    await slide(page, 'chamber', 0);
    await page.waitFor(`isochorLive.frame.info.dials[1] < 0 && ${volume} < ${before} * 0.97`);
    await page.evaluate(`{ const { number } = ${dial('chamber')}; number.value = 12; number.dispatchEvent(new Event('change')); }`);
    await page.waitFor(`isochorLive.frame.info.dials[1] === 12000 && ${volume} > ${before}`);
    await slide(page, "Poisson\\'s ratio", 1);
    await page.waitFor('isochorLive.frame.info.dials.includes(0.5)');
    const step = await info(page, 'step');
    await page.waitFor(`isochorLive.frame.info.step > ${step} + 3 && !isochorLive.frame.info.failed`);
    await press(page, 'resetButton');
    await finish(page);
  },

  async 'a point is pulled, shows its force, and is let go; a pin stays'() {
    const page = await viewShared();
    await rest(page); // what rests is hit
    const from = await hitNear(page, await page.evaluate(ON_BODY));
    await mouse(page, 'mousePressed', from);
    await page.waitFor('isochorLive.frame.info.handles.length === 1');
    await play(page, true);
    for (const d of [10, 25, 40]) await mouse(page, 'mouseMoved', { x: from.x, y: from.y + d });
    await page.waitFor('isochorLive.frame.info.handles[0]?.force > 1e-3');
    await page.waitFor(`/\\d N|mN/.test(document.querySelector('.hand text')?.textContent ?? '')`);
    await mouse(page, 'mouseReleased', { x: from.x, y: from.y + 40 });
    await page.waitFor('isochorLive.frame.info.handles.length === 0');
    await page.key('2');
    await rest(page);
    const again = await hitNear(page, await page.evaluate(ON_BODY));
    await mouse(page, 'mousePressed', again);
    await mouse(page, 'mouseReleased', again);
    await page.waitFor(`isochorLive.frame.info.handles[0]?.kind === 'pin' && document.querySelectorAll('.held li').length === 1`);
    await page.evaluate(`document.querySelector('.held button').click()`);
    await page.waitFor('isochorLive.frame.info.handles.length === 0');
    // On the empty ground the view is turned, with any tool.
    const camera = await page.evaluate('isochorLive.stage.camera.position.toArray()');
    const { x, y } = await page.evaluate(`(({ x, y, height }) => ({ x: x + 30, y: y + height - 120 }))(isochorLive.stage.canvas.getBoundingClientRect())`);
    await mouse(page, 'mousePressed', { x, y });
    await mouse(page, 'mouseMoved', { x: x + 60, y });
    await mouse(page, 'mouseReleased', { x: x + 60, y });
    assert.notDeepEqual(await page.evaluate('isochorLive.stage.camera.position.toArray()'), camera);
    await finish(page);
  },

  async 'fields, the value under the cursor, a picture, and a link that restores the view'() {
    const page = await viewShared();
    await page.key('c');
    await page.waitFor(`isochorLive.frame.field === isochorLive.state.field.name || isochorLive.state.field.kind !== 'given'`);
    await page.evaluate(`{ const { fieldSelect } = isochorLive.controls; fieldSelect.value = isochorLive.fields.findIndex((f) => f.name === 'pressure'); fieldSelect.dispatchEvent(new Event('change')); }`);
    await page.waitFor(`isochorLive.frame.field === 'pressure' && /Mean stress/.test(document.querySelector('.legend').textContent)`);
    await rest(page); // what rests stays under the cursor
    await page.waitFor(`isochorLive.frame.field === 'pressure'`);
    const at = await hitNear(page, await page.evaluate(ON_BODY));
    await page.send('Input.dispatchMouseEvent', { type: 'mouseMoved', x: at.x, y: at.y });
    await page.waitFor(`/Pa$/.test(document.querySelector('.under-cursor:not([hidden])')?.textContent ?? '')`);
    await page.key('p');
    await page.waitFor('isochorLive.saved > 5000');
    await page.evaluate('isochorLive.stage.turn(40, 10)');
    await page.key('e');
    await page.key('l');
    await page.waitFor(`/camera=/.test(location.hash)`);
    const link = await page.evaluate('location.href');
    const camera = await page.evaluate('isochorLive.stage.camera.position.toArray()');
    await finish(page);
    const other = await browser.open(link);
    await other.waitFor('window.isochorLive?.stage.opened');
    const there = await other.evaluate('isochorLive.stage.camera.position.toArray()');
    camera.forEach((v, i) => assert.ok(Math.abs(v - there[i]) < 1e-3));
    assert.deepEqual(await other.evaluate('[isochorLive.state.field.name, isochorLive.state.edges]'), ['pressure', true]);
    await finish(other);
  },

  async 'obstacles and supports are moved, arrows drawn, bodies faded, any way cut, and the link restores it'() {
    const file = join(folder, 'two.json');
    const block = (name, x) => ({ name, mesh: { box: { lower: [x, 0, 0], upper: [x + 2, 1, 1], divisions: [4, 2, 2] } },
      materials: [{ young: 1000, poisson: 0.45, fibers: [{ direction: [1, 0, 1], k1: 10 }] }] });
    writeFileSync(file, JSON.stringify({
      name: 'two', bodies: [block('left', 0), block('right', 3)], analysis: { steps: 2 },
      dirichlet: [{ name: 'wall', where: { body: 'left', surfaces: 'x0' } }, { name: 'end', where: { body: 'right', surfaces: 'x1' } }],
      tractions: [{ name: 'weight', body: 'left', surface: 'x1', traction: [0, 0, -15] }],
      contacts: [{ name: 'table', body: 'left', obstacle: { position: [1, 0.5, -0.02] }, friction: 0.3 }],
    }));
    const live = await Live.start(file);
    const page = await view(live);
    await page.waitFor('isochorLive.frame.info.settled');
    const group = (name) => `isochorLive.controls.dials.rows.filter((row) => row.dial.group === 'Pose of ${name}')`;
    assert.deepEqual(await page.evaluate(`${group('obstacle of table')}.map((row) => row.dial.name + ' ' + row.unit)`),
      ['along x m', 'along y m', 'along z m', 'turned about x °', 'turned about y °', 'turned about z °']);
    const middle = (part) => page.evaluate(`(() => {
      const { run, frame } = isochorLive, seen = new Set();
      run.triangles.forEach((v, c) => { if (run.trianglePart[Math.floor(c / 3)] === ${part}) seen.add(v); });
      return [0, 1, 2].map((k) => [...seen].reduce((sum, v) => sum + frame.positions[3 * v + k], 0) / seen.size / run.scale);
    })()`);
    const set = async (name, k, value) => {
      await page.evaluate(`{ const { number } = ${group(name)}[${k}]; number.value = ${value}; number.dispatchEvent(new Event('change')); }`);
      await page.waitFor(`isochorLive.frame.info.dials[${group(name)}[${k}].index] === ${value} && isochorLive.frame.info.settled`);
    };
    // The table is raised and lifts the block, the other block is carried and turned.
    const [table, left, right] = [await middle(2), await middle(0), await middle(1)];
    await set('obstacle of table', 2, 0.3);
    assert.ok(Math.abs((await middle(2))[2] - table[2] - 0.3) < 1e-3, 'the table is drawn where it is');
    assert.ok((await middle(0))[2] > left[2] + 0.05, 'the block is lifted');
    await set('support end', 1, 0.5);
    const carried = await middle(1);
    assert.ok(Math.abs(carried[1] - right[1] - 0.5) < 1e-3 && Math.abs(carried[0] - right[0]) < 1e-3, 'the other one is carried');
    await set('support end', 4, 30);
    const wanted = await page.evaluate(`(() => { const a = Math.PI / 6, [x, z] = [-1, 0]; return [5 + Math.cos(a) * x + Math.sin(a) * z, 0.5 + 0.5, 0.5 - Math.sin(a) * x + Math.cos(a) * z].map((v, k) => v - isochorLive.run.center[k]); })()`);
    (await middle(1)).forEach((v, k) => assert.ok(Math.abs(v - wanted[k]) < 2e-3, `turned to ${v}, wanted ${wanted[k]}`));
    // What is carried has hardly any displacement of its own.
    await page.evaluate(`isochorLive.controls.chooseField(isochorLive.fields.find((f) => f.name === 'relative'))`);
    const apart = await page.evaluate(`(() => { const v = isochorLive, { run, frame } = v, values = run.values(frame, v.state.field), most = [0, 0];
      run.triangles.forEach((n, c) => { const p = run.trianglePart[Math.floor(c / 3)]; if (p < 2) most[p] = Math.max(most[p], values[n]); }); return most; })()`);
    assert.ok(apart[1] < 1e-4 && apart[0] > 1e-3, `${apart}`);
    // Arrows come when they are asked for.
    assert.equal(await info(page, 'forces'), 0);
    await page.key('a');
    await page.waitFor('isochorLive.frame.info.forces > 0 && isochorLive.stage.overlays.arrows.normal.geometry.instanceCount > 0');
    assert.match(await page.evaluate(`document.querySelector('.arrow-key').textContent`), /contact forces, up to [\d.]+ m?N/);
    assert.equal(await info(page, 'fibers'), 0);
    await page.evaluate('isochorLive.controls.fibers.input.click()');
    await page.waitFor('isochorLive.frame.info.fibers > 0 && isochorLive.stage.overlays.arrows.lines.visible');
    // Faded: seen through, and no longer for the hand.
    await page.key('r');
    const at = await page.evaluate(ON_BODY);
    const spot = await hitNear(page, at);
    await page.evaluate(`isochorLive.controls.lookChoices[1].node.children[1].click()`);
    assert.notEqual(await page.evaluate(`(() => { const hit = isochorLive.pickAt({ clientX: ${spot.x}, clientY: ${spot.y} }); return hit && isochorLive.run.trianglePart[hit.triangle]; })()`), 1);
    await page.key('v');
    await page.evaluate('isochorLive.stage.turn(35, -8)');
    await page.key('l');
    await page.waitFor(`/camera=/.test(location.hash)`);
    const link = await page.evaluate('location.href');
    const shown = '[isochorLive.state.field.name, isochorLive.state.looks, isochorLive.state.arrows, isochorLive.state.cut.axis, isochorLive.cutPlane().map((v) => v.toFixed(3))]';
    const before = await page.evaluate(shown);
    assert.equal(before[3], 'free');
    await finish(page);
    const other = await browser.open(link);
    await other.waitFor('window.isochorLive?.stage.opened && isochorLive.frame.info.forces > 0 && isochorLive.frame.info.fibers > 0');
    assert.deepEqual(await other.evaluate(shown), before);
    await finish(other);
    assert.deepEqual(await live.end(), { code: 0, signal: null });
  },

  async 'a roller has the ways that it holds, words stand apart, and what hardly moves is seen to move'() {
    const file = join(folder, 'roller.json');
    writeFileSync(file, JSON.stringify({
      name: 'roller', analysis: { steps: 2 }, gravity: [0, 0, -9.8],
      bodies: [{ name: 'beam', mesh: { box: { lower: [500, 0, 0], upper: [502, 0.5, 0.5], divisions: [8, 2, 2] } }, materials: [{ young: 1e10, poisson: 0.3 }] }],
      dirichlet: [{ name: 'wall', where: { surfaces: 'x0' } }, { name: 'roller', where: { surfaces: 'x1' }, directions: 'z' }],
      probes: ['one', 'two', 'three'].map((name) => ({ name, point: [501, 0.25, 0.5] })),
    }));
    const live = await Live.start(file);
    const page = await view(live);
    await page.waitFor('isochorLive.frame.info.settled');
    // It sags by less than a float has of a place 500 m away.
    const sag = `(() => { const v = isochorLive, values = v.run.values(v.frame, v.fields.find((f) => f.name === 'displacement')); return [Math.max(...values), new Set(values).size, values.length]; })()`;
    const [most, different, all] = await page.evaluate(sag);
    assert.ok(most > 1e-9 && most < 1e-5 && different > 0.5 * all, `${most}, ${different} of ${all}`);
    const rows = `isochorLive.controls.dials.rows.filter((row) => row.dial.group === 'Pose of support roller')`;
    assert.deepEqual(await page.evaluate(`${rows}.map((row) => row.dial.name)`), ['along z']);
    await page.evaluate(`{ const { number } = ${rows}[0]; number.value = 50 / 1000 * ${rows}[0].factor; number.dispatchEvent(new Event('change')); }`);
    await page.waitFor(`isochorLive.frame.info.dials[${rows}[0].index] === 0.05 && isochorLive.frame.info.settled`);
    assert.ok(Math.abs((await page.evaluate(sag))[0] - 0.05) < 0.005);
    // Forces of two hands where three probes are: no word over another.
    await page.evaluate(`(async () => {
      const { run, frame } = isochorLive, [px, py, pz] = frame.probes;
      const away = (t) => Math.hypot(...[px, py, pz].map((v, k) => v - frame.positions[3 * run.triangles[3 * t] + k]));
      const all = [...run.triangles.keys()].filter((c) => c % 3 === 0).map((c) => c / 3).sort((a, b) => away(a) - away(b));
      for (const triangle of all.slice(0, 3)) await isochorLive.send({ do: 'pull', triangle, weights: [0.98, 0.01, 0.01] });
    })()`);
    await page.waitFor('isochorLive.frame.info.handles.length === 3 && isochorLive.frame.info.settled');
    await page.evaluate(`(async () => { for (const h of isochorLive.frame.info.handles) await isochorLive.send({ do: 'move', handle: h.id, to: h.to.map((v, k) => v + (k === 2 ? 0.02 : 0)) }); })()`);
    await page.waitFor('isochorLive.frame.info.settled && isochorLive.frame.info.handles.every((h) => h.force > 0)');
    await page.evaluate('isochorLive.stage.draw(), isochorLive.hand.place()');
    const words = await page.evaluate(`[...document.querySelectorAll('.probe:not([hidden]), .hand text, .stamp, .legend, .tools')].map((node) => {
      const { left, right, top, bottom } = node.getBoundingClientRect();
      return { text: node.textContent, left, right, top, bottom };
    }).filter((b) => b.right > b.left)`);
    assert.ok(words.filter((w) => /N$/.test(w.text)).length === 3 && words.some((w) => w.text === 'one'), JSON.stringify(words));
    for (const a of words) for (const b of words) {
      if (a === b) continue;
      assert.ok(a.right <= b.left + 1 || b.right <= a.left + 1 || a.bottom <= b.top + 1 || b.bottom <= a.top + 1, `${a.text} over ${b.text}`);
    }
    await finish(page);
    await live.end();
  },

  async 'a film of what moves'() {
    const page = await viewShared();
    await page.evaluate('HTMLAnchorElement.prototype.click = function () { window.isochorSaved = this.download; }, true');
    if (await page.evaluate('isochorLive.controls.filmButton.hidden')) console.log('        this browser records no WebM');
    else {
      await press(page, 'filmButton');
      await page.waitFor('isochorLive.video.pictures > 5');
      assert.equal(await page.evaluate('isochorLive.controls.filmButton.textContent'), 'End video');
      await press(page, 'filmButton');
      await page.waitFor('isochorLive.filmed');
      const film = await page.evaluate(`(async () => { const bytes = new Uint8Array(await isochorLive.filmed.arrayBuffer()); return { magic: [...bytes.slice(0, 4)], size: bytes.length }; })()`);
      assert.deepEqual(film.magic, [0x1a, 0x45, 0xdf, 0xa3]);
      assert.ok(film.size > 3000);
      assert.match(await page.evaluate('isochorSaved'), /^finger_\d+\.webm$/);
      assert.equal(await page.evaluate('isochorLive.stage.onDrawn'), null, 'nothing goes on');
    }
    await finish(page);
  },

  async 'of two viewers one drives, and the other may take over'() {
    const first = await viewShared(), second = await view(shared, { drives: false });
    await first.waitFor('isochorLive.frame.info.viewers >= 2');
    await second.waitFor(`!isochorLive.frame.info.drives && isochorLive.controls.playButton.disabled`);
    await second.evaluate(`isochorLive.send({ do: 'reset' })`);
    await second.waitFor(`/another viewer drives/.test(document.querySelector('.notes').textContent)`);
    second.errors.length = 0; // Chromium logs the refusal
    await press(second, 'takeButton');
    await second.waitFor('isochorLive.frame.info.drives');
    await first.waitFor(`!isochorLive.frame.info.drives && !isochorLive.controls.takeButton.hidden`);
    await finish(first);
    await finish(second);
  },

  async 'a viewer that stalls holds up nobody'() {
    const page = await viewShared();
    const joined = JSON.parse((await shared.ask('/join', { method: 'POST' })).text).viewer;
    // Asks for pictures and reads none of them.
    const socket = connect(Number(shared.url.port), shared.url.hostname);
    socket.on('error', () => {});
    socket.pause();
    for (let i = 0; i < 200; ++i) {
      socket.write(`GET /picture?after=0&field=von_mises HTTP/1.1\r\nHost: ${shared.url.host}\r\nX-Isochor-Token: ${shared.token}\r\nX-Isochor-Viewer: ${joined}\r\n\r\n`);
    }
    // Another page does nothing at all.
    const asleep = await view(shared, { drives: false });
    const frozen = asleep.evaluate('{ const end = performance.now() + 1500; while (performance.now() < end); }');
    await page.evaluate(`isochorLive.send({ do: 'play' })`);
    const [step, pictures] = [await info(page, 'step'), await page.evaluate('isochorLive.pictures')];
    await page.waitFor(`isochorLive.frame.info.step > ${step} + 10 && isochorLive.pictures > ${pictures} + 5`);
    await frozen;
    // Awake, it sees the newest picture: nothing has queued up for it.
    await asleep.waitFor(`isochorLive.frame.info.step >= ${await info(page, 'step')}`);
    socket.destroy();
    await finish(asleep);
    await finish(page);
  },

  async 'a connection that is lost is found again'() {
    const page = await viewShared();
    await page.evaluate(`{ isochorLive.connection.viewer = '0'.repeat(32); }`);
    await page.waitFor(`isochorLive.connection.viewer !== '0'.repeat(32)`);
    const pictures = await page.evaluate('isochorLive.pictures');
    await page.waitFor(`isochorLive.pictures > ${pictures} + 2`);
    await page.send('Network.enable');
    const offline = (on) => page.send('Network.emulateNetworkConditions', { offline: on, latency: 0, downloadThroughput: -1, uploadThroughput: -1 });
    await offline(true);
    await page.waitFor(`/does not answer/.test(document.querySelector('.said').textContent)`);
    await offline(false);
    await page.waitFor(`!isochorLive.lost && document.querySelector('.lost') === null`);
    page.errors.length = 0; // Chromium tells of what it could not reach
    await finish(page);
  },

  async 'strangers are turned away'() {
    const wrong = await browser.open(`${shared.url.origin}/#token=${'0'.repeat(32)}`);
    await wrong.waitFor(`/token is missing or wrong/.test(document.body.textContent)`);
    await wrong.close();
    const post = { method: 'POST' };
    for (const [path, options, status] of [
      ['/join', { ...post, headers: { 'X-Isochor-Token': 'x' } }, 401],
      ['/join', { ...post, headers: { Origin: 'http://evil.example' } }, 403],
      ['/join', { ...post, headers: { Origin: 'null' } }, 403],
      ['/', { headers: { Host: 'evil.example' } }, 403],
      ['/', { headers: { Host: `evil.example:${shared.url.port}` } }, 403],
      ['/../../etc/passwd', {}, 404],
      ['/etc/passwd', {}, 404],
      ['/%2e%2e/%2e%2e/etc/passwd', {}, 404],
      ['/command', { ...post, body: 'x'.repeat(5000) }, 413],
      ['/command', { ...post, body: '{}' }, 410],
    ]) {
      const answer = await shared.ask(path, options);
      assert.equal(answer.status, status, `${path} ${JSON.stringify(options).slice(0, 80)}: ${answer.text}`);
      assert.ok(JSON.parse(answer.text).error.length > 5);
    }
    // The page of another site cannot even ask: the browser wants to know first whether it may.
    const answer = await shared.ask('/join', { method: 'OPTIONS', headers: { Origin: 'http://evil.example', 'Access-Control-Request-Method': 'POST' } });
    assert.notEqual(answer.status, 200);
    assert.equal(answer.headers['access-control-allow-origin'], undefined);
    const page = await shared.ask('/', { headers: { 'X-Isochor-Token': '' } });
    assert.equal(page.status, 200);
    assert.match(page.headers['content-security-policy'], /default-src 'none'/);
    assert.ok(!page.text.includes(shared.token));
  },

  async 'no equilibrium is said, and got over'() {
    const live = await Live.start(...SMALL, '--set', 'cavities.chamber.amount=15000', '--set', 'analysis.smallest_fraction=0.5',
      '--set', 'analysis.max_iterations=15', '--set', 'analysis.transient_rescue=false', '--set', 'analysis.steps=2');
    const page = await view(live);
    await page.waitFor('isochorLive.frame.info.settled');
    const volume = await page.evaluate('isochorLive.frame.info.measures[1]');
    await slide(page, 'chamber', 1);
    await page.waitFor(`isochorLive.frame.info.failed && document.querySelector('.said.grave').textContent.length > 20`);
    assert.match(await page.evaluate('isochorLive.controls.pace.textContent'), /waits for a change/);
    await slide(page, 'chamber', 0.3);
    await page.waitFor(`isochorLive.frame.info.settled && isochorLive.frame.info.measures[1] < ${volume} && document.querySelector('.said').hidden`);
    await finish(page);
    assert.deepEqual(await live.end(), { code: 0, signal: null });
  },

  async 'a reset has the bits of a fresh run'() {
    const scene = [...SMALL, '--set', 'analysis.steps=3'];
    const run = spawnSync(isochor, ['run', ...scene, '--json', '--quiet', '--out', join(folder, 'run')], { encoding: 'utf8' });
    const wanted = JSON.parse(run.stdout).state_hash;
    const live = await Live.start(...scene, '--paused');
    const page = await view(live);
    const steps = async () => {
      for (let i = 1; i <= 3; ++i) {
        await press(page, 'stepButton');
        await page.waitFor(`isochorLive.frame.info.step === ${i}`);
      }
      return info(page, 'hash');
    };
    assert.equal(await steps(), wanted);
    await slide(page, "Young\\'s modulus", 0.8);
    await press(page, 'stepButton');
    await page.waitFor(`isochorLive.frame.info.hash !== '${wanted}'`);
    await press(page, 'resetButton');
    await page.waitFor('isochorLive.frame.info.step === 0');
    assert.equal(await steps(), wanted);
    await finish(page);
    await live.end();
  },

  async 'Ctrl-C ends in good order, with what was recorded'() {
    const out = join(folder, 'recorded');
    const live = await Live.start(...MOVING, '--record', '--out', out, '--readonly');
    const page = await view(live, { drives: false });
    await page.waitFor('isochorLive.frame.info.recorded > 3');
    assert.equal(await page.evaluate('isochorLive.controls.takeButton.hidden && isochorLive.controls.playButton.disabled'), true);
    assert.match(await page.evaluate(`document.querySelector('.role').textContent`), /looking on/);
    assert.deepEqual(await live.end(), { code: 0, signal: null });
    const summary = JSON.parse(readFileSync(join(out, 'summary.json'), 'utf8'));
    assert.equal(summary.status, 'converged');
    const rows = readFileSync(join(out, 'steps.csv'), 'utf8').trim().split('\n').length;
    assert.ok(rows > 4);
    for (const file of ['index.html', 'finger.pvd']) assert.ok(existsSync(join(out, file)), file);
    await page.waitFor(`/does not answer/.test(document.querySelector('.said').textContent)`);
    await page.close();
  },

  async 'what cannot be started has a code and a sentence of its own'() {
    const { port } = shared.url;
    for (const [args, code, says] of [
      [['no_such_scene'], 2, /there is no scene named "no_such_scene"/],
      [[...SMALL, '--set', 'bodies[0].materials[0].young=-1'], 2, /young/],
      [[...SMALL, '--port', port], 7, new RegExp(`cannot listen on 127.0.0.1, port ${port}`)],
      [[...SMALL, '--host', '203.0.113.1'], 7, /no such address/],
      [[...SMALL, '--port', '70000'], 2, /port/],
      [[...SMALL, '--step-limit', '0'], 2, /step-limit/],
      [[...SMALL, '--record', '--out', '/proc/nowhere'], 5, /output folder \/proc\/nowhere cannot be made/],
    ]) {
      const run = spawnSync(isochor, ['live', ...args, '--no-browser'], { encoding: 'utf8', timeout: 60000 });
      assert.equal(run.status, code, `${args.join(' ')}: ${run.stderr}`);
      assert.match(run.stderr, says);
    }
  },

  async 'small windows, dark, by touch'() {
    const page = await viewShared({ width: 390, height: 800, dark: true });
    assert.ok(await page.evaluate('document.documentElement.scrollWidth <= window.innerWidth'), 'the page is wider than the window');
    await page.evaluate(`isochorLive.page.stage.scrollIntoView()`);
    await rest(page);
    const at = await hitNear(page, await page.evaluate(ON_BODY));
    await page.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [at] });
    await page.waitFor('isochorLive.frame.info.handles.length === 1');
    await play(page, true);
    for (const d of [8, 20, 30]) await page.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: [{ x: at.x, y: at.y + d }] });
    await page.waitFor('isochorLive.frame.info.handles[0]?.force > 1e-3');
    await page.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    await page.waitFor('isochorLive.frame.info.handles.length === 0');
    // Two fingers zoom, wherever they are put down, and take hold of nothing.
    await page.key('4');
    const far = () => page.evaluate('isochorLive.stage.camera.position.distanceTo(isochorLive.stage.controls.target)');
    const before = await far();
    const { x, y } = await page.evaluate(`(({ x, y, width, height }) => ({ x: x + width / 2, y: y + height / 2 }))(isochorLive.stage.canvas.getBoundingClientRect())`);
    const fingers = (type, d) => page.send('Input.dispatchTouchEvent', { type, touchPoints: type === 'touchEnd' ? [] : [{ x: x - d, y, id: 0 }, { x: x + d, y, id: 1 }] });
    await fingers('touchStart', 20);
    for (const d of [30, 45, 60]) await fingers('touchMove', d);
    await fingers('touchEnd', 0);
    assert.ok(await far() < 0.8 * before, 'the camera has come nearer');
    assert.equal(await info(page, 'handles.length'), 0);
    // Dark by the system, light by the button.
    const dark = () => page.evaluate(`getComputedStyle(document.documentElement).getPropertyValue('--dark').trim()`);
    assert.equal(await dark(), '1');
    await page.evaluate(`isochorLive.page.theme.click()`);
    assert.equal(await dark(), '0');
    await finish(page);
  },
};

let failures = 0;
try {
  const only = process.argv[3];
  for (const [name, test] of Object.entries(tests)) {
    if (only && !name.includes(only)) continue;
    const start = Date.now();
    try {
      await test();
      console.log(`ok      ${name} (${((Date.now() - start) / 1000).toFixed(1)} s)`);
    } catch (error) {
      ++failures;
      console.log(`FAILED  ${name}\n${error.stack}`);
    }
  }
  const ended = await shared.end();
  if (ended.code !== 0) {
    ++failures;
    console.log(`FAILED  the server ends with ${JSON.stringify(ended)}: ${shared.err}`);
  }
} finally {
  for (const { child } of Live.all) child.kill('SIGKILL'); // where a test has failed before its end
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures === 0 ? 0 : 1);
