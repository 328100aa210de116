// A scene as one page, in a real browser from a file: it runs there without a server and asks nobody for anything.
//   node export_test.mjs path/to/isochor path/to/folder_of_the_engine
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser, MISSING, findChromium } from '../../viewer/chromium.mjs';

const [isochor, engine] = process.argv.slice(2);
const skip = (why) => { console.log(`SKIPPED: ${why}`); process.exit(77); };
if (!existsSync(join(engine, 'isochor_live_engine.wasm'))) skip(`there is no engine in ${engine}; live/wasm/build.sh makes it, with Emscripten`);
if (!findChromium()) skip(MISSING);

const folder = mkdtempSync(join(tmpdir(), 'isochor-export-'));
const SMALL = ['finger', '--dynamic', '--set', 'bodies[0].mesh.file=meshes/finger_small.msh'];

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
const dial = (page, name) => page.evaluate(`isochorLive.run.head.dials.findIndex((d) => d.name === '${name}')`);

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
    const page = await open(exported('finger', ...SMALL));
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
    const chamber = await dial(page, 'chamber');
    assert.equal(await send(page, { do: 'set', control: chamber, value: 4000 }), null);
    assert.equal(await send(page, { do: 'pull', triangle: 0, weights: [0.4, 0.3, 0.3] }), null);
    await send(page, { do: 'play' });
    await page.waitFor(`isochorLive.frame.info.step > 5 && isochorLive.frame.info.handles.length === 1 && isochorLive.frame.info.dials[${chamber}] === 4000`);
    assert.match(await send(page, { do: 'set', control: chamber }), /needs the key value/);
    assert.match(await send(page, { do: 'fly' }), /there are take, play/);
    await page.waitFor('isochorLive.frame.field === isochorLive.asked'); // stresses come as well
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
