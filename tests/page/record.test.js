// SPDX-License-Identifier: MIT
// A run is recorded from the page, copied from it, and played.
import assert from 'node:assert/strict';
import {mkdtemp, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {eventually, launchBrowser, nextPicture, openPage, startDaemon, startPlayer} from './harness.js';

let browser;
let folder;

before(async () => {
  browser = await launchBrowser();
  folder = await mkdtemp(join(tmpdir(), 'coopdyn-page-'));
});
after(async () => {
  await browser?.close();
  await rm(folder, {recursive: true, force: true});
});

const hasText = (page, selector, pattern) => page.waitForFunction(
  ([where, source]) => new RegExp(source).test(document.querySelector(where)?.textContent ?? ''),
  [selector, pattern.source]);

test('a run is recorded by a button, copied, and played', async () => {
  const copy = join(folder, 'copy.run');
  const live = await startDaemon('classroom', '--recordings', folder);
  try {
    const page = await openPage(browser, live.url);
    await page.click('#record');
    await hasText(page, '#recording', /^● rec run-\d{8}-\d{6}\.run$/);
    await hasText(page, '#record', /^Stop recording$/);
    const list = async () => (await fetch(new URL('runs', live.url))).json();
    await eventually(async () => (await list())[0]?.steps > 20);
    await page.click('#record');
    await hasText(page, '#recording', /^$/);
    await hasText(page, '#message', /^recorded run-/);
    const [run] = await list();
    assert.equal(run.recording, false);
    const answer = await fetch(new URL(`runs/${run.name}`, live.url));
    assert.equal(answer.status, 200);
    await writeFile(copy, Buffer.from(await answer.arrayBuffer()));
    assert.deepEqual(page.mistakes, []);
    await page.close();
  } finally {
    await live.stop();
  }

  const player = await startPlayer(copy, '--loop');
  try {
    const page = await openPage(browser, player.url);
    await nextPicture(page);
    await hasText(page, '#state', /^playing$/);
    await hasText(page, '#playback', /^of copy\.run, \d+\.\d\d to \d+\.\d\d s, loop$/);
    assert.equal(await page.isDisabled('#record'), true);
    await page.click('#pause');
    await hasText(page, '#state', /^paused$/);
    await page.click('#stop-all');
    await hasText(page, '#message', /playing a recording/);
    await page.click('#run');
    await hasText(page, '#state', /^playing$/);
    assert.deepEqual(page.mistakes, []);
    await page.close();
  } finally {
    await player.stop();
  }
});
