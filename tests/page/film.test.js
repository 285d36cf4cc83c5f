// SPDX-License-Identifier: MIT
// Pictures and films of the view, and the line of the real-time factor.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {before, test} from 'node:test';
import {call, hasText, openClassroom} from './harness.js';

const WEBGL = {webgl: true};
let daemon, page;

before(async () => {
  ({daemon, page} = await openClassroom(WEBGL));
  await page.evaluate(() => {
    const {start} = MediaRecorder.prototype;
    MediaRecorder.prototype.start = function startCounted(...words) {
      globalThis.filmed = 0;
      this.addEventListener('dataavailable', ({data}) => { globalThis.filmed += data.size; });
      start.apply(this, words);
    };
  });
  await page.waitForFunction(() => window.coopdyn?.film && Number(document.getElementById('view').dataset.shown ?? 0) > 1);
});

async function download(act) {
  const [file] = await Promise.all([page.waitForEvent('download'), act()]);
  return {name: file.suggestedFilename(), bytes: await readFile(await file.path())};
}

/** Waits until the browser has recorded this number of bytes of the running film. */
const filmed = (bytes) => page.waitForFunction((wanted) => globalThis.filmed > wanted, bytes);

test('a picture is a PNG of the view', async () => {
  const viewSize = () => page.evaluate(() => { const {width, height} = document.getElementById('view'); return {width, height}; });
  // A slow view is drawn with fewer pixels after a while.
  let before, after, name, bytes;
  do {
    before = await viewSize();
    ({name, bytes} = await download(() => page.click('#tool-picture')));
    after = await viewSize();
  } while (after.width !== before.width);
  const {width, height} = after;
  assert.match(name, /^classroom-\d+\.\d\ds\.png$/);
  const size = await page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(new Blob([new Uint8Array(data)], {type: 'image/png'}));
    const sheet = new OffscreenCanvas(bitmap.width, bitmap.height), draw = sheet.getContext('2d');
    draw.drawImage(bitmap, 0, 0);
    const {data: pixels} = draw.getImageData(0, 0, bitmap.width, bitmap.height);
    const colours = new Set();
    for (let i = 0; i < pixels.length; i += 4) colours.add((pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2]);
    return [bitmap.width, bitmap.height, colours.size];
  }, [...bytes]);
  assert.deepEqual(size.slice(0, 2), [width - width % 2, height - height % 2]);
  assert.ok(size[2] > 50, `${size[2]} colours`);
});

test('a film is a WebM, and the button says that it runs and for how long at most', async () => {
  await page.click('#tool-film');
  await filmed(2000);
  await hasText(page, '#tool-film', /^● (?!0:00)\d:\d\d of 2:00$/);
  const {name, bytes} = await download(() => page.click('#tool-film'));
  assert.match(name, /^classroom-\d+\.\d\ds\.webm$/);
  assert.deepEqual([...bytes.subarray(0, 4)], [0x1a, 0x45, 0xdf, 0xa3]);
  assert.ok(bytes.length > 2000, `${bytes.length} bytes`);
  await hasText(page, '#tool-film', /^film$/);
});

test('a film ends by itself at its limit', async () => {
  await page.click('#tool-film');
  await filmed(1000);
  const {bytes} = await download(() => page.evaluate(() => { window.coopdyn.film.limit_s = 1; }));
  assert.ok(bytes.length > 1000);
});

test('a browser that cannot film says so', async () => {
  await page.evaluate(() => {
    globalThis.kept = MediaRecorder;
    globalThis.MediaRecorder = undefined;
    document.getElementById('tool-film').click();
    globalThis.MediaRecorder = globalThis.kept;
  });
  await hasText(page, '#message.error', /^this browser cannot make films: /);
});

test('the line of the real-time factor follows it, tells the hash, and opens the plots', async () => {
  await page.waitForFunction(() => document.querySelector('#rtf-history polyline').getAttribute('points').split(' ').length > 5);
  await call(daemon.url, {module: '/simulation', line: 'pause'});
  // The bottom of the picture: it does not move.
  await page.waitForFunction(() => document.querySelector('#rtf-history polyline').getAttribute('points').endsWith(',20.0'));
  const {step, hash} = await daemon.status();
  assert.ok((await page.getAttribute('#rtf-history', 'title')).includes(`after step ${step}: ${hash}`));
  await page.click('#rtf-history');
  assert.equal(await page.getAttribute('#tab-plots', 'aria-selected'), 'true');
});
