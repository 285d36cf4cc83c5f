// SPDX-License-Identifier: MIT
// The task of a scenario: text, hints that open one after another, and scores.
import assert from 'node:assert/strict';
import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {eventually, newFolder, openPage, order as orderAt, startDaemon} from './harness.js';

const ROBOT = '[ROBOT_1]\ntype coopbot\nposition 0 0\n';
const TASK = `[TASK]
title Reach the target
text Drive to the **red** target with \`set_velocity\`.
text - slowly
text - <img src=x onerror=alert(1)>
text See [the guide](https://example.org/guide) or [this](javascript:alert(1)).
hint Look first.
hint Then turn.
counts 2 points: *arrived*
${ROBOT}`;
let folder, daemon, page;
const shown = (selector) => page.$$eval(selector, (all) => all.map((one) => one.textContent));
const order = (line) => orderAt(daemon.url, '/simulation', line);

before(async () => {
  folder = newFolder();
  writeFileSync(join(folder, 'task.scenario'), TASK);
  writeFileSync(join(folder, 'uncounted.scenario'), `[TASK]\ntitle Look around\ntext Look.\n${ROBOT}`);
  writeFileSync(join(folder, 'plain.scenario'), ROBOT);
  daemon = await startDaemon(join(folder, 'task.scenario'), '--scenarios', folder, '--no-render');
  page = await openPage(daemon.url, {flat: true});
  await eventually(() => page.isVisible('#task-box'));
});

test('the text is shown as Markdown, and markup in it as text', async () => {
  assert.equal(await page.textContent('#task-title'), 'Reach the target');
  assert.deepEqual(await shown('#task-text strong'), ['red']);
  assert.deepEqual(await shown('#task-text code'), ['set_velocity']);
  assert.deepEqual(await shown('#task-text li'), ['slowly', '<img src=x onerror=alert(1)>']);
  assert.deepEqual(await page.$$eval('#task-text a', (all) => all.map(({href}) => href)), ['https://example.org/guide']);
  assert.deepEqual(await shown('#task-counts em'), ['arrived']);
});

test('the task comes first, before scenario and time', async () => {
  assert.equal(await page.$eval('#panel-robots', (panel) => panel.firstElementChild.id), 'task-box');
});

test('what counts has a heading, which is not shown where nothing is said to count', async () => {
  assert.equal(await page.textContent('#task-worth h3'), 'What counts');
  assert.ok(await page.isVisible('#task-worth h3'));
  await order('load_scenario uncounted');
  await eventually(async () => await page.textContent('#task-title') === 'Look around');
  assert.ok(await page.isHidden('#task-worth'));
  await order('load_scenario task');
  await eventually(() => page.isVisible('#task-worth'));
});

test('a hint appears when the one before it has been opened', async () => {
  assert.deepEqual(await page.$$eval('#task-hints details', (all) => all.map(({hidden}) => hidden)), [false, true]);
  await page.click('#task-hints summary');
  await eventually(() => page.isVisible('#task-hints details:nth-child(2)'));
});

test('a scenario without a task shows none', async () => {
  await order('load_scenario plain');
  await eventually(() => page.isHidden('#task-box'));
  await order('load_scenario task');
  await eventually(() => page.isVisible('#task-box'));
});
