// The page in a browser, beside the command line: one source of numbers, two ways to them.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, beforeEach, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const web = join(dirname(fileURLToPath(import.meta.url)), '..');
const spectral = process.env.SPECTRAL ?? join(web, '../target/release/spectral');
const address = pathToFileURL(join(web, 'target/spectral.html')).href;
const folder = mkdtempSync(join(tmpdir(), 'spectral-'));
const shots = join(web, 'target/screenshots');

let browser;
let page;
let asked;
const failures = [];

before(async () => {
  mkdirSync(shots, { recursive: true });
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync'],
  });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

async function open(options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const opened = await context.newPage();
  opened.on('pageerror', (error) => failures.push(error.message));
  opened.on('console', (message) => { if (message.type() === 'error') failures.push(message.text()); });
  opened.on('request', (request) => asked.push(request.url()));
  await opened.goto(address);
  await opened.waitForSelector('#results:not([hidden])');
  return opened;
}

beforeEach(async () => {
  await page?.context().close();
  asked = [];
  failures.length = 0;
  page = await open();
});

/** A file in the test's folder. */
function file(name, content) {
  const path = join(folder, name);
  writeFileSync(path, content);
  return path;
}

/** What the command line says of a light; its words where it refuses one. */
function said(light) {
  const { status, stdout, stderr } = spawnSync(spectral, ['light', light, '--json'], { encoding: 'utf8' });
  return status === 0 ? JSON.parse(stdout) : { words: stderr.trim(), status };
}

/** All numbers on the page by their keys, as exact as they are. */
async function shown() {
  return page.$$eval('data[data-key]', (all) => Object.fromEntries(
    all.map((data) => [data.dataset.key, data.value === '' ? null : Number(data.value)])));
}

/** The numbers of a report that the page shows. */
function expected(report) {
  const numbers = { x: report.xy[0], y: report.xy[1], r9: report.r ? report.r[8] : null };
  const same = ['cct', 'duv', 'ra', 'cri00_munsell', 'rf', 'rg', 'luminous_efficacy', 'melanopic_der', 'acv'];
  for (const key of same) numbers[key] = report[key];
  (report.r ?? []).forEach((value, i) => { numbers[`r${i + 1}`] = value; });
  (report.cri00_munsell_i ?? []).forEach((value, i) => { numbers[`cri00_${i + 1}`] = value; });
  return numbers;
}

async function isAsSaid(light) {
  const report = said(light);
  const numbers = await shown();
  for (const [key, value] of Object.entries(expected(report))) assert.equal(numbers[key], value, `${light}: ${key}`);
  return report;
}

async function take(path) {
  await page.setInputFiles('#file', path);
  const name = path.split('/').pop();
  await page.waitForFunction((n) => document.getElementById('light-title').textContent === n
    || document.getElementById('problem').textContent !== '', name);
}

const lamp = (wavelength) => Math.exp(-(((wavelength - 455) / 12) ** 2)) + 0.7 * Math.exp(-(((wavelength - 580) / 60) ** 2));
const rows = (step, from = 380, to = 780) => {
  const all = [];
  for (let nm = from; nm <= to; nm += step) all.push([nm, lamp(nm).toFixed(6)]);
  return all;
};

test('numbers of all built-in lights are those of the command line', async () => {
  const names = await page.$$eval('#builtin option', (options) => options.map((option) => option.label));
  assert.ok(names.length >= 40, `${names.length} lights`);
  for (const name of names) {
    await page.selectOption('#builtin', { label: name });
    assert.equal(await page.textContent('#light-title'), name);
    await isAsSaid(name);
  }
  assert.deepEqual(failures, []);
});

test('numbers of files are those of the command line', async () => {
  const spdx = `<?xml version="1.0"?>\n<IESTM2714 xmlns="iestm2714" version="1.0"><SpectralDistribution>
    <SpectralQuantity>flux</SpectralQuantity>${rows(5).map(([nm, power]) => `<SpectralData wavelength="${nm}">${power}</SpectralData>`).join('\n')}
    </SpectralDistribution></IESTM2714>`;
  const files = {
    'five.csv': `wavelength (nm),power\n${rows(5).map((row) => row.join(',')).join('\n')}\n`,
    'three.txt': `# a lamp\n${rows(3, 371).map((row) => row.join(' ')).join('\n')}`,
    'comma.csv': rows(7, 350, 820).map(([nm, power]) => `${nm};${power.replace('.', ',')}`).join('\r\n'),
    'fine.tsv': rows(0.5).map((row) => row.join('\t')).join('\n'),
    'lamp.spdx': spdx,
  };
  for (const [name, content] of Object.entries(files)) {
    const path = file(name, content);
    await take(path);
    assert.equal(await page.textContent('#problem'), '', name);
    const report = await isAsSaid(path);
    assert.ok(report.ra > 50 && report.ra < 95, `${name}: ${report.ra}`);
  }
  assert.deepEqual(failures, []);
});

test('a file can be dropped', async () => {
  const path = file('dropped.csv', rows(5).map((row) => row.join(',')).join('\n'));
  const transfer = await page.evaluateHandle((content) => {
    const data = new DataTransfer();
    data.items.add(new File([content], 'dropped.csv'));
    return data;
  }, rows(5).map((row) => row.join(',')).join('\n'));
  await page.dispatchEvent('#drop', 'drop', { dataTransfer: transfer });
  await page.waitForFunction(() => document.getElementById('light-title').textContent === 'dropped.csv');
  await isAsSaid(path);
});

test('bad files are refused with the line and what is wrong, and what was there stays', async () => {
  const bad = {
    'words.csv': ['400,1\n410,much\n420,1', 2],
    'columns.csv': ['400,1,2\n410,1,2', 1],
    'order.csv': ['400,1\n420,1\n410,1', 3],
    'twice.txt': ['400 1\n400 2', 2],
    'negative.txt': ['400 1\n500 -2\n600 1', 2],
    'infinite.txt': ['400 1\n500 inf\n600 1', 2],
    'elsewhere.csv': ['1000,1\n1100,1', 1],
    'single.csv': ['500,1', 1],
    'empty.csv': ['', null],
    'picture.png': [Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0xff]), 1],
    'broken.spdx': ['<SpectralDistribution>\n<SpectralData wavelength="400">1</SpectralDatum>', 2],
    'paint.spdx': ['<SpectralDistribution>\n<SpectralQuantity>reflectance</SpectralQuantity></SpectralDistribution>', 2],
    'dark.csv': ['400,0\n500,0\n600,0', null],
    '<img src=x>.csv': ['400,<img src=x onerror=alert(1)>\n', null],
  };
  const before = await shown();
  for (const [name, [content, line]] of Object.entries(bad)) {
    const path = file(name.replaceAll('/', ''), content);
    await page.evaluate(() => document.getElementById('problem').replaceChildren());
    await take(path);
    const problem = await page.textContent('#problem b');
    if (line) assert.ok(problem.startsWith(`${name}, line ${line}: `), problem);
    const { words, status } = said(path);
    assert.equal(status, 2, name);
    const what = words.slice(words.indexOf(path) + path.length).replace(/^:\d+/, '').replace(/^: /, '');
    assert.ok(what.length > 8 && problem.includes(what), `${name}: "${problem}" where the command line says "${what}"`);
    assert.equal(await page.getAttribute('#problem', 'role'), 'alert');
    assert.equal(await page.locator('#problem img').count(), 0);
    assert.deepEqual(await shown(), before, name);
    assert.equal(await page.textContent('#light-title'), 'FL11');
  }
  await page.screenshot({ path: join(shots, 'refused.png') });
  await page.selectOption('#builtin', { label: 'D65' });
  assert.equal(await page.textContent('#problem'), '');
  assert.deepEqual(failures, []);
});

test('everything works by keyboard alone', async () => {
  const focused = () => page.evaluate(() => {
    const at = document.activeElement;
    const ringed = at.id === 'file' ? document.querySelector('label[for=file]') : at;
    const { outlineStyle, outlineWidth } = getComputedStyle(ringed);
    const named = at.labels?.length > 0 || at.hasAttribute('aria-label') || at.textContent.trim() !== '';
    return { what: at.id || at.name || at.localName, ring: outlineStyle !== 'none' && parseFloat(outlineWidth) >= 2, named };
  });
  const stops = [];
  for (let i = 0; i < 10; i += 1) {
    await page.keyboard.press('Tab');
    const stop = await focused();
    assert.ok(stop.ring, `no focus to be seen on ${stop.what}`);
    assert.ok(stop.named, `${stop.what} has no name`);
    stops.push(stop.what);
  }
  assert.deepEqual(stops,
    ['a', 'file', 'builtin', 'summary', 'paint', 'reflections', 'mode', 'slider', 'threshold', 'eye']);

  const to = async (what) => {
    for (let i = 0; i < 30; i += 1) {
      await page.keyboard.press('Tab');
      if ((await focused()).what === what) return;
    }
    assert.fail(`${what} is not reached`);
  };
  const value = async (key) => (await shown())[key];
  await to('file');
  const [chooser] = await Promise.all([page.waitForEvent('filechooser'), page.keyboard.press('Space')]);
  await chooser.setFiles(file('chosen.csv', rows(5).map((row) => row.join(',')).join('\n')));
  await page.waitForFunction(() => document.getElementById('light-title').textContent === 'chosen.csv');
  await to('builtin');
  await page.keyboard.type('FL2');
  assert.equal(await page.textContent('#light-title'), 'FL2');
  await isAsSaid('FL2');

  await to('paint');
  const paint = await page.textContent('#paint-name');
  await page.keyboard.press('ArrowRight');
  assert.notEqual(await page.textContent('#paint-name'), paint);
  const single = await value('delta_e_00_rgb');
  await to('reflections');
  await page.keyboard.press('ArrowDown');
  assert.notEqual(await value('delta_e_00_rgb'), single);
  await to('slider');
  const intervals = await value('intervals');
  for (let i = 0; i < 10; i += 1) await page.keyboard.press('ArrowLeft');
  assert.ok(await value('intervals') > intervals);
  assert.ok(await value('delta_e') <= Number(await page.inputValue('#threshold')));
  await to('threshold');
  await page.keyboard.press('Control+A');
  await page.keyboard.type('5');
  assert.ok(await value('intervals') <= intervals);
  await page.waitForFunction(() => document.getElementById('status').textContent.startsWith('FL2: 42'));
  await to('eye');
  const tile = () => page.$eval('#operators li .tile', (element) => element.style.background);
  const seen = await tile();
  await page.keyboard.press('ArrowRight');
  assert.notEqual(await tile(), seen);
  await to('summary');
  await page.keyboard.press('Enter');
  assert.ok(await page.isVisible('#indices'));
  assert.deepEqual(failures, []);
});

test('the certified bound holds, and is reached, for lights, paints and thresholds', async () => {
  const found = await page.evaluate(() => {
    const all = [];
    for (const name of ['A', 'D65', 'FL2', 'FL11', 'HP1', 'LED-B3']) {
      ask('choose', catalogue.lights.indexOf(name));
      for (let paint = 0; paint < 24; paint += 1) {
        for (const [threshold, reflections] of [[0.2, 1], [1, 2], [3, 3]]) {
          all.push({ name, paint, threshold, reflections, ...ask('examine', threshold, 0, paint, reflections) });
        }
      }
    }
    return all;
  });
  assert.equal(found.length, 432);
  for (const { name, paint, threshold, reflections, intervals, delta_e, error, reached, parts, operators } of found) {
    const what = `${name}, paint ${paint}, ${threshold}, ${reflections}`;
    assert.ok(error <= delta_e, `${what}: ${error} is above ${delta_e}`);
    assert.ok(reached && delta_e <= threshold, `${what}: ${delta_e}`);
    assert.equal(parts.length, intervals);
    assert.equal(parts[0].from, 380);
    assert.equal(parts.at(-1).to, 780);
    for (let i = 1; i < parts.length; i += 1) assert.equal(parts[i].from, parts[i - 1].to);
    const by = Object.fromEntries(operators.map((way) => [way.key, way.delta_e_00]));
    assert.equal(by.truth, 0);
    // Components made under the very light are exact after one reflection, and all of them are under D65.
    if (reflections === 1) {
      assert.ok(by.prefiltered <= 1e-9, `${what}: ${by.prefiltered}`);
      if (name === 'D65') assert.ok(by.rgb <= 1e-9 && by.bilinear <= 1e-9, `${what}: ${by.rgb}, ${by.bilinear}`);
    }
  }
});

test('a lamp without colour rendering, and one outside components, are shown as such', async () => {
  await take(file('blue.csv', rows(5).map(([nm]) => `${nm},${nm === 450 ? 1 : 0}`).join('\n')));
  const numbers = await shown();
  assert.equal(numbers.ra, null);
  assert.match(await page.textContent('#reference'), /no reference light/);
  assert.match(await page.textContent('#operators'), /too saturated/);
  assert.deepEqual(failures, []);
});

test('nothing is asked of any network, and no width needs scrolling sideways', async () => {
  assert.deepEqual(asked, [address]);
  for (const [name, width, colorScheme] of [['wide', 1280, 'light'], ['dark', 1000, 'dark'], ['narrow', 390, 'light'], ['least', 320, 'dark']]) {
    const other = await open({ viewport: { width, height: 900 }, colorScheme });
    assert.ok(await other.evaluate(() => document.documentElement.scrollWidth) <= width, `${width} pixels`);
    await other.screenshot({ path: join(shots, `${name}.png`), fullPage: true });
    await other.context().close();
  }
  assert.deepEqual(failures, []);
});
