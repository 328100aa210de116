#!/usr/bin/env node
// Measures a live scene in headless Chromium with software rendering: the time from a moved slider to a changed picture,
// pictures a second, and what the server costs the world. Times are medians; the world is in motion all the while.
//
//   node viewer/measure_live.mjs [--size 1280x800] [--slides N] [--seconds N] [--page] -- SCENE [options of isochor live]
//
// --page: of the page alone what a picture takes, while the world stands still: for scenes whose steps take long.
//
// What the server costs a step is the time that the world's thread spends on pictures over that on steps, and the processor
// time of the threads that talk to viewers over that of all others: shares, which a busy machine stretches alike. The
// viewer takes every picture with a field of stresses, "as fast as it can", and is this script, which draws nothing: a
// browser that draws by the processor takes more of the machine than any server. The tool is build/isochor, or $ISOCHOR.
import { spawn } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Browser, MISSING, findChromium } from './chromium.mjs';

const USAGE = 'usage: measure_live.mjs [--size WxH] [--slides N] [--seconds N] [--page] -- SCENE [...]';
function fail(message, code) {
  console.error(`measure_live: ${message}`);
  process.exit(code);
}

let [width, height] = [1280, 800];
let [slides, seconds] = [40, 6];
let scene = [], pageAlone = false;
const args = process.argv.slice(2);
while (args.length > 0) {
  const arg = args.shift();
  if (arg === '--') scene = args.splice(0);
  else if (arg === '--page') pageAlone = true;
  else if (arg === '--size') [width, height] = (args.shift() ?? '').split('x').map(Number);
  else if (arg === '--slides') slides = Number(args.shift());
  else if (arg === '--seconds') seconds = Number(args.shift());
  else fail(`unknown option ${arg}; ${USAGE}`, 2);
}
if (scene.length === 0 || !(width > 0 && height > 0 && slides > 0 && seconds > 0)) fail(USAGE, 2);
if (!findChromium()) fail(MISSING, 3);

const tool = process.env.ISOCHOR ?? join(dirname(fileURLToPath(import.meta.url)), '../build/isochor');
async function start() {
  const server = spawn(tool, ['live', ...scene, '--no-browser', ...(pageAlone ? ['--paused'] : [])], { stdio: ['ignore', 'pipe', 'ignore'] });
  const link = await new Promise((done) => {
    server.stdout.once('data', (data) => done(String(data).trim()));
    server.once('exit', (code) => fail(`isochor live has ended with ${code}`, 1));
  });
  server.removeAllListeners('exit');
  return { server, link };
}

const pause = (s) => new Promise((done) => setTimeout(done, 1000 * s));
const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];

/** Processor time so far of the threads that talk to viewers, and of all others [s]. */
function spent(pid) {
  const out = { http: 0, other: 0 };
  for (const task of readdirSync(`/proc/${pid}/task`)) {
    const read = (file) => readFileSync(`/proc/${pid}/task/${task}/${file}`, 'utf8');
    try { out[read('comm').trim() === 'isochor-http' ? 'http' : 'other'] += Number(read('schedstat').split(' ')[0]) / 1e9; } catch { /* it has ended */ }
  }
  return out;
}

/** What a viewer who takes all that there is costs. */
async function cost() {
  const { server, link } = await start();
  const url = new URL(link);
  const headers = { 'X-Isochor-Token': url.hash.slice('#token='.length) };
  const ask = (path, options = {}) => fetch(`${url.origin}${path}`, { ...options, headers });
  headers['X-Isochor-Viewer'] = (await (await ask('/join', { method: 'POST' })).json()).viewer;
  let number = 0;
  const picture = async (field) => {
    const bytes = Buffer.from(await (await ask(`/picture?after=${number}&field=${field}`)).arrayBuffer());
    const head = JSON.parse(bytes.subarray(4, 4 + bytes.readUInt32LE(0)));
    number = head.number;
    return head;
  };
  await ask('/command', { method: 'POST', body: JSON.stringify({ do: 'speed', value: 1000 }) });
  await pause(2);
  await picture('von_mises');
  const [first, before, from] = [await picture('von_mises'), spent(server.pid), performance.now()];
  let last = first, pictures = 0;
  for (; performance.now() - from < 3000 * seconds; ++pictures) last = await picture('von_mises');
  const took = (performance.now() - from) / 1000, after = spent(server.pid);
  server.kill('SIGINT');
  return {
    pictures: pictures / took, steps: (last.step - first.step) / took,
    made: (last.spent[1] - first.spent[1]) / (last.spent[0] - first.spent[0]),
    sent: (after.http - before.http) / (after.other - before.other),
  };
}

/** From the event of the slider to the end of the drawing of a picture that has its value. */
const SLIDE = (index, t) => `new Promise((done) => {
  const { slider } = isochorLive.controls.dials.rows[${index}];
  const { show } = LiveProto, start = performance.now();
  slider.value = ${t};
  slider.dispatchEvent(new Event('input'));
  const wanted = isochorLive.controls.dials.rows[${index}].shown;
  const step = isochorLive.frame.info.step;
  isochorLive.show = function (frame) {
    show.call(this, frame);
    if (frame.info.dials[${index}] !== wanted || frame.info.step <= step) return;
    delete this.show;
    const gl = this.stage.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits until it is drawn
    done(performance.now() - start);
  };
})`;

/** Medians of seven, in ms: shape and colors, shadows, a pick, and drawing at each quality until it is done. */
const PAGE = `(() => {
  const viewer = isochorLive, { stage, frame } = viewer, gl = stage.renderer.getContext(), out = {};
  const time = (name, work) => {
    const all = [];
    for (let i = 0; i < 7; ++i) {
      const start = performance.now();
      work();
      all.push(performance.now() - start);
    }
    out[name] = all.sort((a, b) => a - b)[3];
  };
  time('shape and colors', () => { stage.body.setShape(frame.positions); viewer.showField(); });
  time('shadows', () => { stage.body.shadedShape = null; stage.shade(false); });
  time('a pick', () => viewer.pickAt({ clientX: window.innerWidth / 2, clientY: window.innerHeight / 2 }));
  for (const quality of [0, 1, 2, 3]) time('drawing, quality ' + quality, () => { stage.drawAt(quality); gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); });
  return { triangles: viewer.run.head.triangles, out };
})()`;

async function measurePage() {
  const { server, link } = await start();
  const browser = await Browser.launch();
  try {
    const page = await browser.open(link, { width, height });
    await page.waitFor('window.isochorLive?.stage.opened && isochorLive.frame.field !== null');
    await pause(1);
    const { triangles, out } = await page.evaluate(PAGE);
    console.log(`${triangles} triangles, ${width} x ${height}, medians of 7`);
    for (const [what, ms] of Object.entries(out)) console.log(`${what.padEnd(20)} ${ms.toFixed(1)} ms`);
  } finally {
    await browser.close();
    server.kill('SIGINT');
  }
}

if (pageAlone) {
  await measurePage();
  process.exit(0);
}
const costs = await cost();
const { server, link } = await start();
const browser = await Browser.launch();
try {
  const page = await browser.open(link, { width, height });
  await page.waitFor('window.isochorLive?.stage.opened && isochorLive.frame.info.step > 20');
  await page.evaluate('window.LiveProto = Object.getPrototypeOf(isochorLive), true');
  await pause(3); // the page finds its pace
  const times = [];
  for (let i = 0; i < slides; ++i) {
    times.push(await page.evaluate(SLIDE(1, 500 + 100 * (i % 3))));
    await pause(0.15 + 0.01 * (i % 7));
  }
  const rate = await page.evaluate(`(async () => {
    const before = isochorLive.pictures, start = performance.now();
    await new Promise((done) => setTimeout(done, ${1000 * seconds}));
    const { info } = isochorLive.frame;
    return { pictures: (isochorLive.pictures - before) / (performance.now() - start) * 1000, steps: info.perSecond, factor: info.factor, ms: info.stepMs,
      triangles: isochorLive.run.head.triangles, quality: isochorLive.stage.pace.quality };
  })()`);
  console.log(`slider     ${median(times).toFixed(0)} ms to a changed picture (median of ${slides}; the slowest ${Math.max(...times).toFixed(0)} ms)`);
  console.log(`pictures   ${rate.pictures.toFixed(1)} a second of ${rate.triangles} triangles, ${width} x ${height}, quality ${rate.quality}, while the world makes `
    + `${rate.steps.toFixed(1)} steps a second of ${rate.ms.toFixed(1)} ms`);
  console.log(`server     ${(100 * costs.made).toFixed(1)} % of the steps for making and ${(100 * costs.sent).toFixed(1)} % for sending ${costs.pictures.toFixed(1)} pictures a second, `
    + `${costs.steps.toFixed(0)} steps a second`);
} finally {
  await browser.close();
  server.kill('SIGINT');
}
