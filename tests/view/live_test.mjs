// Live scenes in a real browser: played, slid, pulled, failed and got over, by several viewers, by strangers, to the end.
// Nothing here depends on how fast the machine is: what is to come is waited for.
//   node live_test.mjs path/to/isochor
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
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
  static async start(...args) {
    const live = new Live();
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

/** Somewhere within a few pixels the body is hit. */
async function hitNear(page, at) {
  return page.evaluate(`(async () => {
    const { stage, run } = isochorLive;
    const hand = isochorLive.hand;
    for (let r = 0; r < 40; r += 2) for (let k = 0; k < 12; ++k) {
      const x = ${at.x} + r * Math.cos(k), y = ${at.y} + r * Math.sin(k);
      if (isochorLive.pickAt({ clientX: x, clientY: y })) return { x, y };
    }
    return null;
  })()`);
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
    const play = async (on) => {
      await page.evaluate(`isochorLive.send({ do: '${on ? 'play' : 'pause'}' })`);
      await page.waitFor(`isochorLive.frame.info.playing === ${on}`);
    };
    await play(false); // what rests is hit
    const from = await hitNear(page, await page.evaluate(ON_BODY));
    assert.ok(from, 'the body is in the picture');
    await mouse(page, 'mousePressed', from);
    await page.waitFor('isochorLive.frame.info.handles.length === 1');
    await play(true);
    for (const d of [10, 25, 40]) await mouse(page, 'mouseMoved', { x: from.x, y: from.y + d });
    await page.waitFor('isochorLive.frame.info.handles[0]?.force > 1e-3');
    await page.waitFor(`/\\d N|mN/.test(document.querySelector('.hand text')?.textContent ?? '')`);
    await mouse(page, 'mouseReleased', { x: from.x, y: from.y + 40 });
    await page.waitFor('isochorLive.frame.info.handles.length === 0');
    await page.key('2');
    await play(false);
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
    await press(page, 'playButton'); // what rests stays under the cursor
    await page.waitFor('!isochorLive.frame.info.playing');
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
    await page.evaluate(`isochorLive.send({ do: 'pause' })`);
    await page.waitFor('!isochorLive.frame.info.playing');
    const at = await hitNear(page, await page.evaluate(ON_BODY));
    await page.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [at] });
    await page.waitFor('isochorLive.frame.info.handles.length === 1');
    await page.evaluate(`isochorLive.send({ do: 'play' })`);
    for (const d of [8, 20, 30]) await page.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: [{ x: at.x, y: at.y + d }] });
    await page.waitFor('isochorLive.frame.info.handles[0]?.force > 1e-3');
    await page.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    await page.waitFor('isochorLive.frame.info.handles.length === 0');
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
  shared.child.kill('SIGKILL');
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures === 0 ? 0 : 1);
