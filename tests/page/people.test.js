// SPDX-License-Identifier: MIT
// Several people at one daemon see each other.
import assert from 'node:assert/strict';
import {before, test} from 'node:test';
import {eventually, openClassroom, openPage} from './harness.js';

const WEBGL = {webgl: true};
let daemon, page, other;

before(async () => {
  ({daemon, page} = await openClassroom());
});

const chips = (of) => of.locator('.person').count();

test('who is alone sees nobody', async () => assert.equal(await chips(page), 0));

test('two see each other', async () => {
  other = await openPage(daemon.url, WEBGL);
  await other.waitForFunction(() => window.coopdyn?.view.scene);
  for (const each of [page, other]) await eventually(async () => await chips(each) === 2);
});

test('a name that one gives oneself is seen by the other, as text', async () => {
  await other.click('button.person');
  await other.fill('#own-name', '<b>Ana Lopez');
  await other.press('#own-name', 'Enter');
  await page.waitForSelector('.person[title="<b>Ana Lopez"]');
  await eventually(async () => await page.textContent('.person[title="<b>Ana Lopez"]') === '<L');
});

test('what the other has selected is told', async () => {
  await other.click('#tab-world');
  await other.click('#things button:has-text("BOX_1")');
  await page.waitForSelector('.person[title="<b>Ana Lopez, selected BOX_1"]');
});

test('who leaves is not there any more', async () => {
  assert.deepEqual(other.mistakes, []);
  await other.close();
  await eventually(async () => await chips(page) === 0);
});
