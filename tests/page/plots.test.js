// SPDX-License-Identifier: MIT
// Values against simulated time: live, from a recording, as CSV and PNG.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {call, eventually, hasText, newFolder, openPage, order as orderAt, startDaemon} from './harness.js';

let folder, daemon, page;

const order = (module, line) => orderAt(daemon.url, module, line);
const choose = (name) => page.locator('#plot-values label', {hasText: new RegExp(`^ ?${name}$`)}).first().locator('input').check();
const points = () => page.evaluate(() => {
  const {plots} = window.coopdyn;
  return {times: plots.points?.times ?? [], columns: plots.points?.columns ?? [], values: plots.values};
});

before(async () => {
  folder = newFolder();
  daemon = await startDaemon('classroom', '--recordings', folder, '--no-render');
  page = await openPage(daemon.url);
  await page.click('#tab-plots');
  await page.waitForSelector('#plot-values input');
});

test('values of one unit share a plot, others have their own', async () => {
  await choose('x');
  await choose('y');
  await eventually(async () => await page.locator('#plot-charts .uplot').count() === 1);
  await choose('heading');
  await eventually(async () => await page.locator('#plot-charts .uplot').count() === 2);
});

test('each point is the reading at its simulated time', async () => {
  await page.evaluate(() => window.coopdyn.connection.call({module: '/robot1/motors', line: 'set_velocity 0.3 0.4'}));
  await eventually(async () => (await points()).times.length > 20);
  await order('/simulation', 'pause');
  const {time_s: time} = await daemon.status();
  await eventually(async () => (await points()).times.at(-1) === time);
  const pose = await call(daemon.url, {module: '/robot1/pose', line: 'get_pose'});
  const {times, columns, values} = await points();
  const of = (name) => columns[values.findIndex((value) => value.module === 'pose' && value.name === name)];
  assert.deepEqual([of('x').at(-1), of('y').at(-1), of('heading').at(-1)], pose.data.slice(0, 3));
  assert.ok(times.every((t, i) => i === 0 || t > times[i - 1]), 'times grow');
  await order('/simulation', 'run');
});

test('a reset begins the curves anew', async () => {
  await order('/simulation', 'pause');
  await order('/simulation', 'reset');
  await eventually(async () => JSON.stringify((await points()).times) === '[0]');
  await order('/simulation', 'run');
  await eventually(async () => (await points()).times.length > 5);
});

test('the strip tells real-time factor and hash', async () => {
  await hasText(page, '#plot-hash', /^real-time factor \d.* · step \d+ · hash [0-9a-f]{16}$/);
});

async function download(selector) {
  const [file] = await Promise.all([page.waitForEvent('download'), page.click(selector)]);
  return readFile(await file.path());
}

test('CSV has the chosen curves', async () => {
  const [head, ...rows] = (await download('#plot-csv')).toString().trim().split('\n');
  assert.equal(head, 'time_s,robot1/pose x [m],robot1/pose y [m],robot1/pose heading [rad]');
  assert.ok(rows.every((row) => row.split(',').length === 4));
});

test('PNG is a picture of all plots', async () => {
  const picture = await download('#plot-png');
  assert.equal(picture.subarray(1, 4).toString(), 'PNG');
  assert.ok(picture.readUInt32BE(20) > 300, 'two plots high');
});

test('a drag zooms, a double click shows all again', async () => {
  await order('/simulation', 'pause');  // then nothing moves below the mouse
  const over = page.locator('#plot-charts .u-over').first();
  const span = () => page.evaluate(() => { const {min, max} = window.coopdyn.plots.charts[0].scales.x; return max - min; });
  const whole = await span();
  await over.hover();
  const {x, y, width, height} = await over.boundingBox();
  await page.mouse.move(x + 0.3 * width, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + 0.6 * width, y + height / 2, {steps: 4});
  await page.mouse.up();
  await eventually(async () => await span() < 0.6 * whole);
  await over.dblclick();
  await eventually(async () => await span() > 0.9 * whole);
  await order('/simulation', 'run');
});

test('of a recording the whole curve is there, as in its export', async () => {
  await order('/simulation', 'reset');
  await order('/recorder', 'start plotted');
  await page.evaluate(() => window.coopdyn.connection.call({module: '/robot1/motors', line: 'set_velocity 0.3 -0.4'}));
  await eventually(async () => (await daemon.status()).step > 150);
  await order('/recorder', 'stop');
  await order('/playback', 'open plotted');
  await order('/playback', 'pause');
  await eventually(async () => (await points()).values.some(({key}) => key === 'robot1.x_m'));
  const csv = join(folder, 'plotted.csv');
  execFileSync(process.env.COOPDYN_BINARY, ['export', join(folder, 'plotted.run'), '--out', csv]);
  const [head, ...rows] = readFileSync(csv, 'utf8').trim().split('\n').map((line) => line.split(','));
  const {times, columns, values} = await points();
  const x = columns[values.findIndex(({key}) => key === 'robot1.x_m')], at = head.indexOf('robot1.x_m');
  assert.ok(times.length > 140, String(times.length));
  const time = head.indexOf('time_s');
  assert.ok(time >= 0, head.slice(0, 4).join());
  const byTime = new Map(rows.map((row) => [Number(row[time]), Number(row[at])]));
  times.forEach((t, i) => assert.equal(x[i], byTime.get(t), `at ${t}`));
});

test('a click on a plot of a recording goes to that time', async () => {
  await choose('x');
  const over = page.locator('#plot-charts .u-over').first();
  await over.waitFor();
  await over.hover();
  const {width, height} = await over.boundingBox();
  const wanted = await page.evaluate((left) => window.coopdyn.plots.charts[0].posToVal(left, 'x'), 0.5 * width);
  await over.click({position: {x: 0.5 * width, y: height / 2}});
  await eventually(async () => Math.abs((await daemon.status()).playback.time_s - wanted) < 0.05);
});

test('nothing went wrong meanwhile', () => assert.deepEqual(page.mistakes, []));
