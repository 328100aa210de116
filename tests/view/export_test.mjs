// A scene as one page, in a real browser from a file: it runs there without a server and asks nobody for anything.
//   node export_test.mjs path/to/isochor path/to/folder_of_the_engine
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { Browser, MISSING, findChromium } from '../../viewer/chromium.mjs';

const [isochor, engine] = process.argv.slice(2);
const skip = (why) => { console.log(`SKIPPED: ${why}`); process.exit(77); };
if (!existsSync(join(engine, 'isochor_live_engine.wasm'))) skip(`there is no engine in ${engine}; live/wasm/build.sh makes it, with Emscripten`);
if (!findChromium()) skip(MISSING);

const folder = mkdtempSync(join(tmpdir(), 'isochor-export-'));
// A beam of few tetrahedra, from a file: what runs here takes its time where the machine has other work.
const mesh = join(dirname(fileURLToPath(import.meta.url)), '../../scenes/meshes/cantilever_1.msh');
const beam = join(folder, 'beam.json');
writeFileSync(beam, JSON.stringify({
  name: 'beam', bodies: [{ name: 'beam', mesh: { file: mesh }, materials: [{ young: 1e5, poisson: 0.5 }] }],
  analysis: { type: 'dynamic', step: 0.01, duration: 10 }, gravity: [0, -9.8, 0],
  dirichlet: [{ name: 'wall', where: { surfaces: 'clamped' } }],
}));
const SMALL = [beam];

function run(...args) {
  const ended = spawnSync(isochor, args, { encoding: 'utf8', env: { ...process.env, ISOCHOR_LIVE_WASM: engine } });
  assert.equal(ended.status, 0, ended.stderr);
  return ended;
}

function exported(name, ...args) {
  const file = join(folder, `${name}.html`);
  run('live', ...args, '--export', file);
  return file;
}

const browser = await Browser.launch();

async function open(file) {
  const page = await browser.open(pathToFileURL(file).href, { width: 900, height: 640 });
  await page.waitFor('window.isochorLive?.frame && window.isochorLive.stage.opened');
  return page;
}

async function finish(page) {
  assert.deepEqual(page.errors, [], 'the page complains');
  await page.close();
}

const info = (page, what) => page.evaluate(`isochorLive.frame.info.${what}`);
const send = (page, command) => page.evaluate(`isochorLive.connection.send(${JSON.stringify(command)})`);
const dial = (page, group, name) => page.evaluate(`isochorLive.run.head.dials.findIndex((d) => d.group === '${group}' && d.name === '${name}')`);

async function stepTo(page, step) {
  while (await info(page, 'step') < step) {
    const next = await info(page, 'step') + 1;
    assert.equal(await send(page, { do: 'step' }), null);
    await page.waitFor(`isochorLive.frame.info.step === ${next}`);
  }
  return info(page, 'hash');
}

const tests = {
  async 'the page runs, begins again with the same bits, and loads nothing'() {
    const file = exported('beam', ...SMALL);
    assert.ok(!readFileSync(file, 'utf8').includes(folder), 'the page does not say where its files were');
    const page = await open(file);
    await page.waitFor('isochorLive.frame.info.playing && isochorLive.frame.info.step > 3');
    assert.equal(await page.evaluate('isochorLive.controls.recordButton.hidden'), true, 'there is no folder to record into');
    for (const what of ['pause', 'reset']) await send(page, { do: what });
    await page.waitFor('!isochorLive.frame.info.playing && isochorLive.frame.info.step === 0');
    const rest = await info(page, 'hash');
    const moved = await stepTo(page, 3);
    assert.notEqual(moved, rest);
    await send(page, { do: 'reset' });
    await page.waitFor('isochorLive.frame.info.step === 0');
    assert.equal(await info(page, 'hash'), rest);
    assert.equal(await stepTo(page, 3), moved);
    const foreign = await page.evaluate(`performance.getEntriesByType('resource').map((r) => r.name).filter((name) => !/^(blob|data):/.test(name))`);
    assert.deepEqual(foreign, []);
    await finish(page);
  },

  async 'a slider and a hand change what runs, and what is refused says why'() {
    const page = await open(exported('paused', ...SMALL, '--paused'));
    assert.equal(await info(page, 'playing'), false);
    assert.equal(await info(page, 'step'), 0);
    const pull = await dial(page, 'Gravity', 'y');
    assert.equal(await send(page, { do: 'set', control: pull, value: 5 }), null);
    assert.equal(await send(page, { do: 'pull', triangle: 0, weights: [0.4, 0.3, 0.3] }), null);
    await send(page, { do: 'play' });
    await page.waitFor(`isochorLive.frame.info.step > 5 && isochorLive.frame.info.handles.length === 1 && isochorLive.frame.info.dials[${pull}] === 5`);
    assert.match(await send(page, { do: 'set', control: pull }), /needs the key value/);
    assert.match(await send(page, { do: 'fly' }), /there are take, play/);
    await page.waitFor('isochorLive.frame.field === isochorLive.asked'); // stresses come as well
    await finish(page);
  },

  async 'a support that holds one direction is led along it by its slider, in the browser as anywhere'() {
    const file = join(folder, 'led.json');
    writeFileSync(file, JSON.stringify({
      name: 'led', analysis: { steps: 2 },
      bodies: [{ name: 'block', mesh: { box: { upper: [2, 1, 1], divisions: [2, 1, 1] } }, materials: [{ young: 1000, poisson: 0.5 }] }],
      dirichlet: [{ name: 'wall', where: { surfaces: 'x0' } }, { name: 'end', where: { surfaces: 'x1' }, directions: [[0, 3, 4]] }],
    }));
    const page = await open(exported('led', file));
    await page.waitFor('isochorLive.frame.info.settled');
    const led = await dial(page, 'Pose of support end', 'along (0, 0.6, 0.8)');
    assert.ok(led >= 0, await page.evaluate(`isochorLive.run.head.dials.map((d) => d.group + ': ' + d.name).join()`));
    assert.equal(await send(page, { do: 'set', control: led, value: 0.25 }), null);
    await page.waitFor(`isochorLive.frame.info.settled && isochorLive.frame.info.dials[${led}] === 0.25`);
    // Every point of the end has gone as far as that, and some have slid across.
    const ways = await page.evaluate(`(() => {
      const { run, frame: { moved } } = isochorLive, right = Math.max(...run.rest.filter((_, i) => i % 3 === 0)), out = [];
      for (let v = 0; v < run.bodyVertices; ++v) if (run.rest[3 * v] > right - 1e-6) out.push([0.6 * moved[3 * v + 1] + 0.8 * moved[3 * v + 2], moved[3 * v]]);
      return out;
    })()`);
    assert.ok(ways.length >= 4);
    for (const [along] of ways) assert.ok(Math.abs(along - 0.25) < 1e-6, `${along}`);
    assert.ok(ways.some(([, across]) => Math.abs(across) > 1e-3));
    await finish(page);
  },
};

let failures = 0;
try {
  const only = process.argv[4];
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
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures === 0 ? 0 : 1);
