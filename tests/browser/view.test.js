// The 3-D view of every page in the folder $REPORTS, with the network cut.

import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { launch, open, placeOf, settled } from './browser.js';

const reports = process.env.REPORTS;
// Pages of campaigns have no view.
const files = (reports ? readdirSync(reports) : []).filter((name) => (
  name.endsWith('.html') && readFileSync(join(reports, name), 'utf8').includes('<section class="view"'))).sort();

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

test('there are pages to be looked at', { skip: !reports && 'REPORTS is not given' }, () => {
  assert.ok(files.length > 0, 'REPORTS is to be a folder with reports of runs');
});

const time = (page) => page.evaluate(() => window.aerobotView.time());
const camera = (page) => page.evaluate(() => window.aerobotView.camera());
const wait = (ms) => new Promise((done) => { setTimeout(done, ms); });

/** The picture of the view, as text. */
async function picture(page) {
  await settled(page);
  const stage = await page.$('.view-stage');
  return stage.screenshot({ encoding: 'base64', captureBeyondViewport: false });
}

/** Seeks to a part of the run. */
function seek(page, part) {
  return page.evaluate((it) => {
    const [start, end] = window.aerobotView.span();
    window.aerobotView.seek(start + it * (end - start));
  }, part);
}

for (const file of files) {
  describe(file, () => {
    let page;
    let faults;
    before(async () => {
      ({ page, faults } = await open(browser, join(reports, file)));
      await page.waitForFunction(() => window.aerobotView?.framesDrawn() > 0, { timeout: 30_000 });
      await page.addStyleTag({ content: 'html { scroll-behavior: auto !important; }' });
      await page.$eval('.view', (view) => view.scrollIntoView({ block: 'end' }));
    });
    after(() => page?.close());

    test('is drawn when it is opened, at its start', async () => {
      const [start] = await page.evaluate(() => window.aerobotView.span());
      assert.equal(await time(page), start);
      assert.equal(await page.evaluate(() => window.aerobotView.isPlaying()), false);
    });

    test('draws nothing as long as nothing changes', async () => {
      await settled(page);
      const drawn = await page.evaluate(() => window.aerobotView.framesDrawn());
      await wait(300);
      assert.equal(await page.evaluate(() => window.aerobotView.framesDrawn()), drawn);
    });

    test('plays at its speed, and stands when paused', async () => {
      await page.evaluate(() => {
        window.told = [];
        document.addEventListener('aerobot:time', (event) => window.told.push(event.detail.time_s));
      });
      const speed = Number(await page.$eval('[data-view="speed"]', (it) => it.value));
      const before_s = await time(page);
      await page.click('[data-view="play"]');
      await wait(1000);
      await page.click('[data-view="play"]');
      const paused_s = await time(page);
      // A loaded machine draws late, and a page never jumps; it is never ahead of the clock.
      assert.ok(paused_s > before_s, 'time goes on');
      assert.ok(paused_s - before_s < 4 * speed, `${paused_s - before_s} s`);
      await wait(200);
      assert.equal(await time(page), paused_s);
      const told = await page.evaluate(() => window.told);
      assert.equal(told.at(-1), paused_s);
      assert.ok(told.every((it, index) => index === 0 || it > told[index - 1]));
    });

    test('shows the time that the slider says, and that a chart asks for', async () => {
      const [start, end] = await page.evaluate(() => window.aerobotView.span());
      const wanted_s = start + 0.25 * (end - start);
      await page.$eval('[data-view="time"]', (slider, value) => {
        slider.value = value;
        slider.dispatchEvent(new Event('input', { bubbles: true }));
      }, wanted_s);
      const found_s = await time(page);
      assert.ok(Math.abs(found_s - wanted_s) < 1e-6 * (end - start), `${found_s} s`);
      await page.evaluate((time_s) => {
        document.dispatchEvent(new CustomEvent('aerobot:seek', { detail: { time_s } }));
      }, start + 0.75 * (end - start));
      assert.equal(await time(page), start + 0.75 * (end - start));
      assert.equal(Number(await page.$eval('[data-view="time"]', (slider) => slider.value)), await time(page));
    });

    test('what moves is seen to move', async (context) => {
      const seen = [];
      for (const part of [0, 0.2, 0.4, 0.6, 0.8, 1]) {
        await seek(page, part);
        const shown = await picture(page);
        // Pixels to the right and down.
        const numbers = await page.evaluate(() => window.aerobotView.bodies().flatMap((it) => {
          const { x, y } = window.aerobotView.project(it.position_m);
          return [x, y];
        }));
        seen.push({ shown, numbers });
      }
      const moves = seen.some(({ numbers }) => numbers.some((it, k) => Math.abs(it - seen[0].numbers[k]) > 2));
      if (!moves) {
        context.skip('no body moves by two pixels');
        return;
      }
      assert.ok(new Set(seen.map(({ shown }) => shown)).size > 1);
    });

    test('goes slower when told to', async () => {
      await seek(page, 0);
      const speeds = await page.$$eval('[data-view="speed"] option', (all) => all.map((it) => it.value));
      await page.select('[data-view="speed"]', speeds[0]);
      await page.evaluate(() => window.aerobotView.play());
      await wait(700);
      const slow_s = await time(page);
      await page.evaluate(() => window.aerobotView.pause());
      assert.ok(slow_s > 0 && slow_s < 4 * 0.1, `${slow_s} s at a tenth of real time`);
    });

    test('keys play and step', async () => {
      await seek(page, 0.5);
      await page.focus('.view-stage');
      const before_s = await time(page);
      await page.keyboard.press('ArrowRight');
      const later_s = await time(page);
      assert.ok(later_s > before_s);
      await page.keyboard.press('ArrowLeft');
      assert.ok(await time(page) < later_s);
      await page.keyboard.press('Space');
      assert.equal(await page.evaluate(() => window.aerobotView.isPlaying()), true);
      await page.keyboard.press('Space');
      assert.equal(await page.evaluate(() => window.aerobotView.isPlaying()), false);
    });

    test('wheel, drag and shift-drag move the camera', async () => {
      const { x, y, width, height } = await placeOf(page, '.view-stage');
      const first = await picture(page);
      const from = await camera(page);
      await page.mouse.move(x + 0.6 * width, y + 0.4 * height);
      await page.mouse.wheel({ deltaY: -400 });
      assert.ok(await picture(page) !== first, 'the picture is another');
      const near = await camera(page);
      assert.ok(near.height_m < 0.8 * from.height_m);
      await page.mouse.down();
      await page.mouse.move(x + 0.7 * width, y + 0.45 * height, { steps: 4 });
      await page.mouse.up();
      await settled(page);
      const turned = await camera(page);
      assert.notEqual(turned.azimuth, near.azimuth);
      assert.deepEqual(turned.target_m, near.target_m);
      await page.keyboard.down('Shift');
      await page.mouse.down();
      await page.mouse.move(x + 0.6 * width, y + 0.4 * height, { steps: 4 });
      await page.mouse.up();
      await page.keyboard.up('Shift');
      await settled(page);
      const moved = await camera(page);
      assert.equal(moved.azimuth, turned.azimuth);
      assert.notDeepEqual(moved.target_m, turned.target_m);
      await page.click('[data-view="reset"]');
      await settled(page);
      const back = await camera(page);
      assert.ok(Math.abs(back.height_m / from.height_m - 1) < 1e-9);
    });

    test('looks at each body and goes with it', async () => {
      const looks = await page.$$eval('[data-view="look"] option', (all) => all.map((it) => it.value));
      assert.ok(looks.includes('whole'));
      for (const look of looks.filter((it) => it.startsWith('body:')).slice(0, 6)) {
        await page.select('[data-view="look"]', look);
        for (const part of [0.2, 0.8]) {
          await seek(page, part);
          await settled(page);
          const [target_m, position_m] = await page.evaluate((name) => [
            window.aerobotView.camera().target_m,
            window.aerobotView.bodies().find((it) => it.name === name).position_m,
          ], look.slice(5));
          target_m.forEach((it, k) => assert.ok(Math.abs(it - position_m[k]) < 1e-6));
        }
      }
      await page.select('[data-view="look"]', looks[0]);
    });

    test('from above, x is to the right and y is up; from the side, z is up', async () => {
      const ways = (origin) => page.evaluate(([x, y, z]) => {
        const at = (point) => window.aerobotView.project(point);
        const from = at([x, y, z]);
        return [[x + 1, y, z], [x, y + 1, z], [x, y, z + 1]].map((it) => {
          const to = at(it);
          return [Math.sign(Math.round(1e6 * (to.x - from.x))), Math.sign(Math.round(1e6 * (from.y - to.y)))];
        });
      }, origin);
      const origin = (await camera(page)).target_m;
      for (const [direction, expected] of [
        ['top', [[1, 0], [0, 1], [0, 0]]],
        ['side', [[1, 0], [0, 0], [0, 1]]],
        ['front', [[0, 0], [-1, 0], [0, 1]]],
      ]) {
        await page.click(`[data-view-along="${direction}"]`);
        await settled(page);
        const found = (await ways(origin)).map((way) => way.map((it) => it + 0));
        assert.deepEqual(found, expected, direction);
      }
      await page.click('[data-view="reset"]');
    });

    test('names of bodies stand apart, inside of the picture', async () => {
      await seek(page, 0.5);
      await settled(page);
      const stage = await placeOf(page, '.view-stage');
      const boxes = await page.$$eval('.view-name', (all) => all.filter((it) => it.style.visibility === 'visible')
        .map((it) => it.getBoundingClientRect().toJSON()));
      assert.ok(boxes.length > 0);
      boxes.forEach((a, index) => {
        assert.ok(a.left >= stage.x - 1 && a.right <= stage.x + stage.width + 1);
        for (const b of boxes.slice(0, index)) {
          const beside = a.right <= b.left + 1 || b.right <= a.left + 1;
          const apart = beside || a.bottom <= b.top + 1 || b.bottom <= a.top + 1;
          assert.ok(apart, 'two names cover each other');
        }
      });
      await page.click('[data-view="labels"]');
      await settled(page);
      const shown = await page.$$eval('.view-name', (all) => (
        all.filter((it) => it.style.visibility === 'visible').length));
      assert.equal(shown, 0);
      await page.click('[data-view="labels"]');
    });

    test('numbers of axes are inside of the picture', async () => {
      await settled(page);
      const stage = await placeOf(page, '.view-stage');
      const boxes = await page.$$eval('.view-tick', (all) => all.filter((it) => it.style.visibility === 'visible')
        .map((it) => ({ text: it.textContent, ...it.getBoundingClientRect().toJSON() })));
      assert.ok(boxes.length >= 3);
      for (const box of boxes) {
        const inside = box.left >= stage.x && box.right <= stage.x + stage.width
          && box.top >= stage.y && box.bottom <= stage.y + stage.height;
        assert.ok(inside, `${box.text} is cut off`);
      }
    });

    test('another run can be hidden', async (context) => {
      const runs = await page.$$('.view-legend input[type="checkbox"]');
      if (runs.length < 2) {
        context.skip('there is one run');
        return;
      }
      const both = await picture(page);
      await runs[1].click();
      assert.ok(await picture(page) !== both, 'the picture is another');
      await runs[1].click();
      assert.ok(await picture(page) === both, 'the picture is as before');
    });

    test('fits a smaller window', async () => {
      await page.setViewport({ width: 700, height: 600 });
      await settled(page);
      const [canvas, stage] = await Promise.all([placeOf(page, '.view-canvas'), placeOf(page, '.view-stage')]);
      assert.ok(Math.abs(canvas.width - stage.width) < 3 && stage.width < 700);
      assert.equal(await page.$eval('.view-canvas', (it) => it.width), Math.round(canvas.width));
      await page.setViewport({ width: 1280, height: 900 });
    });

    test('has said nothing of errors, and asked for nothing outside of the file', () => {
      assert.deepEqual(faults, []);
    });
  });
}

test('without WebGL2 there is a sentence in place of the picture', { skip: files.length === 0 }, async () => {
  const bare = await launch(['--disable-gpu', '--disable-3d-apis']);
  try {
    const { page, faults } = await open(bare, join(reports, files[0]));
    await settled(page);
    assert.match(await page.$eval('.view-stage', (it) => it.textContent), /needs WebGL2/);
    await page.evaluate(() => window.aerobotView.play());
    await wait(300);
    assert.ok(await time(page) > 0, 'charts are told the time all the same');
    assert.deepEqual(faults, []);
  } finally {
    await bare.close();
  }
});
