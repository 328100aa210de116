#!/usr/bin/env node
// Measures a live scene in headless Chromium with software rendering: the time from a moved slider to a changed picture,
// pictures a second, and what the server costs the world. Times are medians; the world is in motion all the while.
//
//   node viewer/measure_live.mjs [--size 1280x800] [--slides N] [--seconds N] -- SCENE [options of isochor live]
//
// What the server costs is the processor time of the whole process for a step, "as fast as it can", without viewers against
// that with one who takes every picture with a field of stresses, in turns, five times each: on a quiet machine that is
// what the step rate loses, and on a busy one it still says so. That viewer is this script, which draws nothing: a browser
// that draws by the processor takes more of the machine than any server. The tool is build/isochor, or
// $ISOCHOR.
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Browser, MISSING, findChromium } from './chromium.mjs';

const USAGE = 'usage: measure_live.mjs [--size WxH] [--slides N] [--seconds N] -- SCENE [...]';
function fail(message, code) {
  console.error(`measure_live: ${message}`);
  process.exit(code);
}

let [width, height] = [1280, 800];
let [slides, seconds] = [40, 6];
let scene = [];
const args = process.argv.slice(2);
while (args.length > 0) {
  const arg = args.shift();
  if (arg === '--') scene = args.splice(0);
  else if (arg === '--size') [width, height] = (args.shift() ?? '').split('x').map(Number);
  else if (arg === '--slides') slides = Number(args.shift());
  else if (arg === '--seconds') seconds = Number(args.shift());
  else fail(`unknown option ${arg}; ${USAGE}`, 2);
}
if (scene.length === 0 || !(width > 0 && height > 0 && slides > 0 && seconds > 0)) fail(USAGE, 2);
if (!findChromium()) fail(MISSING, 3);

const tool = process.env.ISOCHOR ?? join(dirname(fileURLToPath(import.meta.url)), '../build/isochor');
async function start() {
  const server = spawn(tool, ['live', ...scene, '--no-browser'], { stdio: ['ignore', 'pipe', 'ignore'] });
  const link = await new Promise((done) => {
    server.stdout.once('data', (data) => done(String(data).trim()));
    server.once('exit', (code) => fail(`isochor live has ended with ${code}`, 1));
  });
  server.removeAllListeners('exit');
  return { server, link };
}

const pause = (s) => new Promise((done) => setTimeout(done, 1000 * s));
const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];

/** Processor time of a process so far [s]. */
function spent(pid) {
  const text = readFileSync(`/proc/${pid}/stat`, 'utf8');
  const fields = text.slice(text.lastIndexOf(')') + 2).split(' ');
  return (Number(fields[11]) + Number(fields[12])) / 100;
}

/** Steps a second, and processor time a step, with and without a viewer who takes all that there is. */
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
  const rate = async (watched) => {
    // Fields that nobody asks for are left out after a while.
    await pause(4);
    const [first, from, cpu] = [await picture(''), performance.now(), spent(server.pid)];
    let pictures = 0;
    while (watched && performance.now() - from < 1000 * seconds) {
      await picture('von_mises');
      ++pictures;
    }
    if (!watched) await pause(seconds);
    const last = await picture('');
    const took = (performance.now() - from) / 1000, steps = last.step - first.step;
    return { steps: steps / took, pictures: pictures / took, each: (1000 * (spent(server.pid) - cpu)) / steps };
  };
  await pause(2);
  const alone = [], watched = [];
  for (let i = 0; i < 5; ++i) {
    alone.push(await rate(false));
    watched.push(await rate(true));
  }
  server.kill('SIGINT');
  const of = (rounds) => Object.fromEntries(['steps', 'pictures', 'each'].map((key) => [key, median(rounds.map((r) => r[key]))]));
  return { alone: of(alone), watched: of(watched) };
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

const { alone, watched } = await cost();
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
  console.log(`server     ${alone.each.toFixed(2)} ms of processor time a step alone, ${watched.each.toFixed(2)} with a viewer who takes ${watched.pictures.toFixed(1)} pictures `
    + `a second: ${(100 * (watched.each / alone.each - 1)).toFixed(1)} % (${alone.steps.toFixed(0)} and ${watched.steps.toFixed(0)} steps a second)`);
} finally {
  await browser.close();
  server.kill('SIGINT');
}
