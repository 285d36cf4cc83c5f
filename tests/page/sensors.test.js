// SPDX-License-Identifier: MIT
// A robot's sensors on the page: the picture of its camera and the scan of its lidar.
import assert from 'node:assert/strict';
import {afterEach, beforeEach, test} from 'node:test';
import {call, endAll, eventually, hasText, openPage, openScenario} from './harness.js';

const WALLS = [[1.05, 0, 0.1, 2], [-1.05, 0, 0.1, 2], [0, 1.05, 2, 0.1], [0, -1.05, 2, 0.1]]
  .map(([x, y, length, width], i) => `[WALL_${i + 1}]\ntype box\nsize ${length} ${width} 0.5\nposition ${x} ${y}\n`).join('');
const SCENARIO = `[SIMULATION]\nmode realtime\n[FLOOR]\nsize 6 6\n${WALLS}[POST_1]\ntype cylinder\nsize 0.1 0.1 0.4\n` +
  'position 0.75 0.2\ncolor red\n[ROBOT_1]\ntype turtle\nname robot1\nposition 0 0\n';
const TILE = '.card[open] [data-camera="camera"]';
const SCAN = '.card[open] [data-module="/robot1/lidar"]';

let daemon, page;

beforeEach(async () => {
  ({daemon, page} = await openScenario(SCENARIO, {pictures: true}));
  await page.waitForSelector(TILE);
});

afterEach(endAll);

/** The content of an image or a canvas: its width, the mean column of its red pixels (null without any), whether all of it is grey,
 *  and the opacity of each pixel of a canvas. */
const shown = (selector) => page.evaluate((where) => {
  const element = document.querySelector(where);
  const width = element.naturalWidth ?? element.width, height = element.naturalHeight ?? element.height;
  if (!width) return {width};
  const copy = new OffscreenCanvas(width, height).getContext('2d', {willReadFrequently: true});
  copy.drawImage(element, 0, 0);
  const {data} = copy.getImageData(0, 0, width, height);
  let columns = 0, count = 0, grey = true;
  for (let i = 0; i < data.length; i += 4) {
    const [r, g, b] = [data[i], data[i + 1], data[i + 2]];
    grey &&= Math.abs(r - g) <= 6 && Math.abs(g - b) <= 6;
    if (r > 90 && r > 2 * g && r > 2 * b) {
      columns += (i / 4) % width;
      ++count;
    }
  }
  return {width, height, red: count > 0 ? columns / count : null, grey, painted: element.getContext ? [...data.filter((_, i) => i % 4 === 3)] : []};
}, selector);

/** Polls the content of the camera's tile until the condition holds. */
async function untilTile(condition) {
  let seen;
  await eventually(async () => {
    seen = await shown(`${TILE} img`);
    return seen.width > 0 && condition(seen);
  });
  return seen;
}

test('a camera of a daemon without pictures says so', async () => {
  const {page: blind} = await openScenario(SCENARIO);
  await blind.waitForSelector(TILE);
  assert.match(await blind.textContent(TILE), /--no-render/);
  assert.equal(await blind.locator(`${TILE} img`).count(), 0);
});

test('the picture of a camera is shown, and moves as the robot turns', async () => {
  const first = await untilTile(({red}) => red !== null);
  assert.deepEqual([first.width, first.height], [320, 240]);
  assert.ok(first.red < 160, 'the post is on the left');
  const reply = await call(daemon.url, {module: '/robot1/motors', command: 'set_velocity', data: [0, 0.1]});
  assert.equal(reply.error, 0, reply.text);
  await untilTile(({red}) => red > first.red + 40);
});

test('depth and segments can be chosen', async () => {
  await untilTile(({grey}) => !grey);
  await page.selectOption(`${TILE} select`, 'depth');
  await untilTile(({grey}) => grey);
  await page.selectOption(`${TILE} select`, 'segmentation');
  await untilTile(({grey}) => !grey);
});

test('the view shows the picture of a camera in its corner', async () => {
  const other = await openPage(daemon.url, {webgl: true});
  await other.waitForFunction(() => window.coopdyn?.marks && window.coopdyn.view.scene);
  await other.click('#show > summary');
  await other.check('#show-camera');
  await other.waitForFunction(() => document.querySelector('#corner-camera img')?.naturalWidth === 320);
  assert.equal(await other.textContent('#corner-camera p'), 'robot1');
  await other.uncheck('#show-camera');
  assert.equal(await other.locator('#corner-camera img').count(), 0, 'a hidden picture is not asked for');
  await other.close();
});

test('the scan of a lidar is drawn, with the distance of the nearest thing', async () => {
  await hasText(page, `${SCAN} figcaption`, /^lidar: nearest 0\.\d\d m, rim [\d.]+ m$/);
  // The walls lie 2 m apart: a square about the middle, whose sides are points to the left, right, ahead and behind.
  const {width: side, painted} = await shown(`${SCAN} canvas`);
  const rim = Number(/rim ([\d.]+)/.exec(await page.textContent(`${SCAN} figcaption`))[1]);
  const away = (side / 2 - 4) / rim;  // of 1 m, in pixels
  const near = (x, y) => {
    let count = 0;
    for (let dy = -5; dy <= 5; ++dy) {
      for (let dx = -5; dx <= 5; ++dx) count += painted[Math.round(y + dy) * side + Math.round(x + dx)] > 128 ? 1 : 0;
    }
    return count;
  };
  const middle = side / 2;
  for (const [x, y] of [[-1, 0.3], [1, 0.3], [0.3, 1], [-0.3, -1]]) {
    assert.ok(near(middle + x * away, middle + y * away) > 8, `a wall at ${x}, ${y}`);
  }
  assert.equal(near(middle - 0.6 * away, middle + 0.5 * away), 0, 'the room is free');
});
