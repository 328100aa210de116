// Opens the demo pages in a real browser and looks at the pixels.
// Usage: node browser_test.mjs PATH_OF_isochor_demo_page [PART OF THE NAME OF A TEST]      (exit code 77: skipped)
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const viewer = join(dirname(fileURLToPath(import.meta.url)), '../../viewer');
const { Browser, MISSING, findChromium } = await import(pathToFileURL(join(viewer, 'chromium.mjs')).href);

const demo = process.argv[2];
if (!demo) {
  console.error('usage: node browser_test.mjs PATH_OF_isochor_demo_page');
  process.exit(2);
}
if (!findChromium()) {
  console.log(`skipped: ${MISSING}`);
  process.exit(77);
}

const folder = mkdtempSync(join(tmpdir(), 'isochor-view-test-'));

function make(variant) {
  const path = join(folder, `${variant || 'full'}.html`);
  const run = spawnSync(demo, [path, variant].filter(Boolean), { encoding: 'utf8' });
  if (/not built/.test(run.stderr)) {
    console.log(`skipped: ${run.stderr.trim()}`);
    rmSync(folder, { recursive: true, force: true });
    process.exit(77);
  }
  assert.equal(run.status, 0, run.stderr);
  return path;
}

const files = Object.fromEntries(['', 'broken', 'single', 'bare', 'hot', 'parts'].map((v) => [v || 'full', make(v)]));
const browser = await Browser.launch();

async function open(file, hash = '', window = {}) {
  const page = await browser.open(`${pathToFileURL(files[file])}#${hash}`, window);
  await page.waitFor('window.isochorReady === true');
  assert.equal(await page.evaluate('window.isochorError ?? null'), null);
  return page;
}

// Drawing and reading happen in one task: the canvas keeps its content no longer than that.
const PIXELS = `(() => {
  const { stage } = window.isochorViewer;
  stage.draw();
  const copy = new OffscreenCanvas(stage.canvas.width, stage.canvas.height).getContext('2d');
  copy.drawImage(stage.canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, stage.canvas.width, stage.canvas.height);
  let covered = 0, yellow = 0, gray = 0, hash = 0;
  const colors = new Set();
  for (let i = 0; i < data.length; i += 4) {
    const [r, g, b, a] = [data[i], data[i + 1], data[i + 2], data[i + 3]];
    hash = (hash * 31 + r + 7 * g + 13 * b + 17 * a) | 0;
    if (a < 255) continue;
    ++covered;
    colors.add(r << 16 | g << 8 | b);
    if (r > 150 && g > 150 && b < 110) ++yellow;
    if (Math.max(r, g, b) - Math.min(r, g, b) < 14 && r > 120) ++gray;
  }
  return { covered, yellow, gray, hash, colors: colors.size, total: data.length / 4 };
})()`;
// Of the triangles of the slice that are on the picture: how many have the color of their value at their middle (light
// and gloss set aside: the channels keep their proportions), and how many are black. The outline is drawn over some.
const SLICE = `(() => {
  const { stage } = window.isochorViewer;
  stage.draw();
  const { width, height } = stage.canvas;
  const copy = new OffscreenCanvas(width, height).getContext('2d');
  copy.drawImage(stage.canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, width, height);
  const { body } = stage;
  const { position, value } = body.sliceGeometry.attributes;
  const table = body.uniforms.table.value.image.data;
  const { x: low, y: high } = body.uniforms.range.value;
  let checked = 0, good = 0, dark = 0;
  for (let i = 0; i + 2 < value.count; i += 3) {
    const middle = stage.camera.position.clone().set(0, 0, 0);
    for (const k of [0, 1, 2]) middle.add({ x: position.getX(i + k) / 3, y: position.getY(i + k) / 3, z: position.getZ(i + k) / 3 });
    const v = (value.getX(i) + value.getX(i + 1) + value.getX(i + 2)) / 3;
    const entry = 4 * Math.round(255 * Math.min(1, Math.max(0, (v - low) / (high - low))));
    middle.project(stage.camera);
    const at = 4 * (Math.floor((1 - middle.y) / 2 * height) * width + Math.floor((middle.x + 1) / 2 * width));
    const seen = [0, 1, 2].map((k) => data[at + k]), wanted = [0, 1, 2].map((k) => table[entry + k]);
    const product = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    ++checked;
    if (Math.max(...seen) < 45) ++dark;
    else if (product(seen, wanted) > 0.985 * Math.sqrt(product(seen, seen) * product(wanted, wanted))) ++good;
  }
  return { checked, good, dark };
})()`;
const pixels = (page) => page.evaluate(PIXELS);
const settle = (page) => page.evaluate('new Promise((done) => setTimeout(() => requestAnimationFrame(done), 60))');

async function finish(page) {
  assert.deepEqual(page.errors, [], 'the page complained');
  await page.close();
}

const tests = {
  async 'the page opens without a complaint and without the network'() {
    const start = performance.now();
    const page = await open('full');
    console.log(`    opened in ${Math.round(performance.now() - start)} ms`);
    assert.equal(await page.evaluate(`performance.getEntriesByType('resource').filter((e) => !e.name.startsWith('data:')).length`), 0);
    assert.equal(await page.evaluate('document.title'), 'Pneumatic finger (sample data)');
    const drawn = await pixels(page);
    assert.ok(drawn.covered > 0.03 * drawn.total, `the body covers ${drawn.covered} pixels`);
    assert.ok(drawn.colors > 200, `${drawn.colors} colors`);
    assert.equal(await page.evaluate(`document.querySelectorAll('.plot').length`), 5);
    assert.ok(await page.evaluate(`document.querySelectorAll('.plot canvas').length`) < 5, 'charts below the window wait');
    await page.evaluate(`document.querySelector('.plots').scrollIntoView()`);
    await page.waitFor(`document.querySelectorAll('.plot canvas').length === 5`);
    await finish(page);
  },

  async 'the slider moves the body and the marker of the plots'() {
    const page = await open('full', 'frame=first');
    const before = await pixels(page);
    await page.evaluate('window.isochorViewer.plots.drawAll()');
    const marker = `document.querySelector('.plot .marker').getBoundingClientRect().left - document.querySelector('.plot .u-over').getBoundingClientRect().left`;
    assert.ok(Math.abs(await page.evaluate(marker)) < 2, 'the marker starts at the left');
    await page.evaluate(`{ const s = document.querySelector('.transport input'); s.value = 10; s.dispatchEvent(new Event('input')); }`);
    await page.waitFor('window.isochorViewer.frame.index === 10');
    await settle(page);
    assert.notEqual((await pixels(page)).hash, before.hash);
    const middle = await page.evaluate(`document.querySelector('.plot .u-over').clientWidth / 2`);
    assert.ok(Math.abs(await page.evaluate(marker) - middle) < 2, 'half way through, the marker is in the middle');
    assert.match(await page.evaluate(`document.querySelector('.stamp').textContent`), /t = 1 s/);
    await finish(page);
  },

  async 'what moves may be drawn in haste, what rests is drawn at its best'() {
    const page = await open('full', 'field=stress&frame=first');
    const size = () => page.evaluate('[isochorViewer.stage.canvas.width, isochorViewer.stage.canvas.height]');
    const best = await size();
    assert.equal(best[0], await page.evaluate(`document.querySelector('.stage').clientWidth`));
    // The pace is held, so that nothing here depends on how fast this machine is.
    await page.evaluate('isochorViewer.stage.pace.took = () => {}; isochorViewer.stage.pace.quality = 3; 0');
    await page.evaluate('isochorViewer.play(true)');
    await page.waitFor('isochorViewer.stage.drawn === 3 && isochorViewer.state.frame > 3');
    const quick = await page.evaluate('(() => { const { stage } = isochorViewer; stage.drawMoving(); stage.playing = true; return [stage.canvas.width, stage.canvas.height]; })()');
    assert.deepEqual(quick, best.map((n) => Math.floor(n / 2)), 'half the resolution while it plays');
    await page.evaluate('isochorViewer.play(false); isochorViewer.go(10)');
    await page.waitFor('isochorViewer.stage.drawn === 0 && isochorViewer.frame.index === 10');
    assert.deepEqual(await size(), best, 'all of it again at rest');
    const rested = await pixels(page);
    await finish(page);
    const fresh = await open('full', 'field=stress&frame=10');
    assert.equal((await pixels(fresh)).hash, rested.hash, 'a picture at rest does not depend on what came before');
    await finish(fresh);
  },

  async 'every quality shows the body'() {
    const page = await open('full', 'field=stress&frame=10');
    const best = await pixels(page);
    for (const quality of [1, 2, 3]) {
      const drawn = await page.evaluate(PIXELS.replace('stage.draw();', `stage.drawAt(${quality});`));
      const [share, wanted] = [drawn, best].map((d) => d.covered / d.total);
      assert.ok(Math.abs(share - wanted) < 0.1 * wanted, `quality ${quality} covers ${share} of the picture, the best ${wanted}`);
      assert.ok(drawn.colors > 100, `quality ${quality}: ${drawn.colors} colors`);
    }
    await finish(page);
  },

  async 'the pace gives way when pictures are slow and not for one of them'() {
    const page = await open('single');
    const qualities = await page.evaluate(`(() => {
      const Pace = isochorViewer.stage.pace.constructor;
      const after = (list) => { const pace = new Pace(); for (const ms of list) pace.took(ms); return pace.quality; };
      const times = (n, ms) => Array(n).fill(ms);
      return [after(times(30, 25)), after([10, 500, 10, 10, 500, 10]), after(times(3, 60)), after(times(100, 60)), after([...times(3, 60), ...times(40, 10)])];
    })()`);
    assert.deepEqual(qualities, [0, 0, 1, 3, 0]);
    await finish(page);
  },

  async 'hollows are drawn once they can be seen'() {
    const page = await open('full', 'frame=10');
    const drawn = '(() => { isochorViewer.stage.draw(); return isochorViewer.stage.body.view.meshes.reduce((n, { mesh }) => n + Math.min(mesh.geometry.drawRange.count, mesh.geometry.index.count), 0); })()';
    const all = await page.evaluate('3 * isochorViewer.run.head.triangles');
    assert.equal(await page.evaluate(drawn), all / 2, 'the inner wall is hidden');
    await page.key('y');
    assert.equal(await page.evaluate(drawn), all, 'through the cut it is seen');
    await page.key('y');
    assert.equal(await page.evaluate(drawn), all / 2);
    await page.evaluate('isochorViewer.stage.dolly(0.05)');
    assert.equal(await page.evaluate(drawn), all, 'and from inside');
    await finish(page);
  },

  async 'frames are unpacked ahead'() {
    const page = await open('full');
    // The text of a frame goes once it is unpacked, which is some time after it was begun.
    await page.waitFor(`document.querySelectorAll('script.isochor-block').length === 0`);
    assert.equal(await page.evaluate('isochorViewer.run.frames.every((frame) => frame)'), true);
    await finish(page);
  },

  async 'dragging turns the body'() {
    const page = await open('full', 'frame=10');
    const before = await pixels(page);
    const direction = '(({ stage: { camera, controls } }) => camera.position.clone().sub(controls.target).normalize().toArray())(isochorViewer)';
    const from = await page.evaluate(direction);
    const { x, y } = await page.evaluate(`(({ x, y, width, height }) => ({ x: x + width / 2, y: y + height / 2 }))(isochorViewer.stage.canvas.getBoundingClientRect())`);
    const mouse = (type, dx) => page.send('Input.dispatchMouseEvent', { type, x: x + dx, y, button: 'left', buttons: type === 'mouseReleased' ? 0 : 1, clickCount: 1 });
    await mouse('mousePressed', 0);
    for (const dx of [20, 40, 60, 80]) await mouse('mouseMoved', dx);
    await mouse('mouseReleased', 80);
    const to = await page.evaluate(direction);
    assert.ok(Math.hypot(...to.map((v, i) => v - from[i])) > 0.2, 'the camera has moved');
    await page.waitFor('isochorViewer.stage.drawn === 0 && !isochorViewer.stage.pending');
    assert.notEqual((await pixels(page)).hash, before.hash);
    assert.equal(await page.evaluate('isochorViewer.stage.canvas.width'), await page.evaluate('isochorViewer.stage.host.clientWidth'));
    await page.key('r');
    assert.equal((await pixels(page)).hash, before.hash, 'R brings the camera back');
    await finish(page);
  },

  async 'the cut shows the inside'() {
    // The inner wall carries the largest stress: its yellow is hidden until the body is cut.
    const page = await open('full', 'field=stress&frame=10');
    const whole = await pixels(page);
    const height = `document.querySelector('.stage').clientHeight`;
    const before = await page.evaluate(height);
    await page.key('y');
    assert.equal(await page.evaluate(height), before, 'the picture jumps when the slider of the cut appears');
    const cut = await pixels(page);
    assert.ok(whole.yellow < 0.002 * whole.covered, `${whole.yellow} yellow of ${whole.covered} pixels before the cut`);
    assert.ok(cut.yellow > 0.04 * cut.covered, `${cut.yellow} yellow of ${cut.covered} pixels after the cut`);
    await page.key('f');
    assert.notEqual((await pixels(page)).hash, cut.hash);
    // Marked points of what is taken away go with it; those in the plane stay.
    const marked = `[...document.querySelectorAll('.probe')].filter((l) => !l.hidden).length`;
    assert.equal(await page.evaluate(marked), 2);
    await page.key('z');
    await pixels(page);
    assert.equal(await page.evaluate(marked), 1, 'one of the ends of the finger is left');
    await page.key('z');
    await page.key('y');
    await page.key('f');
    await page.key('y');
    assert.equal((await pixels(page)).hash, whole.hash);
    await finish(page);
  },

  async 'the first slice of a page has the colors of its values'() {
    for (const [way, axis, field] of [['address', 'x', 'stress'], ['address', 'y', 'pressure'], ['address', 'z', 'J'], ['address', 'auto', 'stress'],
      ['key', 'x', 'stress'], ['key', 'y', 'J'], ['key', 'z', 'pressure']]) {
      const page = await open('full', `field=${field}&frame=10${way === 'address' ? `&cut=${axis}` : ''}`);
      if (way === 'key') await page.key(axis);
      for (const when of ['first', 'in another color']) {
        const { checked, good, dark } = await page.evaluate(SLICE);
        assert.ok(checked > 100, `cut=${axis}: ${checked} triangles of the slice`);
        assert.ok(dark < 0.15 * checked, `cut=${axis} by ${way}, ${field}, ${when}: ${dark} of ${checked} points of the slice are black`);
        assert.ok(good > 0.75 * checked, `cut=${axis} by ${way}, ${field}, ${when}: ${good} of ${checked} points of the slice have their color`);
        await page.key('c'); // the next field, which the cut has not seen
        if (await page.evaluate(`isochorViewer.state.field.categories.length > 0`)) break;
      }
      await finish(page);
    }
  },

  async 'a section without values inside is filled'() {
    const page = await open('bare', 'frame=10');
    const whole = await pixels(page);
    await page.key('y');
    const cut = await pixels(page);
    assert.ok(whole.gray < 0.002 * whole.covered, `${whole.gray} gray of ${whole.covered} pixels before the cut`);
    assert.ok(cut.gray > 0.04 * cut.covered, `${cut.gray} gray of ${cut.covered} pixels after the cut`);
    await finish(page);
  },

  async 'keys play, step, color, and turn'() {
    const page = await open('full', 'frame=first');
    const state = (what) => page.evaluate(`window.isochorViewer.state.${what}`);
    await page.key('ArrowRight');
    assert.equal(await state('frame'), 1);
    await page.key('End');
    assert.equal(await state('frame'), 20);
    await page.key('c');
    assert.equal(await state('field.name'), 'stress');
    await page.key('g');
    await page.key('e');
    assert.deepEqual([await state('ghost'), await state('edges')], [true, true]);
    const before = await pixels(page);
    await page.key('ArrowLeft', 8);
    assert.notEqual((await pixels(page)).hash, before.hash);
    assert.equal(await state('frame'), 20);
    await page.key(' ');
    await page.waitFor('window.isochorViewer.state.frame > 2 && window.isochorViewer.state.frame < 20');
    await page.key(' ');
    assert.equal(await state('playing'), false);
    await finish(page);
  },

  async 'values that are not finite are gray and said'() {
    const page = await open('broken', 'field=stress&frame=10');
    assert.match(await page.evaluate(`document.querySelector('.legend').textContent`), /not finite/);
    assert.match(await page.evaluate(`document.querySelector('.notes').textContent`), /Frame 6: 1 of \d+ positions are not finite/);
    assert.match(await page.evaluate(`document.querySelector('.plots').textContent`), /No finite value: Nothing/);
    assert.equal(await page.evaluate(`document.querySelector('h1').textContent`), '</script><b>Broken & "quoted"');
    const drawn = await pixels(page);
    assert.ok(drawn.gray > 0.04 * drawn.covered, `${drawn.gray} gray of ${drawn.covered} pixels`);
    await finish(page);
    const lost = await open('broken', 'field=J');
    assert.match(await lost.evaluate(`document.querySelector('.legend').textContent`), /no finite value/);
    await finish(lost);
  },

  async 'one frame, no field, small window, dark'() {
    const single = await open('single', '', { width: 390, height: 800, dark: true });
    assert.equal(await single.evaluate(`document.querySelector('.transport').hidden`), true);
    assert.ok(await single.evaluate('document.documentElement.scrollWidth <= window.innerWidth'), 'the page is wider than the window');
    assert.ok((await pixels(single)).covered > 0);
    await finish(single);
    const bare = await open('bare', 'field=nonsense');
    assert.match(await bare.evaluate(`document.querySelector('.notes').textContent`), /no field "nonsense"; it has displacement, relative, solid/);
    await finish(bare);
  },

  async 'what cannot be had is refused with what there is'() {
    const out = join(folder, 'refused.png');
    for (const [wrong, says] of [['field=nonsense', /no field "nonsense"; it has pressure, stress, J, region, displacement, relative, solid/],
      ['colour=red', /no option "colour"; there are .*field, .*theme/], ['frame=99', /frames 0 to 20/], ['frame=end', /frame wants first, last/],
      ['view=above', /view wants iso, front/], ['cut=w', /cut wants x, y, z, auto or AROUND\/UP/], ['cut=30/:0.5', /AROUND\/UP/], ['camera=1,2,3', /camera wants six numbers/],
      ['hide=table', /hide wants numbers of parts/], ['arrows=none', /arrows wants forces, fibers/], ['span=95', /span wants all, 98 or 90/], ['cut=x:7', /place from 0 to 1/],
      ['range=9,1', /range wants LOW,HIGH or frame/], ['zoom=0', /zoom wants a positive number/], ['theme=pink', /light or dark/], ['ghost=yes', /0 or 1/]]) {
      const run = spawnSync(process.execPath, [join(viewer, 'shoot.mjs'), files.full, out, wrong], { encoding: 'utf8' });
      assert.equal(run.status, 2, wrong);
      assert.match(run.stderr, says);
      assert.ok(!existsSync(out), `${wrong}: there is a picture`);
    }
    const page = await open('full', 'cut=w&colour=red');
    assert.match(await page.evaluate(`document.querySelector('.notes').textContent`), /no option "colour".*|cut wants/);
    await finish(page);
  },

  async 'one hot spot does not set the colors, and the legend says so'() {
    const page = await open('hot', 'field=stress&frame=10');
    const range = () => page.evaluate('isochorViewer.currentRange()');
    const legend = () => page.evaluate(`document.querySelector('.legend').textContent`);
    const usual = await range();
    assert.ok(usual[1] < 2e5, `up to ${usual[1]} Pa beside a hot spot of 1e7 Pa`);
    assert.match(await legend(), /1 % to 99 % of the points; all: .* to 10000/);
    await page.evaluate(`isochorViewer.controls.shares.node.children[2].click()`);
    assert.match(await legend(), /5 % to 95 % of the points/);
    assert.ok((await range())[1] < usual[1]);
    await page.evaluate(`isochorViewer.controls.shares.node.children[0].click()`);
    assert.equal(Math.round((await range())[1]), 1e7);
    assert.doesNotMatch(await legend(), /99 %/);
    await finish(page);
    const full = await open('hot', 'field=stress&frame=10&full=1');
    assert.equal(Math.round((await full.evaluate('isochorViewer.currentRange()'))[1]), 1e7);
    await finish(full);
  },

  async 'colors around a center span less of the values'() {
    const page = await open('hot', 'field=pressure&frame=10');
    assert.equal(await page.evaluate('isochorViewer.share'), 0.9);
    assert.equal(await page.evaluate(`isochorViewer.controls.shares.node.children[2].getAttribute('aria-pressed')`), 'true');
    const [range, ends] = await page.evaluate(`(() => {
      const v = isochorViewer, values = [...v.run.values(v.frame, v.state.field)].filter(Number.isFinite).sort((a, b) => a - b);
      const at = (t) => values[Math.floor(t * (values.length - 1))];
      return [v.run.frameRange(v.state.field, 10, v.share), [at(0.05), at(0.95)]];
    })()`);
    const reach = Math.max(...range.map(Math.abs));
    range.forEach((v, k) => assert.ok(Math.abs(v - ends[k]) < 0.05 * reach, `${range} beside ${ends}`));
    await finish(page);
    const all = await open('hot', 'field=pressure&frame=10&span=all');
    assert.equal(await all.evaluate('isochorViewer.share'), 1);
    await finish(all);
    const plain = await open('hot', 'field=stress&frame=10');
    assert.equal(await plain.evaluate('isochorViewer.share'), 0.98);
    await finish(plain);
  },

  async 'a cut may face any way'() {
    const page = await open('full', 'field=stress&frame=10&cut=+90/0:0.5');
    const free = await pixels(page);
    assert.deepEqual(await page.evaluate('[isochorViewer.problems, isochorViewer.state.cut.axis]'), [[], 'free']);
    await page.evaluate(`isochorViewer.controls.setCut('y')`);
    await page.evaluate(`isochorViewer.state.cut.at = 0.5, isochorViewer.state.cut.flip = false, isochorViewer.controls.cutChanged()`);
    assert.equal((await pixels(page)).hash, free.hash, '90 degrees around is across y');
    // Across the line of sight: what is left is behind the plane through the middle.
    await page.key('v');
    const depth = await page.evaluate(`(() => {
      const v = isochorViewer, { stage } = v, plane = v.cutPlane();
      const sight = stage.camera.position.clone().sub(stage.controls.target).normalize().toArray();
      return sight.reduce((sum, s, k) => sum + s * plane[k], 0);
    })()`);
    assert.ok(depth > 0.9995, `the plane faces the camera: ${depth}`);
    const facing = await pixels(page);
    assert.notEqual(facing.hash, free.hash);
    assert.ok(facing.yellow > 0.02 * facing.covered, `${facing.yellow} yellow of ${facing.covered} pixels: the inner wall is to be seen`);
    await page.evaluate(`{ const { slider } = isochorViewer.controls.angleRows[0]; slider.value = Number(slider.value) + 40; slider.dispatchEvent(new Event('input')); }`);
    assert.notEqual((await pixels(page)).hash, facing.hash);
    assert.match(await page.evaluate(`isochorViewer.controls.angles.textContent`), /around.*°.*up.*°/);
    await finish(page);
  },

  async 'bodies are faded and hidden, and what is behind them is seen and touched'() {
    const page = await open('parts', 'field=solid&frame=first&view=-100,10');
    const whole = await pixels(page);
    const look = (part, k) => page.evaluate(`isochorViewer.controls.lookChoices[${part}].node.children[${k}].click()`);
    const under = (part) => page.evaluate(`(() => {
      const { stage, run } = isochorViewer;
      const corners = [...run.triangles].filter((_, c) => run.trianglePart[Math.floor(c / 3)] === ${part});
      const p = stage.camera.position.clone().set(0, 0, 0);
      for (const v of corners) p.add({ x: run.rest[3 * v] / corners.length, y: run.rest[3 * v + 1] / corners.length, z: run.rest[3 * v + 2] / corners.length });
      p.project(stage.camera);
      const { left, top, width, height } = stage.canvas.getBoundingClientRect();
      const hit = isochorViewer.pickAt({ clientX: left + (p.x + 1) / 2 * width, clientY: top + (1 - p.y) / 2 * height });
      return hit ? run.trianglePart[hit.triangle] : null;
    })()`);
    assert.equal(await under(1), 1);
    await look(1, 2);
    const hidden = await pixels(page);
    assert.notEqual(await under(1), 1, 'what is hidden is not there for the hand');
    assert.ok(hidden.covered < whole.covered, `${hidden.covered} of ${whole.covered} pixels`);
    await look(1, 1);
    const faded = await pixels(page);
    assert.notEqual(await under(1), 1, 'nor what is looked through');
    assert.ok(new Set([whole.hash, hidden.hash, faded.hash]).size === 3);
    await page.key('y');
    await pixels(page);
    assert.equal(await page.evaluate(`isochorViewer.stage.body.capMaterials.find((c) => c.part === 1).meshes.some((m) => m.visible)`), false, 'a faded body has no fill');
    await page.key('y');
    await look(1, 0);
    assert.equal((await pixels(page)).hash, whole.hash, 'shown again as it was');
    await finish(page);
    const other = await open('parts', 'field=solid&frame=first&view=-100,10&hide=1');
    assert.equal((await pixels(other)).hash, hidden.hash, 'the address hides as well');
    await finish(other);
  },

  async 'arrows of forces and lines of fibers'() {
    const page = await open('parts', 'field=solid&frame=10');
    const bare = await pixels(page);
    await page.key('a');
    const forces = await pixels(page);
    assert.notEqual(forces.hash, bare.hash);
    assert.match(await page.evaluate(`document.querySelector('.arrow-key').textContent`), /contact forces, up to 2 N.*friction/);
    assert.deepEqual(await page.evaluate(`(({ normal, friction }) => [normal.geometry.instanceCount, friction.geometry.instanceCount])(isochorViewer.stage.overlays.arrows)`), [3, 3]);
    // From its point along the force, as long as all arrows may be where it is the largest of the run.
    const along = await page.evaluate(`[...isochorViewer.stage.overlays.arrows.normal.geometry.attributes.along.array.slice(0, 3)]`);
    assert.ok(along[0] < -0.3 && Math.hypot(along[1], along[2]) < 1e-6, `${along}`);
    await page.evaluate(`isochorViewer.go(0)`);
    await page.waitFor('isochorViewer.frame.index === 0');
    assert.equal(await page.evaluate(`isochorViewer.stage.overlays.arrows.normal.geometry.instanceCount`), 0, 'no force, no arrow');
    await page.evaluate(`isochorViewer.go(10)`);
    await page.waitFor('isochorViewer.frame.index === 10');
    await page.key('a');
    assert.equal((await pixels(page)).hash, bare.hash);
    await page.evaluate(`isochorViewer.controls.fibers.input.click()`);
    assert.notEqual((await pixels(page)).hash, bare.hash);
    assert.equal(await page.evaluate(`isochorViewer.stage.overlays.arrows.lines.geometry.getAttribute('instanceStart').count`), 20);
    await finish(page);
    const none = await open('full');
    assert.doesNotMatch(await none.evaluate(`document.querySelector('.controls').textContent`), /Contact forces|Fibers|Bodies/, 'nothing is offered that there is not');
    await finish(none);
  },

  async 'the value under the cursor'() {
    const page = await open('full', 'field=stress&frame=10');
    const { x, y } = await page.evaluate(`(() => {
      const { left, top, width, height } = isochorViewer.stage.canvas.getBoundingClientRect();
      for (let r = 0; r < 200; r += 4) for (let k = 0; k < 12; ++k) {
        const x = Math.round(left + width / 2 + r * Math.cos(k)), y = Math.round(top + height / 2 + r * Math.sin(k));
        const there = [[0, 0], [3, 0], [-3, 0], [0, 3], [0, -3]].every(([dx, dy]) => isochorViewer.pickAt({ clientX: x + dx, clientY: y + dy }));
        if (there) return { x, y };
      }
      return null;
    })()`);
    const says = `document.querySelector('.under-cursor:not([hidden])')?.textContent`;
    await page.send('Input.dispatchMouseEvent', { type: 'mouseMoved', x, y });
    await page.waitFor(`/^[\\d.]+ kPa$/.test(${says})`);
    const [low, high] = await page.evaluate('isochorViewer.currentRange()');
    const value = 1000 * parseFloat(await page.evaluate(says));
    assert.ok(value >= 0.5 * low && value <= 1.5 * high, `${value} of ${low} to ${high}`);
    await page.send('Input.dispatchMouseEvent', { type: 'mouseMoved', x: 3, y: 3 });
    await page.waitFor(`${says} === undefined`);
    await finish(page);
  },

  async 'labels keep apart'() {
    const page = await open('parts', 'frame=10');
    const boxes = await page.evaluate(`(() => {
      isochorViewer.stage.draw();
      return [...document.querySelectorAll('.probe, .legend, .stamp')].filter((l) => !l.hidden).map((l) => { const { left, top, right, bottom } = l.getBoundingClientRect(); return { text: l.textContent, left, top, right, bottom }; });
    })()`);
    assert.equal(boxes.filter(({ text }) => /Tip|Root|eside|here/.test(text)).length, 5, 'all of them are there');
    for (const a of boxes) {
      for (const b of boxes) {
        if (a === b) continue;
        assert.ok(a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top, `"${a.text}" lies over "${b.text}"`);
      }
    }
    await finish(page);
  },

  async 'displacements less the common motion'() {
    const page = await open('parts', 'field=relative&frame=10');
    const seen = await page.evaluate(`(() => {
      const v = isochorViewer, { run, frame } = v;
      const values = run.values(frame, v.state.field);
      const of = (part) => [...run.triangles].filter((_, c) => run.trianglePart[Math.floor(c / 3)] === part).map((n) => values[n]);
      return { finger: Math.max(...of(0)), block: Math.max(...of(1)), table: Math.max(...of(2)), moved: run.head.frames[10].displacement, range: v.currentRange() };
    })()`);
    assert.ok(seen.block < 1e-5 && seen.table === 0, 'what only stands there has none');
    assert.ok(seen.finger > 1e-3 && seen.finger < 0.8 * seen.moved, `${seen.finger} of ${seen.moved}`);
    assert.equal(seen.range[0], 0);
    assert.ok(seen.range[1] <= seen.finger * 1.001 && seen.range[1] > 0.3 * seen.finger);
    // A turn and a shift alone leave nothing.
    const left = await page.evaluate(`(() => {
      const { run } = isochorViewer, n = run.rest.length, now = new Float32Array(n);
      const [c, s] = [Math.cos(2), Math.sin(2)];
      for (let i = 0; i < n; i += 3) {
        now[i] = c * run.rest[i] - s * run.rest[i + 1] + 0.3;
        now[i + 1] = s * run.rest[i] + c * run.rest[i + 1] - 0.1;
        now[i + 2] = run.rest[i + 2] + 0.5;
      }
      const kept = { rest: run.rest, placed: run.placed, apart: run.apart };
      run.placed = { index: -7, points: now };
      const out = Math.max(...run.relative({ index: -7 }));
      Object.assign(run, kept);
      return out * run.scale;
    })()`);
    assert.ok(left < 1e-5, `${left} of a body of size 2`);
    await finish(page);
  },

  async 'what stands near the ground is dark below, and folds are darker than the open'() {
    const page = await open('parts', 'field=solid&frame=first&hide=0');
    const at = await page.evaluate(`(() => {
      isochorViewer.stage.draw();
      const { ground, body, run } = { ...isochorViewer.stage, run: isochorViewer.run };
      const shadow = (k, x, y) => { const s = ground.shadows[k], c = s.look.cells; const cell = (v) => Math.round((v / 3.2 + 0.5) * c - 0.5); return s.bytes[4 * (cell(y) * c + cell(x))]; };
      const place = (p) => p.map((v, k) => (v - run.center[k]) * run.scale);
      const [bx, by] = place([-0.035, 0, 0]), [fx, fy] = place([0.08, 0.05, 0]);
      const shade = (wanted) => { const { source, part, attributes } = body.view.points; let worst = 0; source.forEach((v, i) => { if (part[i] === 1 && wanted(run.rest[3 * v + 2], i)) worst = Math.max(worst, attributes.shade.array[i]); }); return worst; };
      const low = place([0, 0, -0.016])[2], high = place([0, 0, 0.03])[2];
      return { below: shadow(1, bx, by), free: shadow(1, fx, fy), foot: shade((z) => Math.abs(z - low) < 1e-3), top: shade((z) => Math.abs(z - high) < 1e-3) };
    })()`);
    assert.ok(at.below > 60 && at.free < 6, `shadow ${at.below} below the block, ${at.free} away from it`);
    assert.ok(at.foot > 0.05 && at.foot > 3 * at.top, `${at.foot} of the light is missing at the foot, ${at.top} at the top`);
    await finish(page);
  },

  async 'a picture and a film are saved, and a link restores the view'() {
    const page = await open('parts', 'field=stress&frame=3');
    await page.evaluate(`window.isochorSaved = []; HTMLAnchorElement.prototype.click = function () { isochorSaved.push(this.download); };`);
    await page.key('p');
    await page.waitFor('isochorViewer.saved > 5000');
    if (await page.evaluate('isochorViewer.controls.filmButton.hidden')) console.log('    this browser records no WebM');
    else {
      await page.evaluate('isochorViewer.controls.filmButton.click()');
      await page.waitFor('isochorViewer.filmed');
      const film = await page.evaluate(`(async () => {
        const head = new Uint8Array(await isochorViewer.filmed.arrayBuffer());
        const video = document.createElement('video');
        video.src = URL.createObjectURL(isochorViewer.filmed);
        await new Promise((done, fail) => { video.onloadeddata = done; video.onerror = () => fail(new Error('no film')); });
        return { magic: [...head.slice(0, 4)], size: head.length, width: video.videoWidth, stage: isochorViewer.stage.host.clientWidth, frame: isochorViewer.state.frame };
      })()`);
      assert.deepEqual(film.magic, [0x1a, 0x45, 0xdf, 0xa3]);
      assert.ok(film.size > 3000 && Math.abs(film.width - film.stage) <= 1, JSON.stringify(film));
      assert.equal(film.frame, 20, 'to the last frame');
      assert.deepEqual((await page.evaluate('isochorSaved')).map((name) => name.split('.').at(-1)), ['png', 'webm']);
    }
    await page.evaluate(`isochorViewer.go(7)`);
    await page.evaluate('isochorViewer.stage.turn(40, 10)');
    await page.evaluate(`isochorViewer.controls.lookChoices[1].node.children[1].click()`);
    await page.key('a');
    await page.key('v');
    await page.key('l');
    await page.waitFor(`/camera=/.test(location.hash)`);
    const [link, wanted] = [await page.evaluate('location.hash.slice(1)'), await pixels(page)];
    await finish(page);
    const other = await open('parts', link);
    assert.deepEqual(await other.evaluate('[isochorViewer.state.frame, isochorViewer.state.looks, isochorViewer.state.arrows.forces, isochorViewer.state.cut.axis]'), [7, ['shown', 'faded', 'shown'], true, 'free']);
    // The camera is rounded to five digits.
    const drawn = await pixels(other);
    assert.ok(Math.abs(drawn.covered - wanted.covered) < 0.01 * wanted.covered, `${drawn.covered} and ${wanted.covered} pixels`);
    await finish(other);
  },

  async 'tables have the units of the charts'() {
    const page = await open('full');
    const table = await page.evaluate(`document.querySelector('.tables').textContent`);
    assert.match(table, /Largest pressure40 kPa/);
    assert.match(table, /Volume at rest23.5 mL \(at most 41.125 mL\)/);
    assert.match(table, /Least pressure0 kPa/, 'a small number keeps the unit of its chart');
    await finish(page);
  },

  async 'nothing at all is the lowest color'() {
    const page = await open('full', 'field=displacement&frame=first&range=frame');
    const range = await page.evaluate('isochorViewer.currentRange()');
    assert.equal(range[0], 0);
    assert.ok(range[1] > 0);
    await finish(page);
  },

  async 'a picture is not blank'() {
    const out = join(folder, 'shot.png');
    const run = spawnSync(process.execPath, [join(viewer, 'shoot.mjs'), files.full, out, '--size', '800x500', 'field=stress', 'frame=t=1', 'cut=y'], { encoding: 'utf8' });
    assert.equal(run.status, 0, run.stderr);
    assert.equal(run.stderr, '');
    const page = await open('single');
    const { width, colors } = await page.evaluate(`(async () => {
      const blob = await (await fetch('data:image/png;base64,${readFileSync(out).toString('base64')}')).blob();
      const image = await createImageBitmap(blob);
      const copy = new OffscreenCanvas(image.width, image.height).getContext('2d');
      copy.drawImage(image, 0, 0);
      const { data } = copy.getImageData(0, 0, image.width, image.height);
      return { width: image.width, colors: new Set(new Uint32Array(data.buffer)).size };
    })()`);
    assert.equal(width, 800);
    assert.ok(colors > 1000, `${colors} colors`);
    await page.close();
  },
};

let failures = 0;
try {
  const only = process.argv[3];
  for (const [name, test] of Object.entries(tests)) {
    if (only && !name.includes(only)) continue;
    try {
      await test();
      console.log(`ok      ${name}`);
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
