// SPDX-License-Identifier: MIT
// Makes README's picture of the page, which plays a recording: node tests/page/readme_picture.js RECORDING FILE.webp. See docs/film.sh.
import {writeFileSync} from 'node:fs';
import {closeBrowser, endAll, startBrowser, startPlayer} from './harness.js';

const [recording, file] = process.argv.slice(2);
const QUALITY = 0.72, AT_S = 17;
const daemon = await startPlayer(recording, '--no-render', '--speed', '2');
const page = await (await startBrowser()).newPage({viewport: {width: 1280, height: 720}});
await page.goto(daemon.url);
await page.waitForFunction(() => window.coopdyn?.view.framesDrawn > 1 && window.coopdyn.marks);
await page.evaluate(() => document.getElementById('rays').click());
await page.click('#show > summary');
await page.check('#show-trails');
await page.click('#show > summary');
await page.waitForFunction((enough) => parseFloat(document.getElementById('time').textContent) >= enough, AT_S);
await page.evaluate(() => window.coopdyn.connection.call({module: '/simulation', line: 'pause'}));
await page.waitForTimeout(3000);
const png = (await page.screenshot()).toString('base64');
const webp = await (await page.context().browser().newContext()).newPage().then((blank) => blank.evaluate(async ([source, how]) => {
  const image = new Image();
  image.src = `data:image/png;base64,${source}`;
  await image.decode();
  const canvas = Object.assign(document.createElement('canvas'), {width: image.width, height: image.height});
  canvas.getContext('2d').drawImage(image, 0, 0);
  return canvas.toDataURL('image/webp', how).split(',')[1];
}, [png, QUALITY]));
writeFileSync(file, Buffer.from(webp, 'base64'));
await page.close();
await endAll();
await closeBrowser();
