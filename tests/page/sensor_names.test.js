// SPDX-License-Identifier: MIT
// A robot with several lidars and cameras on the page, each by its module's name; and sensor marks in the view.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {before, test} from 'node:test';
import {eventually, hasText, moreStatuses, openScenario, picture} from './harness.js';

const SCENARIO = '[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 6 6\n[WALL]\ntype box\nsize 0.1 2 0.5\nposition 1.05 0\n' +
  '[ROBOT_1]\ntype twin\nname robot1\nposition 0 0\n';
const TURTLE = readFileSync(new URL('../../robots/turtle/model.sdf', import.meta.url), 'utf8');
const TWIN = TURTLE.replace('name="turtle"', 'name="twin"').replace('</model>', `
  <coopdyn:lidar name="short_lidar" link="lidar" columns="90" max_range="0.5"/>
  <coopdyn:camera name="rear_camera" link="camera" pose="0 0 0 0 0 3.14159265" width="64" height="48" fov_deg="58" near="0.05" far="8"/>
  <coopdyn:module type="lidar" name="short_lidar"/>
  <coopdyn:module type="camera" name="rear_camera"/>
</model>`);

let daemon, page;

before(async () => {
  ({daemon, page} = await openScenario(SCENARIO, {files: {'robots/twin/model.sdf': TWIN}, webgl: true}));
});

test('each camera has a tile and each lidar a plot, by its name', async () => {
  await page.waitForSelector('.card[open] [data-camera="rear_camera"]');
  const widths = () => page.evaluate(() => ['camera', 'rear_camera'].map(
    (name) => document.querySelector(`.card[open] [data-camera="${name}"] img`).naturalWidth));
  await eventually(async () => JSON.stringify(await widths()) === '[320,64]');
  await hasText(page, '.card[open] [data-module="/robot1/lidar"] figcaption', /^lidar: nearest 0\.9\d m/);
  await hasText(page, '.card[open] [data-module="/robot1/short_lidar"] figcaption', /^short_lidar: nothing in range/);
});

test('the view shows what sensors see while the box is checked', async () => {
  await page.click('#show > summary');
  await page.check('#rays');
  // Of the lidars and cameras: areas, outlines and the ends of rays, though the world stands still.
  await page.waitForFunction(() => window.coopdyn.marks.of.sensors.counts.every((count) => count > 10));
  await page.uncheck('#rays');
  await page.waitForFunction(() => window.coopdyn.marks.of.sensors.counts.every((count) => count === 0));
});

test('so do the pictures of the daemon', async () => {
  await page.goto(`${daemon.url}?view=server`);
  await page.waitForFunction(() => Number(document.getElementById('view').dataset.shown ?? 0) > 0);
  let without;
  await eventually(async () => {  // the first may have been asked for before the view had its size
    without = await picture(page);
    await moreStatuses(page, 3);
    return await picture(page) === without;
  });
  await page.click('#show > summary');
  await page.check('#rays');
  await eventually(async () => await picture(page) !== without);
  await page.uncheck('#rays');
  await eventually(async () => await picture(page) === without);
});
