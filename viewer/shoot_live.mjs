#!/usr/bin/env node
// Takes a picture of a live scene, in balance or after some steps, with a spring that pulls at it.
//
//   node viewer/shoot_live.mjs OUT.png [--size 1600x1000] [--dark] [--stage] [--steps N] [--pull X,Y:DX,DY] [key=value ...] -- SCENE [options of isochor live]
//
// X,Y and DX,DY are parts of the width and height of the view; the nearest point of a body is taken. Without --steps it waits for balance (statics). --stage:
// the 3D view alone. The key=value pairs are the options of the page, as for shoot.mjs. The tool is build/isochor, or
// $ISOCHOR.
import { spawn } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Browser, MISSING, findChromium } from './chromium.mjs';

const USAGE = 'usage: shoot_live.mjs OUT.png [--size WxH] [--dark] [--stage] [--steps N] [--pull X,Y:DX,DY] [key=value ...] -- SCENE [...]';
function fail(message, code) {
  console.error(`shoot_live: ${message}`);
  process.exit(code);
}

const args = process.argv.slice(2);
const options = { out: null, width: 1600, height: 1000, dark: false, stage: false, steps: null, pull: null, hash: [], scene: [] };
while (args.length > 0) {
  const arg = args.shift();
  if (arg === '--') options.scene = args.splice(0);
  else if (arg === '--size') [options.width, options.height] = (args.shift() ?? '').split('x').map(Number);
  else if (arg === '--dark') options.dark = true;
  else if (arg === '--stage') options.stage = true;
  else if (arg === '--steps') options.steps = Number(args.shift());
  else if (arg === '--pull') options.pull = (args.shift() ?? '').split(/[,:]/).map(Number);
  else if (arg.startsWith('--')) fail(`unknown option ${arg}; ${USAGE}`, 2);
  else if (arg.includes('=')) options.hash.push(arg);
  else options.out = arg;
}
if (!options.out || options.scene.length === 0 || !(options.width > 0 && options.height > 0)
  || (options.pull && !(options.pull.length === 4 && options.pull.every(Number.isFinite)))) fail(USAGE, 2);
if (!findChromium()) fail(MISSING, 3);

const tool = process.env.ISOCHOR ?? join(dirname(fileURLToPath(import.meta.url)), '../build/isochor');
const server = spawn(tool, ['live', ...options.scene, '--no-browser'], { stdio: ['ignore', 'pipe', 'inherit'] });
const link = await new Promise((done) => {
  server.stdout.once('data', (data) => done(String(data).trim()));
  server.once('exit', (code) => fail(`isochor live has ended with ${code}`, 1));
});
server.removeAllListeners('exit');

const browser = await Browser.launch();
try {
  const page = await browser.open([link, ...options.hash].join('&'), { width: options.width, height: options.height, dark: options.dark });
  const there = async () => {
    const at = await page.evaluate('isochorLive.frame.info.step');
    await page.waitFor(options.steps === null ? 'isochorLive.frame.info.settled' : `isochorLive.frame.info.step >= ${at + options.steps}`, 600000);
  };
  await page.waitFor('window.isochorLive?.stage.opened');
  await there();
  // The camera was set for the first picture; what has moved since is brought back into it.
  if (!options.hash.some((text) => text.startsWith('camera='))) await page.evaluate('isochorLive.open(isochorLive.frame)');
  if (options.pull) {
    const box = await page.evaluate('(({ left, top, width, height }) => ({ left, top, width, height }))(isochorLive.stage.canvas.getBoundingClientRect())');
    const [wantedX, wantedY, dx, dy] = options.pull;
    // The point of a body that is nearest to the one asked for.
    const found = await page.evaluate(`(() => {
      for (let r = 0; r < 0.5; r += 0.01) for (let k = 0; k < 24; ++k) {
        const [x, y] = [${wantedX} + r * Math.cos(k * Math.PI / 12), ${wantedY} + r * Math.sin(k * Math.PI / 12)];
        const at = { clientX: ${box.left} + x * ${box.width}, clientY: ${box.top} + y * ${box.height} };
        if (document.elementFromPoint(at.clientX, at.clientY) === isochorLive.stage.canvas && isochorLive.pickAt(at)) return [x, y];
      }
      return null;
    })()`);
    if (!found) throw new Error('no body is near the point to pull at');
    const [x, y] = found;
    const mouse = (type, s) => page.send('Input.dispatchMouseEvent', {
      type, x: box.left + (x + s * dx) * box.width, y: box.top + (y + s * dy) * box.height, button: 'left', buttons: 1, clickCount: 1,
    });
    await mouse('mousePressed', 0);
    await page.waitFor('isochorLive.frame.info.handles.length === 1');
    const to = 'isochorLive.frame.info.handles[0].to.join()';
    for (const s of [0.25, 0.5, 0.75, 1]) {
      const before = await page.evaluate(to);
      await mouse('mouseMoved', s);
      await page.waitFor(`${to} !== '${before}'`, 600000);
    }
    await there();
  }
  // At rest it is drawn at its best.
  if (options.steps !== null) {
    await page.evaluate(`isochorLive.send({ do: 'pause' })`);
    await page.waitFor('!isochorLive.frame.info.playing');
  }
  await page.waitFor('!isochorLive.rangeTimer'); // the numbers beside the colors come a moment later
  await page.evaluate('isochorLive.stage.draw(), isochorLive.hand.place()');
  const clip = options.stage ? await page.evaluate('(({ x, y, width, height }) => ({ x, y, width, height }))(document.querySelector(".stage").getBoundingClientRect())') : undefined;
  writeFileSync(options.out, await page.picture({ clip }));
  if (page.errors.length > 0) fail(page.errors.join('\n'), 1);
} finally {
  await browser.close();
  server.kill('SIGINT');
}
