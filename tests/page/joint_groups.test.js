// SPDX-License-Identifier: MIT
// Robots with several groups of joints on the page, and joints in a playback.
import assert from 'node:assert/strict';
import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {afterEach, test} from 'node:test';
import {call, endAll, eventually, newFolder, openPage, startDaemon, startPlayer} from './harness.js';

const scenario = (mode, type) =>
  `[SIMULATION]\nmode ${mode}\n[FLOOR]\nsize 6 6 0.1\n[ROBOT_1]\ntype ${type}\nname robot1\nposition 0 0\n`;

afterEach(endAll);

const write = (name, text) => {
  const file = join(newFolder(), name);
  writeFileSync(file, text);
  return file;
};

const group = (name) => `.card[open] .joints[data-group="${name}"]`;

test('each group of joints has a panel, and a slider moves the joint of its own group only', async () => {
  const daemon = await startDaemon(write('human.scenario', scenario('realtime', 'humanoid')), '--no-render');
  const page = await openPage(daemon.url);
  await page.waitForSelector(`${group('neck')} tr`);
  const groups = await page.locator('.card[open] .joints').evaluateAll((all) => all.map(({dataset}) => dataset.group));
  assert.deepEqual(groups.sort(), ['left_arm', 'left_leg', 'neck', 'right_arm', 'right_leg', 'waist']);
  await page.waitForFunction(() => document.querySelectorAll('.card[open] .joints tr').length === 25);
  await page.evaluate((where) => {
    const slider = document.querySelector(`${where} input`);
    slider.value = 0.3;
    slider.dispatchEvent(new Event('input'));
  }, group('neck'));
  const targets = async (module) => (await call(daemon.url, {module: `/robot1/${module}`, command: 'get_motion'})).data.slice(0, -2);
  await eventually(async () => (await targets('neck'))[0] === 0.3);
  assert.ok((await targets('left_arm')).every((target) => target !== 0.3));
  await page.waitForFunction((where) => /→ 0\.300$/.test(document.querySelector(`${where} .number`).textContent), group('neck'));
  await page.waitForFunction((where) => /^position, velocity .*, effort −?\d/.test(document.querySelector(`${where} .number`).title),
    group('neck'));
});

test('in a recording that is played joints show where they were, and cannot be moved', async () => {
  const run = join(newFolder(), 'arm.run');
  const daemon = await startDaemon(write('arm.scenario', scenario('realtime', 'lwa')), '--record', run, '--no-render');
  const moved = await call(daemon.url, {module: '/robot1/arm', line: 'set_positions (2) 0.5'});
  assert.equal(moved.error, 0);
  // Not get_motion, which may answer before a step has processed the command; the page shows the three digits 0.500.
  await eventually(async () => {
    const {data} = await call(daemon.url, {module: '/robot1/arm', line: 'get_joints (2)'});
    return Math.abs(data[0] - 0.5) < 0.0004;
  });
  await daemon.stop();
  const player = await startPlayer(run, '--paused');
  const page = await openPage(player.url);
  const {begin_s: begin, end_s: end} = (await player.status()).playback;
  assert.ok(end > begin);
  const shown = () => page.evaluate((where) => document.querySelectorAll(`${where} .number`)[1]?.textContent, group('arm'));
  const seek = async (time) => assert.equal((await call(player.url, {module: '/playback', command: 'seek', data: [time]})).error, 0);
  await page.waitForSelector(`${group('arm')} tr`);
  await seek(begin);
  await eventually(async () => (await shown())?.startsWith('0.000'));
  await seek(end);
  await eventually(async () => (await shown()) === '0.500 → 0.500');
  assert.ok(await page.locator(`${group('arm')} input, ${group('arm')} button`).evaluateAll((all) => all.every(({disabled}) => disabled)));
  assert.equal((await call(player.url, {module: '/playback', command: 'branch'})).error, 0);
  await page.waitForFunction((where) => document.querySelector(`${where} input`)?.disabled === false, group('arm'));
});
