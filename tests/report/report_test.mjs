// Reports in a browser: figures show the documents' numbers to mouse and keys, and nothing is asked for elsewhere.
//   node report_test.mjs ROSIN EXAMPLES FOLDER, where playwright-core is installed in FOLDER
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';

const [rosin, examples, folder, chromiumPath] = process.argv.slice(2);
const {chromium} = createRequire(join(folder, 'package.json'))('playwright-core');
const run = (...line) => execFileSync(rosin, line, {cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe']});
const document_ = name => JSON.parse(readFileSync(join(folder, name), 'utf8'));
const near = (a, b, relative = 1e-8) => Math.abs(a - b) <= relative * Math.max(Math.abs(a), Math.abs(b));

for (const old of ['plane', 'motion']) rmSync(join(folder, old), {recursive: true, force: true});
run('map', join(examples, 'bristol-board-plane.toml'), '--set', 'map.x.points=12', '--set', 'map.y.points=12', '--out', 'plane', '--no-pictures');
run('cycle', join(examples, 'bristol-board-cycle.toml'), '--set', 'drive.normal_load=5e-4', '--out', 'plane', '--no-pictures');
run('run', join(examples, 'coulomb-stick-slip.toml'), '--out', 'motion', '--no-pictures');
for (const name of ['plane', 'motion']) run('report', name);

const browser = await chromium.launch({executablePath: chromiumPath, args: ['--no-sandbox']});
const problems = [];

async function open(name, settings = {}) {
  const page = await browser.newPage({viewport: {width: 1280, height: 900}, ...settings});
  page.setDefaultTimeout(8000);
  page.on('console', message => problems.push(`${name}: console: ${message.text()}`));
  page.on('pageerror', error => problems.push(`${name}: ${error.message}`));
  page.on('request', request => {
    if (!/^(file|data):/.test(request.url())) problems.push(`${name} asks for ${request.url()}`);
  });
  await page.goto(`file://${join(folder, name, 'report.html')}`);
  await page.waitForSelector('.area svg .axis', {state: 'attached'});
  return page;
}

/** Numbers by the name of their quantity, as an element shows them. */
const shown = place => place.evaluate(element =>
  Object.fromEntries([...element.querySelectorAll('data')].map(data => [data.dataset.quantity, data.value === '' ? null : Number(data.value) || data.value])));
const ticks = figure => figure.locator('.axis text').allTextContents();

const tests = {
  async 'a point of a plane shows its numbers to the mouse, and the command that computes its cycle'() {
    const page = await open('plane'), map = document_('plane/map.json');
    const figure = page.locator('#map figure').first(), area = figure.locator('.area');
    await area.scrollIntoViewIfNeeded();
    const box = await area.boundingBox();
    await page.mouse.move(box.x + box.width * 0.5, box.y + box.height * 0.6);
    const hovered = await shown(figure.locator('.readout'));
    const ix = map.x.values.findIndex(value => value === hovered['normal load']);
    const iy = map.y.values.findIndex(value => value === hovered['clock factor of the states']);
    assert.ok(ix >= 0 && iy >= 0, JSON.stringify(hovered));
    assert.ok(near(hovered['stick fraction'], map.metrics.stick_fraction[iy][ix]));
    await page.mouse.click(box.x + box.width * 0.5, box.y + box.height * 0.6);
    const details = await shown(figure.locator('.details'));
    assert.equal(details.regime, map.regime[iy][ix]);
    assert.ok(near(details['loop area normalised'], map.metrics.loop_area_normalised[iy][ix]));
    const command = (await figure.locator('.command').textContent()).split(' ');
    assert.deepEqual(command.slice(0, 2), ['rosin', 'cycle']);
    const cycle = JSON.parse(run(...command.slice(1), '--json', '--no-pictures', '--out', 'point'));
    assert.ok(near(cycle.stick_fraction, map.metrics.stick_fraction[iy][ix], 1e-3));
    await page.close();
  },

  async 'the keys alone go to a plane and through its points, to the one whose cycle is there'() {
    const page = await open('plane'), map = document_('plane/map.json'), cycle = document_('plane/cycle.manifest.json');
    for (let i = 0; i < 40 && !(await page.evaluate(() => document.activeElement.closest('#map .area'))); ++i) await page.keyboard.press('Tab');
    const details = page.locator('#map .details').first();
    await page.keyboard.press('ArrowRight');
    assert.equal((await shown(details))['normal load'], map.x.values[0]);
    const nearest = (values, wanted) => values.reduce((best, value, i) =>
      Math.abs(Math.log(value / wanted)) < Math.abs(Math.log(values[best] / wanted)) ? i : best, 0);
    const ix = nearest(map.x.values, cycle.parameters['drive.normal_load'].value);
    const iy = nearest(map.y.values, cycle.parameters['law.lambda'].value);
    for (let i = 0; i < ix; ++i) await page.keyboard.press('ArrowRight');
    for (let i = 0; i < iy; ++i) await page.keyboard.press('ArrowUp');
    const there = await shown(details);
    assert.deepEqual([there['normal load'], there['clock factor of the states']], [map.x.values[ix], map.y.values[iy]]);
    await details.locator('a[href="#cycle"]').click();
    assert.ok(await page.locator('#cycle').isVisible());
    await page.close();
  },

  async 'a motion shows its samples to mouse and keys'() {
    const page = await open('motion'), motion = document_('motion/run.json');
    const figure = page.locator('#run figure').first(), area = figure.locator('.area'), box = await area.boundingBox();
    const isSample = ({time, displacement}) => motion.time.some((at, i) =>
      near(at, time ?? 0) && near(motion.columns.displacement[i], displacement ?? 0));
    for (const share of [0.2, 0.5, 0.77]) {
      await page.mouse.move(box.x + box.width * share, box.y + box.height * 0.5);
      const sample = await shown(figure.locator('.readout'));
      assert.ok(isSample(sample), JSON.stringify(sample));
    }
    const before = (await shown(figure.locator('.readout'))).time;
    await area.focus();
    await page.keyboard.press('ArrowRight');
    const after = await shown(figure.locator('.readout'));
    assert.ok(isSample(after));
    assert.equal(motion.time.findIndex(at => near(at, after.time)), motion.time.findIndex(at => near(at, before)) + 1);
    await page.close();
  },

  async 'drag, wheel, buttons and keys zoom; reset shows all'() {
    const page = await open('motion'), figure = page.locator('#run figure').first(), area = figure.locator('.area');
    const all = await ticks(figure), box = await area.boundingBox();
    const changed = async () => { assert.notDeepEqual(await ticks(figure), all); };
    const reset = async () => {
      await figure.getByRole('button', {name: 'Show all'}).click();
      assert.deepEqual(await ticks(figure), all);
    };
    await page.mouse.move(box.x + 300, box.y + 80);
    await page.mouse.down();
    await page.mouse.move(box.x + 500, box.y + 250, {steps: 4});
    await page.mouse.up();
    await changed();
    await reset();
    await page.mouse.move(box.x + 400, box.y + 150);
    await page.mouse.wheel(0, -400);
    await page.waitForTimeout(50);
    await changed();
    await reset();
    await figure.getByRole('button', {name: 'Zoom in'}).click();
    await changed();
    await area.focus();
    await page.keyboard.press('0');
    assert.deepEqual(await ticks(figure), all);
    await page.close();
  },

  async 'the numbers of a figure open as a table, and the scene can be copied'() {
    const page = await open('motion'), motion = document_('motion/run.json');
    await page.locator('#run details.numbers summary').first().click();
    const rows = page.locator('#run details.numbers').first().locator('tbody tr');
    await rows.first().waitFor(); // they are written as the table opens
    assert.equal(await rows.count(), Math.min(500, motion.time.length));
    await page.getByText('The scene, as resolved').click();
    await page.locator('#run button.copy').last().click();
    await page.close();
  },

  async 'a narrow screen scrolls down only, in the dark too'() {
    for (const name of ['plane', 'motion']) {
      const page = await open(name, {viewport: {width: 390, height: 800}, colorScheme: 'dark'});
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      await page.close();
    }
  },

  async 'pages print'() {
    const page = await open('plane');
    const pdf = await page.pdf({format: 'A4'});
    assert.equal(pdf.subarray(0, 5).toString(), '%PDF-');
    assert.ok(pdf.length > 20_000);
    await page.close();
  },

  async 'without scripts the verdict and the tables are there'() {
    const page = await browser.newPage({javaScriptEnabled: false});
    await page.goto(`file://${join(folder, 'plane', 'report.html')}`);
    assert.match(await page.locator('#cycle .verdict').textContent(), /has the period \(?\d/);
    assert.ok(await page.locator('#map table').count() > 0);
    await page.close();
  },

  async 'nothing was asked for elsewhere, and the console stayed empty'() {
    assert.deepEqual(problems, []);
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  try {
    await test();
    console.log(`passed: ${name}`);
  } catch (error) {
    ++failed;
    console.log(`FAILED: ${name}\n${error.stack}`);
  }
}
await browser.close();
console.log(`${Object.keys(tests).length - failed} passed, ${failed} failed`);
process.exit(failed ? 1 : 0);
