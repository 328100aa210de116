// Opens the page of a study in a real browser: diagrams are drawn, tables are filled, nothing is missing.
// Usage: node study_page_test.mjs PATH_OF_isochor      (exit code 77: skipped)
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const viewer = join(dirname(fileURLToPath(import.meta.url)), '../../viewer');
const { Browser, MISSING, findChromium } = await import(pathToFileURL(join(viewer, 'chromium.mjs')).href);

const isochor = process.argv[2];
if (!isochor) {
  console.error('usage: node study_page_test.mjs PATH_OF_isochor');
  process.exit(2);
}
if (!findChromium()) {
  console.log(`skipped: ${MISSING}`);
  process.exit(77);
}

const folder = mkdtempSync(join(tmpdir(), 'isochor-study-test-'));
const study = spawnSync(isochor, ['study', 'zones', '--quick', '--quiet', '--out', folder], { encoding: 'utf8' });
assert.equal(study.status, 0, study.stderr);
const file = join(folder, 'index.html');
if (!existsSync(file)) {
  console.log('skipped: this build has no bundled page');
  rmSync(folder, { recursive: true, force: true });
  process.exit(77);
}
const html = readFileSync(file, 'utf8');
// Nothing comes from a network.
assert.ok(!/(src|href)="https?:/.test(html));
const study2 = spawnSync(isochor, ['study', 'timesteps', '--quick', '--quiet', '--out', join(folder, 'steps')], { encoding: 'utf8' });
assert.equal(study2.status, 0, study2.stderr);

const browser = await Browser.launch();
let failed = null;
try {
  const open = async (path, hash = '') => {
    const page = await browser.open(`${pathToFileURL(path)}#${hash}`, {});
    await page.waitFor('window.isochorReady === true');
    assert.equal(await page.evaluate('window.isochorError ?? null'), null);
    assert.deepEqual(page.errors, []);
    return page;
  };
  const count = (page, selector) => page.evaluate(`document.querySelectorAll('${selector}').length`);
  // Pixels of the diagrams that are neither empty nor of the page.
  const INK = `[...document.querySelectorAll('.u-wrap canvas')].map((canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const colors = new Set();
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 200) colors.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
    return colors.size;
  })`;

  let page = await open(file);
  assert.ok(await count(page, '.bars .bar-name') >= 5);
  assert.ok(await count(page, 'tbody tr') >= 10);
  assert.ok((await page.evaluate('document.body.innerText')).includes('whole body and penalty'));
  await page.close?.();

  const steps = join(folder, 'steps/index.html');
  page = await open(steps);
  const ink = await page.evaluate(INK);
  assert.equal(ink.length, 2);
  for (const colors of ink) assert.ok(colors > 20, `a diagram has only ${colors} colors`);
  // Legends name the lines.
  assert.ok((await page.evaluate('document.body.innerText')).includes('Tet4 edge-smoothed, nodal pressure'));
  await page.close?.();

  // One figure of one section, for pictures.
  page = await open(steps, 'section=1&figure=2');
  assert.equal(await count(page, '.u-wrap canvas'), 1);
  assert.equal(await count(page, 'table'), await count(page, '.u-legend'));
  assert.ok((await page.picture()).length > 5000);
  await page.close?.();
  page = await open(steps, 'section=1&figure=99&color=red');
  const problems = (await page.evaluate('window.isochorProblems')).join(' ');
  assert.match(problems, /figure=99: figure wants a number from 1 to \d+ in section 1/);
  assert.match(problems, /no option "color"; there are section, figure, tables/);
} catch (error) {
  failed = error;
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
if (failed) throw failed;
console.log('ok');
