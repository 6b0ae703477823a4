// Opens reports in a real browser without network: `npm ci && node --test .`
//
//   CHROMIUM               the browser, /usr/bin/chromium unless given
//   LACUNA_REPORT_FILES    report files, separated by colons, that the general tests open as well
//   LACUNA_LARGE_REPORTS   report files of large motions, of which size and times are measured
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, readdirSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { HOSTILE, SIGMAS, kinds, writeReport } from './fixture.mjs';
import { FrameArray } from '../../../src/report/page/src/decode.js';
import { SceneData, colourings } from '../../../src/report/page/src/scene_data.js';
import { METRIC_OF_NOISE, validationMetric } from '../../../src/report/page/src/validation_metric.js';
import { worstPlaces } from '../../../src/report/page/src/worst.js';

const here = dirname(fileURLToPath(import.meta.url));
const pageFolder = join(here, '../../../src/report/page');
const givenFiles = (process.env.LACUNA_REPORT_FILES ?? '').split(':').filter(Boolean);
const largeFiles = (process.env.LACUNA_LARGE_REPORTS ?? '').split(':').filter(Boolean);
const LAPTOP = { width: 1440, height: 900 }, PHONE = { width: 390, height: 844 };

// The aims are 4 MB, and on an idle machine with two cores 2 s to open and 100 ms for a step. Times on
// a machine that many share say little: these limits of the processor time, in s, notice only what has
// become several times slower. docs/report.md has times that were measured.
const LARGEST_FILE = 4e6, LONGEST_OPENING = 15, LONGEST_STEP = 1.5;

let browser, folder;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'report_page_'));
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    // Only the 3D view is drawn by the (emulated) graphics processor.
    args: ['--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader'],
  });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

const fixture = (kind) => {
  const file = join(folder, `${kind}.html`);
  writeReport(kinds[kind](), file);
  return file;
};

// Opens a file. `problems` collects errors, warnings and every request beside the file itself.
async function open(file, { viewport = LAPTOP, colorScheme = 'light', timeout = 120000 } = {}) {
  const context = await browser.newContext({ viewport, colorScheme, offline: true });
  context.setDefaultTimeout(120000);
  const page = await context.newPage();
  const problems = [];
  const url = pathToFileURL(file).href;
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text())) problems.push(message.text()); });
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('request', (request) => { if (request.url().split('#')[0] !== url && !/^(data|blob):/.test(request.url())) problems.push(`request ${request.url()}`); });
  page.on('dialog', (dialog) => { problems.push(`dialog ${dialog.message()}`); dialog.dismiss(); });
  await page.route('**', (route) => (route.request().url().startsWith('file:') ? route.continue() : route.abort()));
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.complete, null, { timeout });
  return { page, problems, close: () => context.close() };
}

// A number that changes when the picture of the 3D view changes.
const picture = (page) => page.evaluate(async () => {
  const { view } = window.lacunaReport.motion;
  await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  const gl = view.renderer.getContext();
  const bytes = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  return bytes.reduce((sum, byte, k) => (sum * 31 + byte * (k % 251)) >>> 0, 7);
});

const hasNoSidewaysScrolling = (page) => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);

// Scrolls through the page, so that every chart is drawn.
const readAll = (page) => page.evaluate(async () => {
  document.documentElement.style.scrollBehavior = 'auto';
  for (let y = 0; y < document.documentElement.scrollHeight; y += 600) {
    scrollTo(0, y);
    await new Promise((resolve) => setTimeout(resolve, 30));
  }
  scrollTo(0, 0);
});

// Boxes that are shown without anything in them.
const emptyBoxes = (page) => page.evaluate(() => [...document.querySelectorAll('section, figure, table, .block, .following, .grid, .table-box, .verdict, .facts, ul, select')]
  .filter((box) => box.checkVisibility() && (box.getBoundingClientRect().height < 8 || (box.textContent.trim() === '' && !box.querySelector('canvas, svg'))))
  .map((box) => `${box.tagName} ${box.className} ${box.id}`));

test('the bundle belongs to its sources', () => {
  const hash = (bytes) => createHash('sha256').update(bytes).digest('hex');
  const scripts = readdirSync(join(pageFolder, 'src')).filter((name) => name.endsWith('.js')).sort().map((name) => `src/${name}`);
  const names = ['LICENSES.txt', 'bundle.mjs', 'package-lock.json', 'package.json', 'page.css', 'page.html', ...scripts];
  const expected = hash(names.map((name) => `${hash(readFileSync(join(pageFolder, name)))}  ${name}\n`).join(''));
  const template = readFileSync(join(pageFolder, 'template.html'), 'utf8');
  assert.ok(template.includes(`name="source-sha256" content="${expected}"`), 'run `npm run bundle` in src/report/page');
  assert.equal(template.split('\n<script type="application/json" id="report-data">{}</script>\n').length, 2);
  assert.doesNotMatch(template, /<(script|link|img|iframe)[^>]+(src|href)="(?!data:)[^#]/);
  assert.ok(template.includes('three.js authors') && template.includes('Leon Sorokin'), 'the licences of the libraries');
});

test('the validation metric of known errors', () => {
  // Errors 1, 1 and 6 with U = 2: the two small ones weigh 2 of 8.
  const small = validationMetric([[1, 1], [6]], 100, 1);
  assert.equal(small.metric, 0.25);
  assert.equal(small.withinShare, 2 / 3);
  assert.equal(small.thresholdShare, 0.02);
  assert.ok(small.low <= small.metric && small.metric <= small.high);
  // Normally distributed errors of the assumed size, from the quantiles of the distribution by Box and Muller.
  const frames = Array.from({ length: 100 }, (_, a) => Array.from({ length: 100 }, (_, b) => Math.abs(Math.sqrt(-2 * Math.log(1 - (a + 0.5) / 100)) * Math.cos((2 * Math.PI * (b + 0.5)) / 100))));
  const noise = validationMetric(frames, 1, 1);
  assert.ok(Math.abs(noise.metric - METRIC_OF_NOISE) < 0.01, String(noise.metric));
  assert.ok(Math.abs(noise.withinShare - 0.9545) < 0.01);
  assert.equal(validationMetric([[]], 1, 1), null);
});

test('the validation metric is that of the equations of Dvurecenska et al. 2018', () => {
  // As the paper has them: e_k = |P_k − M_k| / max |M|, w_k = e_k / Σ e, the threshold is the
  // expanded uncertainty over max |M|, and the metric is the sum of the weights below it.
  const metricOfPaper = (predicted, measured, uncertainty) => {
    const largest = Math.max(...measured.map(Math.abs));
    const error = measured.map((value, k) => Math.abs((predicted[k] - value) / largest));
    const sum = error.reduce((a, b) => a + b, 0);
    const weight = error.map((value) => (100 * value) / sum);
    return weight.reduce((metric, value, k) => (error[k] < uncertainty / largest ? metric + value : metric), 0);
  };
  let state = 7;
  const random = () => { state = (Math.imul(state, 1664525) + 1013904223) >>> 0; return state / 4294967296 - 0.5; };
  const sigma = 0.05;
  for (let repeat = 0; repeat < 20; ++repeat) {
    const measured = Array.from({ length: 60 }, () => 3 * random());
    const predicted = measured.map((value) => value + (0.2 + 0.2 * repeat) * random() * random());
    const errors = measured.map((value, k) => Math.abs(predicted[k] - value));
    const frames = [0, 1, 2].map((f) => errors.slice(20 * f, 20 * f + 20));
    const largest = Math.max(...measured.map(Math.abs));
    const found = validationMetric(frames, largest, sigma);
    // The rest is rounding in sums of 60 numbers.
    assert.ok(Math.abs(100 * found.metric - metricOfPaper(predicted, measured, 2 * sigma)) < 1e-9);
    assert.ok(Math.abs(found.thresholdShare - (2 * sigma) / largest) < 1e-15);
  }
  // All errors below the uncertainty: 100 %; all above: 0.
  assert.equal(validationMetric([[0.01, 0.02]], 1, sigma).metric, 1);
  assert.equal(validationMetric([[0.2, 0.3]], 1, sigma).metric, 0);
});

test('the validation metric compares each number with its own uncertainty', () => {
  // Errors 1, 3 and 3 with U = 2, 2 and 4: the second alone is beyond its uncertainty, and weighs 3 of 7.
  const own = validationMetric([[1, 3], [3]], 100, 1, [[1, 1], [2]]);
  assert.equal(own.metric, 4 / 7);
  assert.equal(own.withinShare, 2 / 3);
  assert.equal(own.largestErrorShare, 0.03);
  assert.equal(validationMetric([[1, 3], [3]], 100, 1).metric, 1 / 7);
  // The same uncertainty for all numbers, given one by one.
  assert.deepEqual(validationMetric([[1, 1], [6]], 100, 1, [[1, 1], [1]]), validationMetric([[1, 1], [6]], 100, 1));
});

test('a residual is relative to the noise of its own point', () => {
  const array = (shape, values) => new FrameArray({ shape, type: 'float32' }, Float32Array.from(values));
  const scene = { times: [0, 1], points: { names: ['a', 'b'], is_scan: false, sigma: 1 } };
  const residual = array([2, 2, 3], [3, 0, 0, 0, 4, 0, 0, 0, 2, NaN, NaN, NaN]);
  const sigmas = array([2, 2], [1, 4, 2, NaN]);
  const near = (found, wanted) => wanted.forEach((value, k) => assert.ok(Number.isNaN(value) ? Number.isNaN(found[k]) : Math.abs(found[k] - value) < 1e-6, `${found} for ${wanted}`));
  const own = new SceneData(scene, { residual, sigmas, model: array([2, 2, 3], new Float32Array(12)) });
  near(own.residualsOverNoise(0), [3, 1].map((ratio) => ratio / Math.sqrt(3)));
  near(own.residualsOverNoise(1), [1 / Math.sqrt(3), NaN]);
  near([own.residualScale(true).usual, own.residualScale().usual], [Math.sqrt(3), 4]);
  // Ratios 3/√3 and 1/√3 in the worst frame; without σ of their own, 3/√3 and 4/√3.
  assert.match(worstPlaces(null, scene, own)[1].detail, /, 1\.3 × noise$/);
  const equal = new SceneData(scene, { residual, sigmas: null, model: own.model });
  near(equal.residualsOverNoise(0), [3, 4].map((ratio) => ratio / Math.sqrt(3)));
  assert.match(worstPlaces(null, scene, equal)[1].detail, /, 2\.0 × noise$/);
  // A patch errs along its normal only.
  const patches = new SceneData({ ...scene, points: { ...scene.points, is_scan: true } }, { residual, sigmas, model: own.model });
  near(patches.residualsOverNoise(0), [3, 1]);
  // The scale says what is shown.
  const unit = (points) => colourings([{ points: { ...scene.points, residual, ...points } }]).find((one) => one.key === 'residual_sigma').unit;
  assert.equal(unit({ sigmas }), 'times the noise of each point');
  assert.equal(unit({}), 'times the noise');
});

for (const [label, makeFile] of [['full', () => fixture('full')], ['in-vain', () => fixture('in-vain')], ['own-noise', () => fixture('own-noise')], ['scans', () => fixture('scans')], ['study', () => fixture('study')], ['table1', () => fixture('table1')], ['minimal', () => fixture('minimal')], ['two-runs', () => fixture('two-runs')],
                                ...givenFiles.map((file) => [basename(file), () => file])]) {
  test(`${label}: opens without an error or a request, and without empty boxes`, async () => {
    const { page, problems, close } = await open(makeFile());
    await readAll(page);
    assert.deepEqual(problems, []);
    assert.deepEqual(await emptyBoxes(page), []);
    assert.ok(await hasNoSidewaysScrolling(page));
    assert.equal(await page.locator('h1').count(), 1);
    for (const link of await page.locator('nav a').all()) assert.equal(await page.locator(await link.getAttribute('href')).count(), 1);
    await close();
  });

  test(`${label}: fits a phone, in the dark`, async () => {
    const { page, problems, close } = await open(makeFile(), { viewport: PHONE, colorScheme: 'dark' });
    await readAll(page);
    assert.ok(await hasNoSidewaysScrolling(page));
    assert.deepEqual(problems, []);
    await close();
  });
}

for (const [label, makeFile] of [['full', () => fixture('full')], ...givenFiles.map((file) => [basename(file), () => file])]) {
  test(`${label}: the slider changes the picture, and every field can be chosen`, async (t) => {
    const { page, problems, close } = await open(makeFile());
    if (!(await page.evaluate(() => Boolean(window.lacunaReport.motion)))) {
      await close();
      t.skip('no motion');
      return;
    }
    const slider = page.getByRole('slider', { name: 'Time' });
    if (await slider.isVisible()) {
      await slider.focus();
      await page.keyboard.press('Home');
      const first = await picture(page);
      for (let k = 0; k < 3; ++k) await page.keyboard.press('PageUp');
      const later = await picture(page);
      assert.notEqual(first, later);
      await page.keyboard.press('End');
      assert.match(await slider.getAttribute('aria-valuetext'), /frame (\d+) of \1/);
    }
    const colour = page.getByLabel('Colour', { exact: true });
    const values = await colour.locator('option').evaluateAll((options) => options.map((option) => option.value));
    const pictures = new Set();
    for (const value of values) {
      await colour.selectOption(value);
      await page.waitForTimeout(150);
      pictures.add(await picture(page));
      const isShown = await page.locator('.scale').isVisible();
      assert.equal(isShown, value !== 'none');
    }
    assert.ok(pictures.size >= Math.min(2, values.length));
    for (const mode of ['measured', 'model', 'difference', 'both']) {
      const button = page.getByRole('button', { name: mode, exact: true });
      if (await button.isVisible()) {
        await button.click();
        assert.equal(await button.getAttribute('aria-pressed'), 'true');
      }
    }
    assert.deepEqual(problems, []);
    await close();
  });
}

test('a worst place sets the time and the camera', async () => {
  const { page, close } = await open(fixture('full'));
  const state = () => page.evaluate(() => {
    const { store, motion } = window.lacunaReport;
    return { time: store.get().time, point: store.get().point, target: motion.view.orbit.target.toArray(), distance: motion.view.orbit.distance };
  });
  const before = await state();
  await page.locator('.worst-item').filter({ hasText: 'held out' }).first().click();
  const after = await state();
  assert.notEqual(after.time, before.time);
  assert.notDeepEqual(after.target, before.target);
  assert.ok(after.distance < before.distance);
  assert.notEqual(after.point, null);
  await page.locator('.worst-item').filter({ hasText: 'period' }).first().click();
  assert.notEqual((await state()).time, after.time);
  await close();
});

test('points with noise of their own are coloured and judged by it', async () => {
  const { page, problems, close } = await open(fixture('own-noise'));
  await page.getByLabel('Colour', { exact: true }).selectOption('residual_sigma');
  await page.waitForTimeout(150);
  assert.match(await page.locator('.scale').textContent(), /residual, times the noise of each point/);
  // The colours of the markers in a late frame, as multiples of the noise, and their residuals.
  const { values, lengths } = await page.evaluate(() => {
    const { view, data } = window.lacunaReport.motion;
    view.showFrames([50, 50]);
    const { low, high } = view.view.range;
    return { values: [...view.panes[0].measured.geometry.getAttribute('value').array].map((share) => low + share * (high - low)), lengths: [...data[0].residualLengths(50)] };
  });
  for (const p of [0, 1, 5]) {
    const wanted = lengths[p] / (Math.sqrt(3) * SIGMAS(p, 50));
    assert.ok(Math.abs(values[p] - wanted) < 1e-3 * wanted, `marker ${p}: ${values[p]} for ${wanted}`);
  }
  const text = await page.locator('main').textContent();
  for (const part of ['each marker has a σ of its own', 'error of a number over its own σ', 'for a typical point']) assert.ok(text.includes(part) || await page.locator(`[aria-label*="${part}"]`).count() > 0, part);
  assert.equal(await page.locator('.bar-noise').count(), 0);
  assert.deepEqual(problems, []);
  await close();
});

test('a click on a marker selects it', async () => {
  const { page, close } = await open(fixture('full'));
  const at = await page.evaluate(() => {
    const { view } = window.lacunaReport.motion;
    const { left, top } = view.canvas.getBoundingClientRect();
    const place = view.project(view.placeOfPoint(0, 3), view.boxes[0]);
    return { x: left + place.x, y: top + place.y };
  });
  await page.mouse.click(at.x, at.y);
  assert.equal(await page.evaluate(() => window.lacunaReport.store.get().point), 3);
  await page.getByRole('heading', { name: 'Position of m3' }).waitFor();
  await close();
});

test('markers that were not observed are not drawn', async () => {
  const { page, close } = await open(fixture('full'));
  const counts = await page.evaluate(async () => {
    const { view } = window.lacunaReport.motion;
    return [3, 4].map((frame) => {
      view.showFrames([frame, frame]);
      return view.panes[0].measured.geometry.drawRange.count;
    });
  });
  assert.deepEqual(counts, [8, 7]);
  await close();
});

test('numbers arrive as they were packed', async () => {
  const { page, close } = await open(fixture('full'));
  const { positions, measured, tolerance } = await page.evaluate(() => {
    const { data } = window.lacunaReport.motion;
    const tip = data[0].positions.frame(59);
    return { positions: [...tip].every(Number.isFinite), measured: [...data[0].measured.frame(0)].slice(0, 3), tolerance: data[0].positions.step };
  });
  assert.ok(positions);
  assert.ok(tolerance < 2e-6);
  assert.ok(Math.abs(measured[0] - 0.011) < 0.003);
  await close();
});

test('a hostile name stays text', async () => {
  const { page, problems, close } = await open(fixture('hostile'));
  await readAll(page);
  assert.deepEqual(problems, []);
  assert.ok(await hasNoSidewaysScrolling(page));
  assert.equal(await page.locator('main script, main img').count(), 0);
  assert.equal(await page.locator('h1').textContent(), HOSTILE);
  assert.ok((await page.locator('.sentences').textContent()).includes('<script>alert(1)</script>"\'`</script><img'));
  await close();
  const phone = await open(fixture('hostile'), { viewport: PHONE });
  await readAll(phone.page);
  assert.ok(await hasNoSidewaysScrolling(phone.page));
  await phone.close();
});

test('two runs stand side by side', async () => {
  const { page, problems, close } = await open(fixture('two-runs'));
  assert.equal(await page.locator('.view-label').count(), 2);
  assert.match(await page.locator('.view-label').first().textContent(), /^hidden_effect/);
  assert.match(await page.locator('.view-label').last().textContent(), /^stiff/);
  assert.match(await page.locator('#runs').textContent(), /material\.young_modulus.*0\.12 MPa.*0\.2 MPa/);
  assert.equal(await page.locator('.bars').count(), 2);
  // The cameras are linked: turning moves the pixels of both halves.
  const halves = () => page.evaluate(async () => {
    const { view } = window.lacunaReport.motion;
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const gl = view.renderer.getContext();
    const width = Math.floor(gl.drawingBufferWidth / 2), bytes = new Uint8Array(4 * width * gl.drawingBufferHeight);
    return [0, gl.drawingBufferWidth - width].map((x) => {
      gl.readPixels(x, 0, width, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      return bytes.reduce((sum, byte, k) => (sum * 31 + byte * (k % 251)) >>> 0, 7);
    });
  });
  const before = await halves();
  await page.locator('canvas.view-canvas').focus();
  await page.keyboard.press('ArrowLeft');
  const turned = await halves();
  assert.notEqual(turned[0], before[0]);
  assert.notEqual(turned[1], before[1]);
  const both = await picture(page);
  await page.getByRole('button', { name: 'Side by side' }).click();
  await page.waitForTimeout(200);
  assert.notEqual(await picture(page), both);
  assert.equal(await page.locator('.view-label').count(), 1);
  assert.deepEqual(problems, []);
  await close();
});

test('parts without data are left out', async () => {
  const { page, problems, close } = await open(fixture('minimal'));
  assert.deepEqual(problems, []);
  assert.equal(await page.locator('main section').count(), 0);
  assert.equal(await page.locator('canvas').count(), 0);
  await close();
});

// Optional parts that are taken away from the full report and from the study, named by their paths;
// those of one line together, since they belong to different parts of the page.
const OPTIONAL_PARTS = {
  full: [
    ['sentences', 'runs.0.noise', 'runs.0.models.*.diagnosis.decision', 'runs.0.models.*.scenes.*.series'],
    ['runs.0.ledger', 'runs.0.models.*.errors', 'runs.0.models.*.scenes.*.surface', 'runs.0.models.*.scenes.*.force'],
    ['runs.0.provenance', 'runs.0.models.*.calibration', 'runs.0.models.*.scenes.*.surface.fields', 'runs.0.models.*.scenes.*.points_series'],
    ['runs.0.models.*.comparison', 'runs.0.models.*.scenes.*.points.residual', 'runs.0.models.*.scenes.*.reactions.*.motion'],
    ['runs.0.models.*.scenes.*.reactions'],
    ['runs.0.models.*.diagnosis', 'runs.0.models.*.scenes.*.points.model', 'runs.0.models.*.scenes.*.fitted'],
    ['runs.0.models.*.scenes.*.points'],
    ['runs.0.models.*.scenes'],
  ],
  study: [
    ['runs.0.reconstruction', 'runs.0.ablation'],
    ['runs.0.reconstruction.frames', 'runs.0.table1'],
    ['runs.0.reconstruction.trace', 'runs.0.trials', 'runs.0.models'],
  ],
};

function without(data, path) {
  const keys = path.split('.');
  const remove = (value, depth) => {
    if (value === null || value === undefined) return;
    if (depth === keys.length - 1) delete value[keys[depth]];
    else for (const child of keys[depth] === '*' ? value : [value[keys[depth]]]) remove(child, depth + 1);
  };
  remove(data, 0);
  return data;
}

for (const [kind, lines] of Object.entries(OPTIONAL_PARTS)) {
  test(`${kind}: any part may be missing, and leaves no empty box`, async () => {
    const found = [];
    for (const paths of lines) {
      const file = join(folder, 'without.html');
      writeReport(paths.reduce(without, kinds[kind]({ vertices: 60, frames: 8 })), file);
      const { page, problems, close } = await open(file);
      await readAll(page);
      for (const problem of [...problems, ...await emptyBoxes(page)]) found.push(`without ${paths}: ${problem}`);
      await close();
    }
    assert.deepEqual(found, []);
  });
}

// The text about the next recording after `change` of each plan.
async function planText(change) {
  const file = join(folder, 'plan.html'), data = kinds.full({ vertices: 60, frames: 8 });
  for (const run of data.runs) for (const model of run.models) if (model.plan) change(model.plan);
  writeReport(data, file);
  const { page, problems, close } = await open(file);
  const text = await page.locator('#plan').textContent();
  assert.deepEqual(problems, []);
  await close();
  return text;
}

test('a plan after an adequate model says that nothing is open', async () => {
  assert.ok((await planText(() => {})).includes('To be told apart: drag of the surrounding medium (52 %)'));
  const text = await planText((plan) => Object.assign(plan, { verdict: 'adequate', no_effect: 0.91 }));
  assert.ok(text.includes('Nothing is open') && text.includes('91 %'));
  assert.ok(!text.includes('To be told apart'));
  assert.ok((await planText((plan) => { plan.verdict = 'no power'; })).includes('could not show any effect'));
  assert.ok((await planText((plan) => { plan.rivals.pop(); })).includes('or something else, is open'));
  const left = await planText((plan) => { plan.also_left = [{ nuisance: 'clock', title: 'a clock that is late', probability: 0.3 }]; });
  assert.ok(left.includes('a clock that is late (30 %)'));
});

// What tells a pair is the list of its effects: its name may be any.
test('a plan says that pairs count as not named if it weighs one', async () => {
  const note = 'where two effects at once count as not named';
  assert.ok(!(await planText((plan) => { plan.rivals[1].effects = ['mass_damping']; })).includes(note));
  assert.ok((await planText((plan) => { plan.rivals[1].effects = ['gravity', 'mass_damping']; })).includes(note));
});

test('every part is there when its data is', async () => {
  const full = await open(fixture('full'));
  for (const id of ['errors', 'force', 'physics', 'plan', 'parameters', 'agreement', 'validation', 'provenance']) assert.equal(await full.page.locator(`#${id}`).count(), 1, id);
  const text = await full.page.locator('main').textContent();
  for (const part of ['Error over time', 'Position of', 'Force on jaw', 'Load against displacement, x', 'y, over time', 'Torque on jaw', 'Torque against rotation, x', 'measured, held out', 'Against speed', 'Against distance from the grip', 'Torque', 'Power', 'Effects that were tried', 'that each refitted effect removes', '18715.3', 'Which pairs these recordings can separate',
                      'What such recordings would have said', 'The next recording', 'force that holds', 'The recordings disagree', 'traded off with young_modulus', 'in the information about a parameter', '75 %', 'metric: probability', 'Commands that reproduce it', 'noise of the measurement']) assert.ok(text.includes(part), part);
  const physics = await full.page.locator('#physics').textContent();
  assert.ok(physics.includes('96 %') && !physics.includes('72 %'), 'the probability of an effect counts it with and without nuisances');
  assert.ok(!text.includes('Load against displacement, y'), 'a force over a motion that the grip does not make');
  await full.close();
  const study = await open(fixture('study'));
  for (const id of ['reconstruction', 'table1', 'ablation', 'trials', 'intervals']) assert.equal(await study.page.locator(`#${id}`).count(), 1, id);
  const words = await study.page.locator('main').textContent();
  for (const part of ['Trace of the search', 'What is named', 'Confusion matrix', 'Calibration of the probabilities', 'One more recording of the cases that are left open', 'mass_damping. Its intervals cannot be right']) assert.ok(words.includes(part), part);
  await study.close();
});

test('the keyboard alone reaches and works every control', async () => {
  const { page, close } = await open(fixture('full'));
  const wanted = await page.evaluate(() => {
    const all = [...document.querySelectorAll('a[href], button, select, input, summary, canvas[tabindex], pre[tabindex]')].filter((one) => one.checkVisibility());
    all.forEach((one, k) => { one.dataset.probe = String(k); });
    return all.length;
  });
  const reached = new Set();
  let unlabelled = [];
  await page.evaluate(() => document.activeElement?.blur());
  for (let k = 0; k < wanted + 30 && reached.size < wanted; ++k) {
    await page.keyboard.press('Tab');
    const found = await page.evaluate(() => {
      const one = document.activeElement;
      const label = one.getAttribute('aria-label') ?? (one.labels?.[0]?.textContent || one.textContent || '').trim();
      const style = getComputedStyle(one);
      return { probe: one.dataset.probe, label, hasOutline: style.outlineStyle !== 'none' };
    });
    if (found.probe === undefined) continue;
    reached.add(found.probe);
    if (!found.label || !found.hasOutline) unlabelled.push(found);
  }
  assert.equal(reached.size, wanted);
  assert.deepEqual(unlabelled, []);
  const canvas = page.locator('canvas.view-canvas');
  await canvas.focus();
  for (const key of ['ArrowLeft', 'ArrowUp', 'Shift+ArrowRight', '+', '-', 'Shift+ArrowDown']) {
    const before = await picture(page);
    await page.keyboard.press(key);
    assert.notEqual(await picture(page), before, key);
  }
  await page.keyboard.press('0');
  await page.getByRole('button', { name: 'Play' }).focus();
  const time = () => page.evaluate(() => window.lacunaReport.store.get().time);
  const before = await time();
  await page.keyboard.press('Space');
  await page.waitForTimeout(800);
  await page.keyboard.press('Space');
  assert.notEqual(await time(), before);
  await close();
});

// The processor time of each process of the browser, s, by its number.
async function processorTimes() {
  const session = await browser.newBrowserCDPSession();
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  await session.detach();
  return new Map(processInfo.map(({ id, cpuTime }) => [id, cpuTime]));
}

// What `action` returns, and the processor time that it takes.
async function timed(action) {
  const before = await processorTimes();
  const value = await action();
  const after = await processorTimes();
  return { value, seconds: [...after].reduce((sum, [id, time]) => sum + time - (before.get(id) ?? 0), 0) };
}

const STEPS = 20;

// Opens a report and steps through its frames, with the surface coloured by a field. Prints the size,
// and how long opening and a step take.
async function measure(title, file) {
  const size = statSync(file).size;
  const { value: { page, problems, close }, seconds: opening } = await timed(() => open(file, { timeout: 300000 }));
  const ready = await page.evaluate(() => Number(document.documentElement.dataset.ready) / 1e3);
  const note = await page.locator('.motion > .explain').textContent();
  const frames = await page.evaluate(() => window.lacunaReport.motion.data[0].times.length);
  const colour = page.getByLabel('Colour', { exact: true });
  await colour.selectOption(await colour.locator('option[value^="field:"]').first().getAttribute('value'));
  await page.waitForTimeout(500);
  const { value: steps, seconds } = await timed(() => page.evaluate(([count, last]) => Array.from({ length: count }, (_, f) => window.lacunaReport.motion.view.measureStep([(7 * f) % last])), [STEPS, frames]));
  const step = steps.sort((a, b) => a - b)[STEPS / 2] / 1e3;
  console.log(`${title}: ${(size / 1e6).toFixed(2)} MB; opened in ${ready.toFixed(1)} s, with ${opening.toFixed(1)} s of processor time; a step in ${step.toFixed(3)} s, with ${(seconds / STEPS).toFixed(3)} s`);
  assert.deepEqual(problems, []);
  await close();
  return { size, opening, step: seconds / STEPS, note, frames };
}

test('a report of 10 000 vertices and 30 frames is small and quick', async () => {
  const { size, opening, step } = await measure('10 000 vertices × 30 frames', fixture('10k'));
  assert.ok(size <= LARGEST_FILE);
  assert.ok(opening <= LONGEST_OPENING);
  assert.ok(step <= LONGEST_STEP);
});

for (const file of largeFiles) {
  test(`${basename(file)}: a large report opens`, async () => {
    const { size, opening, step, note, frames } = await measure(basename(file), file);
    const [, vertices, recorded] = /(\d+)x(\d+)/.exec(file).map(Number);
    assert.equal(frames, recorded);
    if (vertices > 20000) {
      assert.match(note, /The surface is drawn with \d+ of its \d+ vertices\./);
    } else {
      assert.equal(note, '');
      assert.ok(size <= LARGEST_FILE);
      assert.ok(opening <= LONGEST_OPENING);
      assert.ok(step <= LONGEST_STEP);
    }
  });
}

test('a report of 100 000 vertices and 100 frames opens', async () => {
  const file = fixture('100k');
  const { page, problems, close } = await open(file, { timeout: 180000 });
  const ready = await page.evaluate(() => Number(document.documentElement.dataset.ready));
  const step = await page.evaluate(() => window.lacunaReport.motion.view.measureStep([50]));
  console.log(`100 000 vertices × 100 frames: ${(statSync(file).size / 1e6).toFixed(1)} MB, ready after ${(ready / 1e3).toFixed(1)} s, one step ${step.toFixed(0)} ms`);
  assert.deepEqual(problems, []);
  await close();
});

test('an effect whose size may be zero is not shown as the result', async () => {
  const { page, problems, close } = await open(fixture('in-vain'));
  assert.deepEqual(await page.locator('.view-label').allTextContents(), ['initial model', 'with viscoelastic branch']);
  assert.match(await page.locator('.bar-row.tried').last().textContent(), /size may be 0/);
  assert.match(await page.locator('.verdict.in-vain').textContent(), /does not count.*strain_stiffening/);
  assert.deepEqual(problems, []);
  await close();
});

// The share of dark pixels in the picture of a page.
async function darkShare(page) {
  const png = (await page.screenshot()).toString('base64');
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let dark = 0;
    for (let k = 0; k < data.length; k += 4) if (data[k] + data[k + 1] + data[k + 2] < 240) ++dark;
    return (4 * dark) / data.length;
  }, png);
}

test('a dark page prints dark on light, and is dark again afterwards', async () => {
  const { page, problems, close } = await open(fixture('full'), { colorScheme: 'dark' });
  await readAll(page);
  assert.ok(await darkShare(page) > 0.5);
  await page.emulateMedia({ media: 'print', colorScheme: 'dark' });
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  await page.waitForTimeout(300);
  // The background of the 3D view, and the share of dark pixels in the first chart, whose held-out
  // span is filled.
  const drawn = await page.evaluate(() => {
    const pixels = (canvas) => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    const chart = pixels(document.querySelector('.chart canvas'));
    let dark = 0;
    for (let k = 0; k < chart.length; k += 4) if (chart[k + 3] > 200 && chart[k] + chart[k + 1] + chart[k + 2] < 240) ++dark;
    return { view: [...pixels(document.querySelector('canvas.view-print')).slice(0, 3)], chart: (4 * dark) / chart.length };
  });
  assert.deepEqual(drawn.view, [255, 255, 255]);
  assert.ok(drawn.chart < 0.05, `${drawn.chart}`);
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  await page.setViewportSize({ width: 720, height: Math.min(height, 8000) });
  await page.waitForTimeout(300);
  // Text, lines and the colours of the drawings; a dark background would be nearly everything.
  assert.ok(await darkShare(page) < 0.1);
  await page.emulateMedia({ media: 'screen', colorScheme: 'dark' });
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  await page.setViewportSize(LAPTOP);
  await page.waitForTimeout(300);
  assert.ok(await darkShare(page) > 0.5);
  assert.deepEqual(problems, []);
  await close();
});

test('the page prints with all its charts', async () => {
  const { page, problems, close } = await open(fixture('full'));
  const pdf = await page.pdf({ format: 'A4', printBackground: true });
  assert.ok(pdf.length > 100000);
  assert.deepEqual(problems, []);
  await close();
});

test('damaged data is reported in words', async () => {
  const data = kinds.full();
  data.runs[0].models[0].scenes[0].surface.positions.base64 = 'AAAA';
  const file = join(folder, 'damaged.html');
  writeReport(data, file);
  const { page, close } = await open(file);
  assert.ok(await page.locator('.notice').first().isVisible());
  assert.ok(await page.locator('#physics').isVisible());
  await close();
});
