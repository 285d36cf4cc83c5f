// SPDX-License-Identifier: MIT
// Marks in the view besides the world's objects.
import assert from 'node:assert/strict';
import {before, test} from 'node:test';
import {call, eventually, openScenario} from './harness.js';

const SCENARIO = `[SIMULATION]
mode realtime
[TARGET]
red 2 0
blue 0 -1.5
[ROBOT_1]
type coopbot
name one
position 0 0
[ROBOT_2]
type lwa
name arm
position 0 3
`;
let page, daemon;

before(async () => {
  ({page, daemon} = await openScenario(SCENARIO, {webgl: true}));
  await page.waitForFunction(() => window.coopdyn?.marks && window.coopdyn.view.scene);
  await page.click('#show > summary');
});

const count = (mark) => page.evaluate((name) => window.coopdyn.marks.of[name].count, mark);

test('names stand at their robots and things', async () => {
  await page.check('#show-names');
  await eventually(async () => (await page.locator('#labels span').allTextContents()).includes('arm'));
  await page.uncheck('#show-names');
  await eventually(async () => await page.locator('#labels span').count() === 0);
});

test('rays of sensors end at what they meet, beside other marks', async () => {
  await call(daemon.url, {module: '/world', command: 'insert', text: '[BOX_5]\ntype box\nsize 0.2 4 1\nposition 1.1 0'});
  await page.check('#show-names');
  await page.check('#rays');
  // The coopbot at the origin looks along x.
  const ends = () => page.evaluate(() => {
    const {geometry} = window.coopdyn.view.scene.root.parent.children.find((child) => child.isPoints);
    return [...geometry.getAttribute('position')?.array ?? []].filter((_, i) => i % 3 === 0);
  });
  await eventually(async () => (await ends()).some((x) => Math.abs(x - 1) < 0.005));
  assert.ok((await ends()).every((x) => x < 1.005 || x > 1.195), 'nothing is inside the box');
  assert.ok((await page.evaluate(() => window.coopdyn.marks.of.sensors.counts))[1] >= 11, 'lines of a coopbot');
  assert.ok(await page.locator('#labels span').count() > 0, 'the names are still there');
  await page.uncheck('#rays');
  await eventually(async () => (await page.evaluate(() => window.coopdyn.marks.of.sensors.counts)).every((count) => count === 0));
  await page.uncheck('#show-names');
  await call(daemon.url, {module: '/world', command: 'remove', text: 'BOX_5'});
});

test('each joint of the arm and each wheel has an axis', async () => {
  await page.check('#show-axes');
  const joints = await page.evaluate(() => window.coopdyn.view.scene.things.filter(({kind}) => kind === 'robot')
    .reduce((sum, {model}) => sum + model.joints.length, 0));
  assert.ok(joints >= 7);
  await eventually(async () => await count('axes') === joints);
  await page.uncheck('#show-axes');
  await eventually(async () => await count('axes') === 0);
});

test('a line leads from the robot to each target that it sees', async () => {
  await page.check('#show-bearings');
  await eventually(async () => await count('bearings') === 2);
  await page.uncheck('#show-bearings');
  await eventually(async () => await count('bearings') === 0);
});

test('a contact of a bumper is drawn', async () => {
  await call(daemon.url, {module: '/world', command: 'insert', text: '[ROBOT_9]\ntype turtle\nname bump\nposition 3 0'});
  await call(daemon.url, {module: '/world', command: 'insert', text: '[BOX_1]\ntype box\nsize 0.2 2 0.5\nposition 3.5 0'});
  await page.check('#show-contacts');
  const contacts = async () => (await call(daemon.url, {module: '/bump/contact', line: 'get_contacts'})).params?.length ?? 0;
  await page.evaluate(() => window.coopdyn.connection.call({module: '/bump/motors', line: 'set_velocity 0.3 0'}));
  await eventually(async () => await contacts() > 0);
  await eventually(async () => await count('contacts') > 0);
  await page.uncheck('#show-contacts');
});

test('trails follow a robot that drives', async () => {
  await page.check('#show-trails');
  await page.evaluate(() => window.coopdyn.connection.call({module: '/one/motors', line: 'set_velocity 0.3 0.3'}));
  await eventually(async () => await page.evaluate(() => window.coopdyn.view.scene.root.parent.children.some(
    (child) => child.isLine && !child.isLineSegments && child.geometry.drawRange.count > 5)));
  await page.uncheck('#show-trails');
});
