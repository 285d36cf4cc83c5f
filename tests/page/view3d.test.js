// SPDX-License-Identifier: MIT
// The view drawn by the page itself: objects, motion, clicks, and its substitute without WebGL.
import assert from 'node:assert/strict';
import {before, beforeEach, test} from 'node:test';
import {eventually, loadAnew, openPage, openScenario, order} from './harness.js';

const SCENARIO = `[SIMULATION]
mode realtime
[FLOOR]
size 10 10 0.1
[BOX_1]
type box
size 1 1 1
position 2 1
color red
mass 5
[TARGET]
green -2 0 0.3
[ROBOT_1]
type coopbot
position -1 0
[ROBOT_2]
type humanoid
position 0 -3
`;

let daemon, page;

before(async () => { ({daemon, page} = await openScenario(SCENARIO, {webgl: true})); });
beforeEach(async () => {
  await loadAnew(daemon, page, SCENARIO);
  await order(daemon.url, '/simulation', 'run');
});

/** The position of a thing in the view: x, y, z. */
const placeOf = (name) => page.evaluate((which) => {
  const {scene} = window.coopdyn.view;
  return scene.pose(scene.find(which))[0].toArray();
}, name);
const near = (a, b, far = 0.002) => a.every((x, i) => Math.abs(x - b[i]) < far);

test('things, robots and targets stand where the daemon has them', async () => {
  await eventually(async () => near(await placeOf('BOX_1'), [2, 1, 0.5]));
  await eventually(async () => near(await placeOf('green_target_1'), [-2, 0, 0.3]));
  await eventually(async () => near(await placeOf('robot1'), [-1, 0, 0], 0.01));
});

test('a robot that drives moves in the view', async () => {
  const from = (await placeOf('robot1'))[0];
  await order(daemon.url, '/robot1/motors', 'set_velocity 0.4 0');
  await eventually(async () => (await placeOf('robot1'))[0] > from + 0.2);
});

test('a robot that has stopped is shown where it stands', async () => {
  await order(daemon.url, '/robot1/motors', 'set_velocity 0.4 0');
  const pose = async () => (await order(daemon.url, '/robot1/pose', 'get_pose')).data;
  await eventually(async () => (await pose())[3] > 0.3);
  await order(daemon.url, '/simulation', 'pause');
  const [x, y] = await pose();
  await eventually(async () => near((await placeOf('robot1')).slice(0, 2), [x, y], 0.001));
});

test('what others insert, move and remove is seen', async () => {
  const edit = (line) => order(daemon.url, '/world', line);
  await edit('insert [CRATE_1] type box | size 0.4 0.4 0.4 | position 3 3');
  await page.waitForFunction(() => window.coopdyn.view.scene.find('CRATE_1'));
  await edit('set_pose CRATE_1 -3 3 0.2 0');
  await eventually(async () => near(await placeOf('CRATE_1'), [-3, 3, 0.2]));
  await edit('remove CRATE_1');
  await page.waitForFunction(() => !window.coopdyn.view.scene.find('CRATE_1'));
});

test('a click selects what is there', async () => {
  await page.click('button:has-text("top")');
  const at = await page.evaluate(() => {
    const {view} = window.coopdyn;
    view.renderNow();
    const p = view.scene.pose(view.scene.find('BOX_1'))[0].project(view.camera);
    const box = view.canvas.getBoundingClientRect();
    return [box.left + (p.x + 1) / 2 * box.width, box.top + (1 - p.y) / 2 * box.height];
  });
  await page.mouse.click(...at);
  await page.waitForFunction(() => window.coopdyn.view.selected?.name === 'BOX_1');
});

test('meshes come, and nothing is asked of other hosts', async () => {
  const hosts = new Set();
  page.on('request', (request) => { if (!request.url().startsWith('data:')) hosts.add(new URL(request.url()).host); });
  await page.reload();
  await page.waitForFunction(() => window.coopdyn?.view.framesDrawn > 1);
  assert.deepEqual([...hosts], [new URL(daemon.url).host]);
  assert.deepEqual(page.mistakes, []);
});

test('without WebGL the daemon draws', async () => {
  const other = await openPage(daemon.url);
  await other.waitForFunction(() => Number(document.getElementById('view').dataset.shown ?? 0) > 0);
  assert.equal(await other.evaluate(() => Boolean(window.coopdyn.view.scene)), false);
});
