/* The pages in Chromium: called by test_pages_slow.sh in a folder that has them all. */
import assert from 'node:assert/strict';
import { readFileSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, before, test } from 'node:test';

const require = createRequire(`${process.env.MODULES}/x.js`);
const puppeteer = require('puppeteer-core');
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const wide = { width: 1400, height: 900 }, phone = { width: 390, height: 844 };
const results = readFileSync('canonical/results.jsonl', 'utf8').trim().split('\n').map((line) => JSON.parse(line));
const pages = ['canonical/index.html', 'frozen/index.html', 'many-page/index.html', 'hostile-page/index.html',
  'damaged-page/index.html', 'still/index.html',
  ...['sweep', 'threshold', 'ensemble', 'metamorphic', 'catalogue'].map((name) => `studies/${name}.html`)];
let browser;

before(async () => {
  browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM, protocolTimeout: 300000,
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
});
after(() => browser?.close());

/* Opens a page; what it complains of and asks for is gathered in `faults`. */
async function open(path, view = wide, theme = 'light') {
  const page = await browser.newPage(), faults = [];
  page.on('console', (m) => { if (['error', 'warn', 'warning', 'assert'].includes(m.type())) faults.push(m.text()); });
  page.on('pageerror', (e) => faults.push(String(e)));
  page.on('dialog', (d) => { faults.push(`dialog: ${d.message()}`); d.dismiss(); });
  page.on('request', (r) => { if (!r.url().endsWith(path) && !/^(data|blob):/.test(r.url())) faults.push(`request: ${r.url()}`); });
  await page.setViewport(view);
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: theme }]);
  await page.goto(`file://${process.cwd()}/${path}`, { timeout: 120000 });
  await page.waitForFunction(() => document.documentElement.dataset.ready === 'yes', { timeout: 120000 });
  return { page, faults };
}

/* Brings a section into the window, and waits until it is filled. */
async function show(page, id, content = '.panels canvas') {
  await page.evaluate((name) => document.getElementById(name).scrollIntoView(), id);
  await page.waitForSelector(`#${id} ${content}`, { timeout: 120000 });
}

test('every page opens without errors and requests', async () => {
  for (const path of pages) {
    const { page, faults } = await open(path);
    assert.ok(await page.$eval('main', (m) => m.querySelectorAll('h2').length > 0), path);
    await page.evaluate(() => window.scrollTo(0, document.body.scrollHeight));
    await new Promise((done) => setTimeout(done, 300));
    assert.deepEqual(faults, [], path);
    await page.close();
  }
});

test('every scenario opens with replay and curves', async () => {
  const { page, faults } = await open(pages[0]);
  const count = await page.$$eval('section[id^=case-]', (s) => s.length);
  assert.equal(count, 9);
  for (let i = 0; i < count; ++i) {
    await show(page, `case-${i}`);
    await page.waitForSelector(`#case-${i} .plots figure svg .cursor, #case-${i} .plots figure svg line.cursor`, { timeout: 120000 });
    assert.ok(await page.$$eval(`#case-${i} .panels canvas`, (c) => c.length) >= 5);
    const drawn = await page.$eval(`#case-${i} .panels canvas`, (c) => new Set(c.getContext('2d').getImageData(0, 0, c.width, c.height).data).size);
    assert.ok(drawn > 8, `case ${i} is drawn`);
  }
  assert.deepEqual(faults, []);
  await page.close();
});

test('replay plays and the slider moves the cursors', async () => {
  const { page } = await open(pages[0]);
  await show(page, 'case-0', 'line.cursor');
  const cursor = () => page.$eval('#case-0 line.cursor', (line) => Number(line.getAttribute('x1')));
  const time = () => page.$eval('#case-0 .replay', (r) => Number(r.dataset.time));
  const end = await cursor();
  await page.$eval('#case-0 input[type=range]', (slider) => { slider.value = 100; slider.dispatchEvent(new Event('input')); });
  assert.ok(await cursor() < end - 50);
  const before = await time();
  await page.click('#case-0 .play');
  await page.waitForFunction((from) => Number(document.querySelector('#case-0 .replay').dataset.time) > from + 0.05, { timeout: 60000 }, before);
  await page.click('#case-0 .play');
  const stopped = await time();
  await new Promise((done) => setTimeout(done, 400));
  assert.equal(await time(), stopped);
  await page.close();
});

test('a click on a heading sorts its table', async () => {
  const { page } = await open(pages[0]);
  const column = () => page.$$eval('table.matrix tbody tr', (rows) => rows.map((row) => row.cells[0].textContent));
  const asked = await column();
  const button = await page.$$('table.matrix thead button');
  await button[0].click();
  await button[0].click();
  assert.deepEqual(await column(), asked.toReversed());
  assert.equal(await page.$eval('table.matrix thead th', (head) => head.getAttribute('aria-sort')), 'descending');
  await page.close();
});

test('the theme follows the system and switches', async () => {
  const { page } = await open(pages[0], wide, 'dark');
  const colour = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const dark = await colour();
  await page.click('#theme');
  assert.notEqual(await colour(), dark);
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'light');
  await page.close();
});

test('numbers on the page are those of the results', async () => {
  const { page } = await open(pages[0]);
  const shown = await page.$$eval('table.matrix tbody tr', (rows) => rows.map((row) => [...row.cells].map((cell) => cell.querySelector('.word')?.textContent ?? cell.textContent)));
  const heads = await page.$$eval('table.matrix thead th', (cells) => cells.map((cell) => cell.textContent));
  let compared = 0;
  for (const row of shown) {
    row.forEach((text, i) => {
      const found = results.find((r) => r.label === heads[i] && r.scenario === row[0].split(' ')[0]);
      if (found && Number.isFinite(Number(text))) {
        assert.equal(Number(text), Number(found.metrics.reference_error.value.toPrecision(2)), `${row[0]}, ${heads[i]}`);
        compared += 1;
      }
    });
  }
  assert.ok(compared >= 20, `${compared} numbers were compared`);
  await page.close();
});

test('the first screen shows every engine whole', async () => {
  const { page } = await open(pages[0]);
  await page.waitForSelector('.strip canvas');
  const seen = await page.evaluate(() => {
    const box = document.querySelector('table.matrix').parentElement;
    return { cut: box.scrollWidth - box.clientWidth, bottom: box.getBoundingClientRect().bottom, strip: document.querySelector('.strip canvas').getBoundingClientRect().bottom,
      title: document.querySelector('#overview h3').textContent };
  });
  assert.ok(seen.cut <= 0, `${seen.cut} px of the matrix are cut off`);
  assert.ok(seen.bottom < 900 && seen.strip < 900);
  assert.match(seen.title, /wall-collapse/);
  await page.close();
});

test('frozen bodies and deep overlap are said at first', async () => {
  const first = async (path) => { const { page } = await open(path); const text = await page.$eval('#overview', (o) => o.innerText); await page.close(); return text; };
  assert.match(await first('frozen/index.html'), /nothing moves in 1/);
  assert.match(await first('frozen/index.html'), /never moves/);
  assert.match(await first('canonical/index.html'), /0\.6\d m deep/);
});

test('nothing is wider than a phone', async () => {
  for (const path of pages.filter((p) => !p.startsWith('hostile'))) {
    const { page } = await open(path, phone);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= phone.width, path);
    await page.close();
  }
});

test('hostile names are shown as text', async () => {
  const { page, faults } = await open('hostile-page/index.html');
  const text = await page.$eval('main', (m) => m.textContent);
  assert.ok(text.includes('</script><script>alert(1)</script>') && text.includes('<img src=x onerror=alert(2)>'));
  assert.equal(await page.$$eval('main img, main script', (e) => e.length), 0);
  assert.deepEqual(faults, []);
  await page.close();
});

test('two thousand runs open and scroll', async () => {
  const { page, faults } = await open('many-page/index.html');
  assert.equal(await page.$$eval('section[id^=case-]', (s) => s.length), 200);
  await show(page, 'case-199', 'table');
  assert.deepEqual(faults, []);
  await page.close();
});

test('axe finds no serious fault', async () => {
  for (const [path, theme] of [['canonical/index.html', 'light'], ['canonical/index.html', 'dark'], ...pages.filter((p) => p.startsWith('studies')).map((p) => [p, 'light'])]) {
    const { page } = await open(path, wide, theme);
    if (path.startsWith('canonical')) await show(page, 'case-0', 'line.cursor');
    await page.evaluate(axe);
    const { violations } = await page.evaluate(() => globalThis.axe.run());
    const serious = violations.filter((v) => ['serious', 'critical'].includes(v.impact)).map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((n) => n.html.slice(0, 160)).join(' | ')}`);
    assert.deepEqual(serious, [], `${path}, ${theme}`);
    await page.close();
  }
});

test('the page can be mailed', () => {
  assert.ok(statSync('canonical/index.html').size < 10e6);
});
