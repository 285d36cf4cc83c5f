// SPDX-License-Identifier: MIT
// A run is recorded on the page, downloaded from it, and played.
import assert from 'node:assert/strict';
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {afterEach, test} from 'node:test';
import {
  call, endAll, enterNumber, eventually, hasText, newFolder, nextPicture, openPage, startDaemon, startPlayer,
} from './harness.js';

const WEBGL = {webgl: true};

afterEach(endAll);

/** Records the classroom for at least this number of steps, and plays the recording. */
async function play(name, steps, ...flags) {
  const file = join(newFolder(), name);
  const live = await startDaemon('classroom', '--record', file, '--no-render');
  await eventually(async () => (await live.status()).step >= steps);
  await live.stop();
  return startPlayer(file, ...flags);
}

test('a run is recorded by a button, copied, and played', async () => {
  const live = await startDaemon('classroom', '--recordings', newFolder(), '--no-render');
  let page = await openPage(live.url);
  const places = () => page.locator('.toolbar > *').evaluateAll((items) =>
    items.map((item) => `${item.id} ${item.getBoundingClientRect().x} ${item.getBoundingClientRect().width}`));
  const before = await places();
  await page.click('#record');
  await hasText(page, '#recording', /^● rec run-\d{8}-\d{6}\.run$/);
  await hasText(page, '#record', /^Stop recording$/);
  await hasText(page, '#runs-title', /^Recordings \(1\)$/);
  assert.deepEqual(await places(), before);
  const list = async () => (await fetch(new URL('runs', live.url))).json();
  await eventually(async () => (await list())[0]?.steps > 20);
  await page.click('#record');
  await hasText(page, '#message', /^recorded run-/);
  await hasText(page, '#recording', /^$/);
  const [run] = await list();
  assert.equal(run.recording, false);
  const answer = await fetch(new URL(`runs/${run.name}`, live.url));
  assert.equal(answer.status, 200);
  const bytes = Buffer.from(await answer.arrayBuffer());
  await endAll();

  const copy = join(newFolder(), 'copy.run');
  await writeFile(copy, bytes);
  const player = await startPlayer(copy, '--loop');
  page = await openPage(player.url, WEBGL);
  await nextPicture(page);
  await hasText(page, '#state', /^playing$/);
  await hasText(page, '#playback', /^of copy\.run, \d+\.\d\d to \d+\.\d\d s, loop$/);
  assert.equal(await page.isDisabled('#record'), true);
  await page.click('#pause');
  await hasText(page, '#state', /^paused$/);
  for (const id of ['stop-all', 'set-mode', 'set-step', 'no-limit', 'seed', 'reload', 'load', 'scenarios', 'upload',
    'only-connected', 'all-participants', 'record']) {
    assert.equal(await page.isDisabled(`#${id}`), true, id);
    assert.match(await page.getAttribute(`#${id}`, 'title'), /recording/, id);
  }
  await page.click('#run');
  await hasText(page, '#state', /^playing$/);
  await enterNumber(page, '#set-speed', '-2');
  await hasText(page, '#playback', /× −2/);
  for (const wrong of ['65', '-5']) {
    await page.fill('#set-speed', wrong);
    await page.press('#set-speed', 'Enter');
    await hasText(page, '#message.error', /^speed: write a number from -4 to 64/);
    await page.locator('#set-speed').blur();
    await page.waitForFunction(() => document.getElementById('set-speed').value === '-2');
  }
});

/** Downloads the target of the list's link that ends with `extension`. */
async function download(page, extension) {
  const [{suggestedFilename, path}] = await Promise.all([
    page.waitForEvent('download').then((event) => ({suggestedFilename: event.suggestedFilename(), path: event.path()})),
    page.click(`#runs-list a[href$="${extension}"]`)]);
  return {name: suggestedFilename, bytes: await readFile(await path)};
}

test('recordings are listed, and copied by their links', async () => {
  const recordings = newFolder();
  const daemon = await startDaemon('classroom', '--recordings', recordings);
  const page = await openPage(daemon.url, WEBGL);
  await page.click('#tab-runs');
  await hasText(page, '#runs-list', /^none yet/);

  assert.equal((await call(daemon.url, {module: '/recorder', command: 'start', text: 'lesson1'})).error, 0);
  await hasText(page, '#runs-title', /^Recordings \(1\)$/);
  await hasText(page, '#runs-list', /^lesson1\.run.*being recorded$/);
  assert.equal(await page.locator('#runs-list a').count(), 0);

  await eventually(async () => (await (await fetch(new URL('runs', daemon.url))).json())[0].steps > 20);
  assert.equal((await call(daemon.url, {module: '/recorder', command: 'stop'})).error, 0);
  await hasText(page, '#runs-list', /^lesson1\.run\d+\.\d sPlay Ghost \.run \.mat$/);
  const run = await download(page, '.run');
  assert.equal(run.name, 'lesson1.run');
  assert.match(run.bytes.subarray(0, 15).toString(), /^SQLite format 3$/);
  const mat = await download(page, '.mat');
  assert.equal(mat.name, 'lesson1.mat');
  assert.match(mat.bytes.subarray(0, 19).toString(), /^MATLAB 5\.0 MAT-file$/);

  await writeFile(join(recordings, 'torn.run'), 'no recording');
  await page.click('#tab-robots');
  await page.click('#tab-runs');
  await hasText(page, '#runs-title', /^Recordings \(2\)$/);
  await hasText(page, '#runs-list', /torn\.runcannot be read/);
});

test('in a playback the steps go back too', async () => {
  const player = await play('steps.run', 50, '--paused');
  const step = async () => (await player.status()).step;
  const page = await openPage(player.url);
  await hasText(page, '#state', /^paused$/);
  const stepBy = async (count, button = '#step') => {
    await page.fill('#step-count', String(count));
    await page.click(button);
  };
  await stepBy(30);
  await eventually(async () => (await step()) === 30);
  await stepBy(-20);
  await eventually(async () => (await step()) === 10);
  await stepBy(4, '#step-back');
  await eventually(async () => (await step()) === 6);
});

test('in a playback the buttons are in one line', async () => {
  const player = await play('line.run', 0, '--paused');
  const page = await openPage(player.url);
  await page.waitForSelector('#step-back', {state: 'visible'});
  const top = async (id) => (await page.locator(id).boundingBox()).y;
  assert.equal(await top('#record'), await top('#run'));
});

test('a branch by somebody else ends what was said of the recording', async () => {
  const player = await play('branched.run', 20, '--loop');
  const page = await openPage(player.url);
  await hasText(page, '#state', /^playing$/);
  assert.equal((await call(player.url, {module: '/playback', command: 'branch'})).error, 0);
  await hasText(page, '#message:not(.error)', /^branched\.run is no longer played: the run is live$/);
  await hasText(page, '#state', /^running$/);
  await hasText(page, '#playback', /^$/);
  assert.equal(await page.isDisabled('#stop-all'), false);
});
