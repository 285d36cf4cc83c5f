// SPDX-License-Identifier: MIT
// The joints of an arm on the page: their data, and moving them by sliders.
import assert from 'node:assert/strict';
import {afterEach, beforeEach, test} from 'node:test';
import {call, endAll, eventually, openScenario, order} from './harness.js';

const SCENARIO = '[SIMULATION]\nmode realtime\n[FLOOR]\nsize 6 6 0.1\n[ROBOT_1]\ntype lwa\nname arm1\nposition 0 0\n';

let daemon;
let page;


beforeEach(async () => {
  ({daemon, page} = await openScenario(SCENARIO));
  await page.waitForSelector('.card[open] .joints tr');
});

afterEach(endAll);

const joint = async (id) => (await call(daemon.url, {module: '/arm1/arm', command: 'get_joints', params: [id]})).data[0];

/** Moves the slider of a joint as by hand. */
const slide = (index, value) => page.evaluate(([at, to]) => {
  const slider = document.querySelectorAll('.card[open] .joints input')[at];
  slider.value = to;
  slider.dispatchEvent(new Event('input'));
}, [index, value]);

test('an arm shows its joints with their limits, positions and targets', async () => {
  const rows = await page.locator('.card[open] .joints tr').allTextContents();
  assert.equal(rows.length, 7);
  assert.match(rows[1], /^joint_2/);
  const slider = page.locator('.card[open] .joints input').nth(1);
  assert.ok(Number(await slider.getAttribute('max')) > 1.9);
  await page.waitForFunction(() => /→ −?\d/.test(document.querySelector('.card[open] .joints .number').textContent));
});

test('the ports, which come later, leave the joints as they are', async () => {
  let ports;
  const held = new Promise((resolve) => { ports = resolve; });
  await page.route('**/api/modules', async (route) => {
    await held;
    await route.continue();
  });
  await page.reload();
  await page.waitForSelector('.card[open] .joints tr');
  await page.evaluate(() => { document.querySelector('.card[open] .joints tr').dataset.seen = 'yes'; });
  ports();
  await page.click('.card[open] .connect > summary');
  await page.waitForSelector('.card[open] .lines dt:has-text("MATLAB")');
  assert.equal(await page.locator('.card[open] .joints tr').first().getAttribute('data-seen'), 'yes');
});

test('a slider moves its joint, and the page drives the robot until it lets go', async () => {
  await slide(1, 0.4);
  await eventually(async () => Math.abs(await joint(2) - 0.4) < 0.001);
  assert.ok(Math.abs(await joint(1)) < 0.001);
  await page.waitForFunction(() => document.querySelectorAll('.card[open] .joints .number')[1].textContent === '0.400 → 0.400');
  assert.ok((await daemon.status()).robots[0].owner);
  await page.click('.card[open] .joints button:has-text("Let go")');
  await eventually(async () => !(await daemon.status()).robots[0].owner);
});

test('hold stops a move', async () => {
  await order(daemon.url, '/simulation', 'set_speed 0.1');  // so that it still moves when the button is pressed
  await slide(0, 3);
  await eventually(async () => await joint(1) > 0.05);
  await page.click('.card[open] .joints button:has-text("Hold")');
  await page.waitForFunction(() => {
    const [here, there] = document.querySelector('.card[open] .joints .number').textContent.split(' → ').map(Number);
    return there < 2.9 && Math.abs(here - there) < 0.01;
  });
});
