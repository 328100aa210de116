#!/usr/bin/env node
// Measures a results page in headless Chromium with software rendering: size, time until it can be used, pictures a
// second while every frame is shown in turn.
//
//   node viewer/measure.mjs PAGE.html [--size 1600x1000]
import { existsSync, statSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser, MISSING, findChromium } from './chromium.mjs';

const args = process.argv.slice(2);
const at = args.indexOf('--size');
const [width, height] = at < 0 ? [1600, 1000] : args.splice(at, 2)[1].split('x').map(Number);
const [file] = args;
if (!file || !existsSync(file) || !(width > 0 && height > 0)) {
  console.error('measure: usage: measure.mjs PAGE.html [--size WxH]');
  process.exit(2);
}
if (!findChromium()) {
  console.error(`measure: ${MISSING}`);
  process.exit(3);
}

const browser = await Browser.launch();
try {
  const start = performance.now();
  const page = await browser.open(`${pathToFileURL(resolve(file))}#`, { width, height });
  await page.waitFor('window.isochorReady === true');
  const opened = performance.now() - start;
  const error = await page.evaluate('window.isochorError ?? null');
  if (error) throw new Error(error);
  const played = await page.evaluate(`(async () => {
    const viewer = window.isochorViewer, { stage, run, state } = viewer;
    const gl = stage.renderer?.getContext?.();
    const pixel = new Uint8Array(4);
    let pictures = 0;
    const start = performance.now();
    while (performance.now() - start < 4000) {
      state.frame = pictures % run.frameCount;
      await viewer.showFrame();
      stage.draw();
      // Waits until it has been drawn.
      gl?.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      ++pictures;
    }
    return { seconds: (performance.now() - start) / 1000, pictures, frames: run.frameCount, waits: Boolean(gl) };
  })()`);
  const triangles = await page.evaluate('window.isochorViewer.stage.renderer?.info?.render?.triangles ?? 0');
  console.log(`size       ${(statSync(file).size / 1e6).toFixed(2)} MB`);
  console.log(`opens in   ${(opened / 1000).toFixed(2)} s`);
  console.log(`plays      ${(played.pictures / played.seconds).toFixed(1)} pictures a second, ${played.frames} frames, ${triangles} triangles drawn, ${width} x ${height}${played.waits ? '' : ' (not waited for)'}`);
} finally {
  await browser.close();
}
