// Chromium without a network, and the pages that are opened in it.

import { existsSync } from 'node:fs';
import { delimiter, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import puppeteer from 'puppeteer-core';

const FLAGS = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--no-sandbox',
  '--hide-scrollbars'];

/** The browser: $CHROMIUM, or one of the usual names on the path. */
export function chromium() {
  if (process.env.CHROMIUM) return process.env.CHROMIUM;
  const folders = (process.env.PATH ?? '').split(delimiter);
  for (const name of ['chromium', 'chromium-browser', 'google-chrome', 'chrome']) {
    const found = folders.map((folder) => join(folder, name)).find((file) => existsSync(file));
    if (found) return found;
  }
  throw new Error('no Chromium on the path; its place can be given by CHROMIUM');
}

export function launch(flags = []) {
  return puppeteer.launch({
    executablePath: chromium(),
    headless: true,
    args: [...FLAGS, ...flags],
    protocolTimeout: 120_000,
  });
}

/** Opens a file with the network cut; `faults` gathers errors, warnings and requests to elsewhere. */
export async function open(browser, file, size = { width: 1280, height: 900 }) {
  const page = await browser.newPage();
  const faults = [];
  await page.setViewport(size);
  await page.setOfflineMode(true);
  await page.setRequestInterception(true);
  page.on('request', (request) => {
    if (/^(file|data|blob|about):/.test(request.url())) {
      request.continue();
    } else {
      faults.push(`request to ${request.url()}`);
      request.abort();
    }
  });
  page.on('console', (message) => {
    // What the driver says when pixels are read back is not the page's doing.
    if (/GPU stall due to ReadPixels/.test(message.text())) return;
    if (['error', 'warn'].includes(message.type())) faults.push(`console: ${message.text()}`);
  });
  page.on('pageerror', (error) => faults.push(`error: ${error.message}`));
  await page.goto(pathToFileURL(file).href, { waitUntil: 'load', timeout: 60_000 });
  return { page, faults };
}

/** Waits until the view has drawn what it was told last. */
export async function settled(page) {
  await page.evaluate(() => new Promise((done) => {
    requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 30)));
  }));
}

/** Pixels of a part of the page as it is shown: a function (x, y) to [red, green, blue]. */
export async function pixels(page, clip) {
  const picture = await page.screenshot({ clip, encoding: 'base64', captureBeyondViewport: false });
  const { width, data } = await page.evaluate(async (text) => {
    const image = new Image();
    image.src = `data:image/png;base64,${text}`;
    await image.decode();
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    return { width: image.width, data: [...context.getImageData(0, 0, image.width, image.height).data] };
  }, picture);
  return (x, y) => {
    const at = 4 * (Math.round(y) * width + Math.round(x));
    return data.slice(at, at + 3);
  };
}

/** The part of the page that an element takes. */
export async function placeOf(page, selector) {
  const handle = await page.$(selector);
  return handle.boundingBox();
}
