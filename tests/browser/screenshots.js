// Pictures of reports: `node screenshots.js REPORTS_FOLDER PICTURES_FOLDER` writes for each page the whole of
// it and the view at the beginning, in the middle and from close by, and tells how many pictures a second it draws.

import { mkdirSync, readdirSync } from 'node:fs';
import { basename, join } from 'node:path';
import { launch, open, settled } from './browser.js';

const [reports, pictures] = process.argv.slice(2);
mkdirSync(pictures, { recursive: true });
const said = (faults) => (faults.length > 0 ? `; ${faults.join('; ')}` : '');
const browser = await launch();
for (const file of readdirSync(reports).filter((name) => name.endsWith('.html')).sort()) {
  const name = basename(file, '.html');
  const { page, faults } = await open(browser, join(reports, file), { width: 1280, height: 860 });
  await settled(page);
  const picture = (what) => page.screenshot({ path: join(pictures, `${name}-${what}.png`) });
  await page.screenshot({ path: join(pictures, `${name}-page.png`), fullPage: true });
  if (!(await page.$('.view'))) {
    console.log(`${name}: no view${said(faults)}`);
    await page.close();
    continue;
  }
  await page.$eval('.view', (view) => view.scrollIntoView({ block: 'end' }));
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
  await page.evaluate(() => {
    const names = [...document.querySelectorAll('[data-view="look"] option')].map((it) => it.value);
    window.aerobotView.lookAt(names.at(-1));
  });
  await settled(page);
  await picture('close');
  console.log(`${name}: ${drawn.toFixed(1)} pictures/s${said(faults)}`);
  await page.close();
}
await browser.close();
