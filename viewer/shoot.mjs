#!/usr/bin/env node
// Takes a picture of a results page.
//
//   node viewer/shoot.mjs PAGE.html OUT.png [--size 1600x1000] [--scale 2] [--page] [--dark] [key=value ...]
//
// Without --page the picture shows the 3D view and its legend; with it the page as a reader sees it, at full
// length. The key=value pairs are the options of the page:
//   field=NAME  frame=first|last|N|t=SECONDS  view=iso|front|back|left|right|top|bottom|AZIMUTH,ELEVATION
//   zoom=1.2  camera=X,Y,Z,X,Y,Z  ghost=1  edges=1  arrows=forces,fibers  hide=0,2  fade=1 (parts from 0)
//   cut=auto|x|y|z|AROUND/UP in degrees (cut=x:0.5 at a place, cut=-x:0.5 keeps the other half)
//   range=LOW,HIGH|frame  span=all|98|90 (percent of the values that colors span)  legend=0  labels=0  theme=light|dark
// Options that are unknown or have a value they cannot have are refused, with what there is.
import { existsSync, renameSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser, MISSING, findChromium } from './chromium.mjs';

function fail(message, code = 1) {
  console.error(`shoot: ${message}`);
  process.exit(code);
}

const files = [];
const query = [];
let size = [1600, 1000];
let scale = 1;
let whole = false;
let dark = false;
const args = process.argv.slice(2);
while (args.length > 0) {
  const arg = args.shift();
  if (arg === '--size') size = (args.shift() ?? '').split('x').map(Number);
  else if (arg === '--scale') scale = Number(args.shift());
  else if (arg === '--page') whole = true;
  else if (arg === '--dark') dark = true;
  else if (arg.startsWith('--')) fail(`unknown option ${arg}`, 2);
  else if (files.length < 2) files.push(arg);
  else if (arg.includes('=')) query.push(arg);
  else fail(`expected key=value, got "${arg}"`, 2);
}
if (files.length < 2) fail('usage: shoot.mjs PAGE.html OUT.png [--size WxH] [--scale N] [--page] [--dark] [key=value ...]', 2);
if (size.length !== 2 || !size.every((v) => v >= 16 && v <= 8000)) fail('--size wants WIDTHxHEIGHT in pixels', 2);
if (!(scale > 0 && scale <= 4)) fail('--scale wants a number up to 4', 2);
if (!existsSync(files[0])) fail(`there is no ${files[0]}`, 2);
if (!findChromium()) fail(MISSING, 3);

const hash = [...(whole ? [] : ['shot=1']), ...query].map((pair) => {
  const at = pair.indexOf('=');
  return `${pair.slice(0, at)}=${encodeURIComponent(pair.slice(at + 1))}`;
}).join('&');
const browser = await Browser.launch();
let problem = null;
let refused = [];
try {
  const page = await browser.open(`${pathToFileURL(resolve(files[0]))}#${hash}`, { width: size[0], height: size[1], scale, dark });
  await page.waitFor('window.isochorReady === true');
  const error = await page.evaluate('window.isochorError ?? null');
  if (error) throw new Error(`the page cannot show its results: ${error}\n${page.errors.join('\n')}`);
  refused = await page.evaluate('window.isochorProblems ?? []');
  if (refused.length > 0) throw new Error(refused.join('\nshoot: '));
  if (whole) {
    // Charts below the window wait until they are seen.
    await page.evaluate('window.isochorViewer?.plots?.drawAll()');
    const height = await page.evaluate('Math.ceil(document.documentElement.scrollHeight)');
    await page.resize(size[0], height, scale);
    await page.evaluate('new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))');
  }
  const picture = await page.picture();
  // Renamed into place: whoever waits for the file never reads half of it.
  writeFileSync(`${files[1]}.part`, picture);
  renameSync(`${files[1]}.part`, files[1]);
  for (const text of page.errors) console.error(`page: ${text}`);
} catch (error) {
  problem = error.message;
} finally {
  await browser.close();
}
if (problem) fail(problem, refused.length > 0 ? 2 : 1);
