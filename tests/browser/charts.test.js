// The charts of every page in the folder $REPORTS, with the network cut.

import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { launch, open, settled } from './browser.js';

const reports = process.env.REPORTS;
const files = (reports ? readdirSync(reports) : []).filter((name) => (
  name.endsWith('.html') && readFileSync(join(reports, name), 'utf8').includes('<figure class="chart"'))).sort();

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

test('there are pages with charts', { skip: !reports && 'REPORTS is not given' }, () => {
  assert.ok(files.length > 0, 'REPORTS is to be a folder with reports');
});

const ranges = (page) => page.evaluate(() => window.aerobotCharts.timeRanges());

/** The first chart over time, and the place of its first panel on the screen. */
function firstTimePanel(page) {
  return page.evaluate(() => {
    const figure = [...document.querySelectorAll('figure.chart')].find((it) => it.chart.spec.time_axes.length);
    if (!figure) return null;
    figure.scrollIntoView();
    const layout = figure.chart.plot._fullLayout;
    const box = figure.chart.plot.getBoundingClientRect();
    const [x, y] = [layout.xaxis, layout.yaxis];
    return { left: box.left + x._offset, top: box.top + y._offset, width: x._length, height: y._length };
  });
}

for (const file of files) {
  describe(file, () => {
    let page;
    let faults;
    let panel;
    before(async () => {
      ({ page, faults } = await open(browser, join(reports, file)));
      await page.evaluate(() => window.aerobotCharts.drawAll());
      panel = await firstTimePanel(page);
      await settled(page);
    });
    after(() => page?.close());

    test('every figure is drawn, with a name and a unit at each axis', async () => {
      const charts = await page.evaluate(() => [...document.querySelectorAll('figure.chart')].map((figure) => {
        const layout = figure.chart.plot._fullLayout;
        const axes = Object.keys(layout).filter((key) => /^[xy]axis\d*$/.test(key)).map((key) => layout[key]);
        return {
          name: figure.dataset.name,
          curves: figure.chart.plot.querySelectorAll('.scatterlayer .trace, .barlayer .trace').length,
          expected: figure.chart.spec.data.length,
          // Panels under one another have the name of their time below the last.
          labels: axes.filter((axis) => axis._anchorAxis && !axis.ticktext).map((axis) => axis.title.text ?? ''),
        };
      }));
      assert.ok(charts.length > 0);
      for (const chart of charts) {
        assert.ok(chart.curves > 0 && chart.curves <= chart.expected, `${chart.name}: ${chart.curves} curves`);
        const named = chart.labels.filter((label) => label && !/Click to enter/.test(label));
        assert.ok(named.length >= 2, `${chart.name}: ${chart.labels}`);
        for (const label of named) assert.match(label, /\[[^\]]+\]/, `${chart.name}: ${label}`);
      }
    });

    test('no text of a chart is cut off at its edge', async () => {
      const cut = await page.evaluate(() => [...document.querySelectorAll('figure.chart')].flatMap((figure) => {
        const box = figure.chart.plot.getBoundingClientRect();
        const texts = [...figure.chart.plot.querySelectorAll('.xtitle, .ytitle, .xtick text, .ytick text, .legendtext')];
        return texts.filter((text) => {
          const own = text.getBoundingClientRect();
          return own.width > 0 && (own.left < box.left - 1 || own.right > box.right + 1 || own.top < box.top - 2
            || own.bottom > box.bottom + 2);
        }).map((text) => `${figure.dataset.name}: ${text.textContent}`);
      }));
      assert.deepEqual(cut, []);
    });

    test('the name of an axis is no longer than its axis', async () => {
      const long = await page.evaluate(() => [...document.querySelectorAll('figure.chart')].flatMap((figure) => {
        const layout = figure.chart.plot._fullLayout;
        return Object.keys(layout).filter((key) => /^yaxis\d*$/.test(key)).filter((key) => {
          const name = figure.chart.plot.querySelector(`.${key.replace('axis', '')}title`);
          return name && name.getBoundingClientRect().height > layout[key]._length + 8;
        }).map((key) => `${figure.dataset.name}: ${layout[key].title.text}`);
      }));
      assert.deepEqual(long, []);
    });

    test('a stretch of time that is dragged over in one chart is shown by all, a double click shows all of it', async () => {
      if (!panel) return;
      const whole = await ranges(page);
      const [y, from, to] = [panel.top + 0.5 * panel.height, panel.left + 0.25 * panel.width, panel.left + 0.5 * panel.width];
      await page.mouse.move(from, y);
      await page.mouse.down();
      await page.mouse.move(0.5 * (from + to), y, { steps: 4 });
      await page.mouse.move(to, y, { steps: 4 });
      await page.mouse.up();
      const [start, end] = whole[0];
      const near = (range, low, high) => Math.abs(range[0] - low) + Math.abs(range[1] - high) < 0.02 * (end - start);
      await page.waitForFunction((one) => (
        window.aerobotCharts.timeRanges().every(([low, high]) => high - low < 0.4 * one)), { timeout: 20_000 }, end - start);
      for (const range of await ranges(page)) {
        assert.ok(near(range, start + 0.25 * (end - start), start + 0.5 * (end - start)), `${range}`);
      }
      await page.mouse.click(0.5 * (from + to), y, { count: 2 });
      await page.waitForFunction((one) => (
        window.aerobotCharts.timeRanges().every(([low, high]) => high - low > 0.9 * one)), { timeout: 20_000 }, end - start);
    });

    test('charts show the time of the view, and a click on one is a time for the view', async () => {
      if (!panel || !(await page.$('.view'))) return;
      panel = await firstTimePanel(page);
      const place = await page.evaluate(() => {
        const [start, end] = window.aerobotView.span();
        window.aerobotView.seek(start + 0.5 * (end - start));
        return new Promise((done) => {
          requestAnimationFrame(() => requestAnimationFrame(() => {
            const cursor = [...document.querySelectorAll('.time-cursor')].find((it) => it.style.display === 'block');
            done(cursor && cursor.getBoundingClientRect().left);
          }));
        });
      });
      assert.ok(Math.abs(place - (panel.left + 0.5 * panel.width)) < 0.03 * panel.width, `${place}`);
      const asked = await page.evaluate(() => {
        const figure = [...document.querySelectorAll('figure.chart')].find((it) => it.chart.spec.time_axes.length);
        const x = figure.chart.plot._fullData[0].x;
        const asked_s = x[Math.floor(x.length / 4)];
        figure.chart.plot.emit('plotly_click', { points: [{ x: asked_s }] });
        return [asked_s, window.aerobotView.time()];
      });
      assert.ok(Math.abs(asked[0] - asked[1]) < 1e-6 + 1e-3 * Math.abs(asked[0]), `${asked}`);
    });

    test('has had no fault', () => {
      assert.deepEqual(faults, []);
    });
  });
}
