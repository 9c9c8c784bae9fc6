// Pictures of reports: `node screenshots.js REPORTS_FOLDER PICTURES_FOLDER` writes for each page the whole of
// it, screen by screen, and the view at the beginning, in the middle and from close by, and tells how many pictures a second it draws.

import { mkdirSync, readdirSync } from 'node:fs';
import { basename, join } from 'node:path';
import { launch, open, settled } from './browser.js';

// With a third argument, the name of a body, the view from close by looks at it.
const [reports, pictures, body] = process.argv.slice(2);
const [WIDTH, HEIGHT] = [1280, 860];
// Of one picture of a whole page Chromium draws the first 8192 pixels, and then these again.
const TALL = 2000;

async function wholePage(page, path) {
  await page.setViewport({ width: WIDTH, height: TALL });
  await settled(page);
  const tall = await page.evaluate(() => document.documentElement.scrollHeight);
  for (let place = 0; place * TALL < tall; place += 1) {
    await page.evaluate((y) => window.scrollTo(0, y), place * TALL);
    await settled(page);
    await page.screenshot({ path: `${path}-page-${place + 1}.png` });
  }
  await page.setViewport({ width: WIDTH, height: HEIGHT });
}

mkdirSync(pictures, { recursive: true });
const browser = await launch();
for (const file of readdirSync(reports).filter((name) => name.endsWith('.html')).sort()) {
  const name = basename(file, '.html');
  const { page, faults } = await open(browser, join(reports, file), { width: WIDTH, height: HEIGHT });
  await settled(page);
  await page.evaluate(() => window.aerobotCharts?.drawAll());
  await wholePage(page, join(pictures, name));
  const view = await page.$('.view');
  if (!view) {
    console.log(`${name}: no view${faults.length ? `; ${faults.join('; ')}` : ''}`);
    await page.close();
    continue;
  }
  await view.evaluate((it) => it.scrollIntoView());
  await settled(page);
  const picture = async (what) => view.screenshot({ path: join(pictures, `${name}-${what}.png`) });
  const drawn = await page.evaluate(async () => {
    const view = window.aerobotView;
    view.play();
    await new Promise((done) => { setTimeout(done, 500); });
    const [from, since] = [view.framesDrawn(), performance.now()];
    await new Promise((done) => { setTimeout(done, 3000); });
    const rate = (1000 * (view.framesDrawn() - from)) / (performance.now() - since);
    view.pause();
    return rate;
  });
  await page.evaluate(() => {
    const [start, end] = window.aerobotView.span();
    window.aerobotView.seek(start + 0.55 * (end - start));
  });
  await settled(page);
  await picture('middle');
  await page.evaluate((wanted) => {
    const names = [...document.querySelectorAll('[data-view="look"] option')].map((it) => it.value);
    window.aerobotView.lookAt(names.find((it) => it.endsWith(wanted)) ?? names.at(-1));
  }, body ?? '\n');
  await settled(page);
  await picture('close');
  console.log(`${name}: ${drawn.toFixed(1)} pictures/s${faults.length ? `; ${faults.join('; ')}` : ''}`);
  await page.close();
}
await browser.close();
