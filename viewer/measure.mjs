#!/usr/bin/env node
// Measures a results page in headless Chromium with software rendering: size, time from setting out for
// the page to its first picture (in a new browser, then in one that has opened pages before), pictures a second while
// every frame is shown in turn. Each is the best of three. Beside wall time stands the processor time of all of the
// browser, which a busy machine stretches less, and what an empty page takes.
//
// --quality holds how finely moving pictures are drawn: 0 is the best, 3 the quickest (web/src/pace.js).
//
//   node viewer/measure.mjs PAGE.html [--size 1600x1000] [--seconds 4] [--quality N]
import { existsSync, readFileSync, readdirSync, statSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser, MISSING, findChromium } from './chromium.mjs';

function fail(message, code) {
  console.error(`measure: ${message}`);
  process.exit(code);
}

const USAGE = 'usage: measure.mjs PAGE.html [--size WxH] [--seconds N] [--quality N]';
const files = [];
let [width, height] = [1600, 1000];
let seconds = 4;
let quality = null;
const args = process.argv.slice(2);
while (args.length > 0) {
  const arg = args.shift();
  if (arg === '--size') [width, height] = (args.shift() ?? '').split('x').map(Number);
  else if (arg === '--seconds') seconds = Number(args.shift());
  else if (arg === '--quality') quality = Number(args.shift());
  else if (arg.startsWith('--')) fail(`unknown option ${arg}; ${USAGE}`, 2);
  else files.push(arg);
}
if (files.length !== 1 || !existsSync(files[0]) || !(width > 0 && height > 0 && seconds > 0 && [null, 0, 1, 2, 3].includes(quality))) fail(USAGE, 2);
if (!findChromium()) fail(MISSING, 3);

/** Processor time [s] of the browser and its helpers so far; NaN where there is no /proc. */
function processorTime(group) {
  let ticks = NaN;
  try {
    for (const entry of readdirSync('/proc')) {
      if (!/^\d+$/.test(entry)) continue;
      try {
        const text = readFileSync(`/proc/${entry}/stat`, 'utf8');
        const fields = text.slice(text.lastIndexOf(')') + 2).split(' ');
        if (Number(fields[2]) !== group) continue;
        ticks = (Number.isNaN(ticks) ? 0 : ticks) + Number(fields[11]) + Number(fields[12]);
      } catch { /* it has ended */ }
    }
  } catch { /* not Linux */ }
  return ticks / 100;
}

let browser;
const spent = () => processorTime(browser.child.pid);
const drawn = 'requestAnimationFrame(() => requestAnimationFrame(() => { window.isochorReady = true; window.isochorOpened = performance.now(); }))';
const EMPTY = `data:text/html,<p>empty</p><script>${drawn}</script>`;
const PAGE = `${pathToFileURL(resolve(files[0]))}#`;

/** Opens a page; wall: from setting out for it to its first picture. */
async function open(url) {
  const cpu = spent();
  const page = await browser.open(url, { width, height });
  await page.waitFor('window.isochorReady === true');
  const error = await page.evaluate('window.isochorError ?? null');
  if (error) throw new Error(error);
  return { page, wall: await page.evaluate('window.isochorOpened / 1000'), cpu: spent() - cpu };
}

/** As the first page of a new browser, which still has to start much of itself. */
async function openFirst(url) {
  browser = await Browser.launch();
  try {
    return await open(url);
  } finally {
    await browser.close();
  }
}

async function openAgain(url) {
  const opened = await open(url);
  await opened.page.close();
  return opened;
}

/** The best of three: what else the machine does only ever slows it down. */
async function best(how, url) {
  const tries = [await how(url), await how(url), await how(url)];
  return { wall: Math.min(...tries.map((t) => t.wall)), cpu: Math.min(...tries.map((t) => t.cpu)) };
}

const text = ({ wall, cpu }) => `${wall.toFixed(2)} s${Number.isNaN(cpu) ? '' : ` (${cpu.toFixed(2)} s of processor time)`}`;

try {
  const first = [await best(openFirst, EMPTY), await best(openFirst, PAGE)];
  browser = await Browser.launch();
  const { page } = await open(PAGE);
  const again = [await best(openAgain, EMPTY), await best(openAgain, PAGE)];
  // As the page plays, without its limit of pictures a second. Each goes the whole way, to the window: the browser
  // asks for the next when it has shown the last.
  const play = (length) => page.evaluate(`(async () => {
    const { stage, run, state } = window.isochorViewer;
    state.playing = true;
    stage.setPlaying(true);
    let pictures = 0;
    const gl = stage.renderer.getContext();
    const pixel = new Uint8Array(4);
    const start = performance.now();
    while (performance.now() - start < ${1000 * length}) {
      await new Promise((shown) => requestAnimationFrame(shown));
      await window.isochorViewer.advance();
      ++pictures;
    }
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits for the last of them
    const seconds = (performance.now() - start) / 1000;
    state.playing = false;
    stage.setPlaying(false);
    return { seconds, pictures, frames: run.frameCount, quality: stage.pace.quality, canvas: [stage.canvas.width, stage.canvas.height],
      triangles: stage.renderer.info.render.triangles, surface: run.head.triangles };
  })()`);
  if (quality !== null) await page.evaluate(`{ const { pace } = isochorViewer.stage; pace.quality = ${quality}; pace.took = () => {}; }`);
  await play(3); // unpacks frames, the renderer compiles what it needs, and the page finds its pace
  let played = null, each = Infinity;
  for (let i = 0; i < 3; ++i) {
    const before = spent();
    const round = await play(seconds);
    each = Math.min(each, (spent() - before) / round.pictures); // NaN stays
    if (!played || round.pictures / round.seconds > played.pictures / played.seconds) played = round;
  }
  console.log(`size       ${(statSync(files[0]).size / 1e6).toFixed(2)} MB`);
  console.log(`opens in   ${text(first[1])} in a new browser, an empty page ${text(first[0])}`);
  console.log(`           ${text(again[1])} in a warm one, an empty page ${text(again[0])}`);
  const { frames, canvas, triangles, surface } = played;
  console.log(`plays      ${(played.pictures / played.seconds).toFixed(1)} pictures a second, ${frames} frames, `
    + `${surface} triangles (${triangles} drawn), ${width} x ${height} (canvas ${canvas.join(' x ')}, quality ${played.quality})`
    + `${Number.isNaN(each) ? '' : `, ${(1000 * each).toFixed(0)} ms of processor time each`}`);
} finally {
  await browser.close();
}
