// The page of `cargo run -p aerobot-report --example yawed_page`, of which one knows how it looks; its file is
// given by $KNOWN. What is looked at are the colours of pixels, not what the page says of itself.

import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { launch, open, pixels, placeOf, settled } from './browser.js';

const file = process.env.KNOWN;

describe('a page of which one knows how it looks', { skip: !file }, () => {
  let browser;
  let page;
  let faults;
  before(async () => {
    browser = await launch();
    ({ page, faults } = await open(browser, file));
    for (const name of ['grid', 'labels', 'axes']) await page.click(`[data-view="${name}"]`);
    await page.select('[data-view="arrows"]', 'none');
  });
  after(() => browser?.close());

  /** Pixels of the view, and its middle, after something was done in the page. */
  async function looked(done) {
    await page.evaluate(done);
    await settled(page);
    const stage = await placeOf(page, '.view-canvas');
    const at = await pixels(page, stage);
    const scale = stage.height / (await page.evaluate(() => window.aerobotView.camera().height_m));
    return { at: (x_m, y_m) => at(stage.width / 2 + scale * x_m, stage.height / 2 - scale * y_m), scale };
  }

  const isWhite = ([red, green, blue]) => red > 250 && green > 250 && blue > 250;

  test('a body yawed by a right angle points along +y: upright from above, 1 m wide, from -1 m to 7 m', async () => {
    const { at, scale } = await looked(() => {
      window.aerobotView.lookAt('body:bar');
      window.aerobotView.lookAlong('top');
    });
    assert.ok(scale > 8, 'one sees 8 m well');
    // The ball of 1 m radius is above its place.
    for (const y_m of [2, 4, 6.8]) assert.ok(!isWhite(at(0, y_m)), `y = ${y_m} m`);
    for (const y_m of [-1.2, -3, -6, 7.2]) assert.ok(isWhite(at(0, y_m)), `y = ${y_m} m`);
    for (const x_m of [-0.4, 0.4]) assert.ok(!isWhite(at(x_m, 3)), `x = ${x_m} m`);
    for (const x_m of [-3, -0.65, 0.65, 3]) assert.ok(isWhite(at(x_m, 3)), `x = ${x_m} m`);
  });

  test('from the side one sees its end, 1 m by 1 m', async () => {
    const { at } = await looked(() => window.aerobotView.lookAlong('side'));
    for (const [x_m, z_m] of [[0.4, 0.4], [-0.4, -0.4]]) assert.ok(!isWhite(at(x_m, z_m)));
    for (const [x_m, z_m] of [[0.6, 0], [-0.6, 0], [0, -0.6]]) assert.ok(isWhite(at(x_m, z_m)));
  });

  test('its line is there until it is cut', async () => {
    const { at: whole } = await looked(() => window.aerobotView.seek(4.8));
    assert.ok(!isWhite(whole(0, 3)));
    const { at: cut } = await looked(() => window.aerobotView.seek(5));
    assert.ok(isWhite(cut(0, 3)));
    assert.match(await page.$eval('.view-event', (it) => it.textContent), /line\/1: cut/);
  });

  test('between two frames it is where a straight line has it', async () => {
    const position_m = await page.evaluate(() => {
      window.aerobotView.seek(3.333);
      return window.aerobotView.bodies()[0].position_m;
    });
    assert.ok(Math.abs(position_m[2] - 56_003.333) < 1e-3);
  });

  test('a name that looks like the end of a script is a name', async () => {
    const names = await page.$$eval('.view-name', (all) => all.map((it) => it.textContent));
    assert.deepEqual(names, ['bar', 'ball </script>']);
    assert.deepEqual(faults, []);
  });
});
