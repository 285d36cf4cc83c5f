// SPDX-License-Identifier: MIT
// Scores and logged numbers: shown under Run and plotted, live and from a recording.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {isDeepStrictEqual} from 'node:util';
import {eventually, hasText, moreStatuses, newFolder, openPage, order as orderAt, startDaemon} from './harness.js';

const ROOM = `[SIMULATION]
mode realtime
[FLOOR]
size 8 8
[ROBOT_1]
type coopbot
name eva
position 0 0
`;
const SCORED = `${ROOM}[SCORE_1]
kind distance
name way
limit 600
[SCORE_2]
kind coverage
[SCORE_3]
kind time
until >= 500
`;
let folder, daemon, page;

const order = (module, line) => orderAt(daemon.url, module, line);
const drive = () => page.evaluate(() => window.coopdyn.connection.call({module: '/eva/motors', line: 'set_velocity 0.3 0.4'}));
/** The displayed rows: [name, value, note]. */
const rows = () => page.$$eval('#scores tr', (all) => all.map((row) => [...row.cells].map(({textContent}) => textContent)));
const points = () => page.evaluate(() => {
  const {plots} = window.coopdyn;
  return {times: plots.points?.times ?? [], columns: plots.points?.columns ?? [], values: plots.values};
});
const choose = (name) => page.locator('#plot-values label', {hasText: new RegExp(`^ ?${name}$`)}).locator('input').check();
const columnOf = ({columns, values}, key) => columns[values.findIndex((value) => value.key === key)] ?? [];

before(async () => {
  folder = newFolder();
  writeFileSync(join(folder, 'scored.scenario'), SCORED);
  writeFileSync(join(folder, 'short.scenario'), `${ROOM}[SCORE_1]\nkind time\nuntil >= 0.5\nlimit 3\n`);
  writeFileSync(join(folder, 'many.scenario'),
    ROOM + Array.from({length: 60}, (_, i) => `[SCORE_${i + 1}]\nkind time\nname score${i + 1}\n`).join(''));
  execFileSync(process.env.COOPDYN_BINARY, ['serve', join(folder, 'short.scenario'), '--mode', 'free', '--no-net', '--no-render',
    '--record', join(folder, 'short.run'), '--duration', '3']);
  daemon = await startDaemon(join(folder, 'scored.scenario'), '--recordings', folder, '--scenarios', folder, '--no-render');
  page = await openPage(daemon.url);
});

test('scores stand under Run, with their units and what they end', async () => {
  await drive();
  await eventually(async () => (await daemon.status()).scores[0].value > 0.05);
  await order('/simulation', 'pause');
  const [way, coverage, time] = (await daemon.status()).scores;
  const wanted = [['way', `${way.value.toFixed(3)} m`, 'limit 600 s'], ['coverage', `${coverage.value.toFixed(3)} m²`, ''],
    ['time', `${time.value.toFixed(3)} s`, 'until >= 500']];
  await eventually(async () => isDeepStrictEqual(await rows(), wanted));
  assert.equal(await page.textContent('#scores-title'), 'Scores');
  assert.ok(await page.isVisible('#scores'));
});

test('logged numbers stand below them, each the newest of its name', async () => {
  await order('/simulation', 'log energy 3.5');
  await order('/simulation', 'log gap 12');
  await order('/simulation', 'log energy -4.25');
  await hasText(page, '#scores', /energy−4\.250/);
  const time = (await daemon.status()).time_s.toFixed(2);
  assert.deepEqual((await rows()).slice(3), [['energy', '−4.250', `at ${time} s`], ['gap', '12', `at ${time} s`]]);
  assert.equal(await page.textContent('#scores-title'), 'Scores · Logged numbers');
});

test('the run is plotted live: its scores and what was logged', async () => {
  await page.click('#tab-plots');
  await page.selectOption('#plot-robot', {label: 'the run'});
  await page.waitForSelector('#plot-values input');
  for (const name of ['way', 'time', 'energy']) await choose(name);
  await eventually(async () => await page.locator('#plot-charts .uplot').count() === 3);  // m, s, none
  await order('/simulation', 'run');
  await drive();
  await eventually(async () => (await points()).times.length > 10);
  await order('/simulation', 'pause');
  const {time_s: now, scores} = await daemon.status();
  await eventually(async () => (await points()).times.at(-1) === now);
  await order('/simulation', 'log energy 7');  // after the moment was read: it counts all the same
  await eventually(async () => columnOf(await points(), 'logged.energy').at(-1) === 7);
  const read = await points();
  assert.equal(read.times.at(-1), now);
  assert.equal(columnOf(read, 'scores.way').at(-1), scores[0].value);
  assert.deepEqual(columnOf(read, 'scores.time'), read.times);
  assert.ok(columnOf(read, 'logged.energy').slice(0, -1).every((value) => value === -4.25));
});

test('a name that is logged later joins them, and the others keep their points', async () => {
  const before = await points();
  await order('/simulation', 'log late 1');
  await eventually(async () => (await points()).values.some(({key}) => key === 'logged.late'));
  await eventually(async () => columnOf(await points(), 'logged.late').at(-1) === 1);
  const after = await points();
  assert.deepEqual(columnOf(after, 'scores.way'), columnOf(before, 'scores.way'));
  assert.deepEqual(columnOf(after, 'logged.late').slice(0, -1), before.times.slice(0, -1).map(() => null));
});

test('CSV has the chosen curves of the run', async () => {
  const [file] = await Promise.all([page.waitForEvent('download'), page.click('#plot-csv')]);
  assert.equal(file.suggestedFilename(), 'run.csv');
  const [head, ...lines] = (await readFile(await file.path(), 'utf8')).trim().split('\n');
  assert.equal(head, 'time_s,run/scores way [m],run/scores time [s],run/logged energy');
  assert.match(lines.at(-1), /,7$/);
});

test('of a recording they are shown as they were at each moment', async () => {
  await order('/simulation', 'reset');
  await order('/recorder', 'start scored');
  await order('/simulation', 'run');
  await drive();
  const passed = (s) => eventually(async () => (await daemon.status()).time_s > s);
  await passed(0.4);
  await order('/simulation', 'log energy 1');
  await passed(0.8);
  await order('/simulation', 'log energy 2');
  await passed(1.2);
  await order('/recorder', 'stop');
  await order('/playback', 'open scored');
  await order('/playback', 'pause');
  await page.click('#tab-robots');
  const csv = join(folder, 'scored.csv');
  execFileSync(process.env.COOPDYN_BINARY, ['export', join(folder, 'scored.run'), '--out', csv, '--robots', 'none']);
  const [head, ...table] = readFileSync(csv, 'utf8').trim().split('\n').map((line) => line.split(','));
  const at = (name) => head.indexOf(name);
  const first = (value) => table.findIndex((row) => row[at('logged.energy')] === value);
  for (const row of [table[20], table[first('1')], table[first('2') - 1], table[first('2')]]) {
    await order('/playback', `seek ${row[at('time_s')]}`);
    await hasText(page, '#scores', new RegExp(`way${Number(row[at('score.way_m')]).toFixed(3)} m`));
    const energy = row[at('logged.energy')];
    await eventually(async () => isDeepStrictEqual((await rows()).slice(3).map((cells) => cells.slice(0, 2)),
      energy === 'nan' ? [] : [['energy', energy]]));
  }
});

test('and plotted whole, as in its export', async () => {
  await page.click('#tab-plots');
  await eventually(async () => (await points()).values.some(({key}) => key === 'scores.way'));
  const [head, ...table] = readFileSync(join(folder, 'scored.csv'), 'utf8').trim().split('\n').map((line) => line.split(','));
  const byTime = new Map(table.map((row) => [Number(row[head.indexOf('time_s')]), row]));
  const read = await points();
  assert.ok(read.times.length > 100, String(read.times.length));
  assert.deepEqual(read.values.map(({key, unit}) => [key, unit]),
    [['scores.way', 'm'], ['scores.coverage', 'm²'], ['scores.time', 's'], ['logged.energy', '']]);
  for (const [key, column] of [['scores.way', 'score.way_m'], ['scores.coverage', 'score.coverage_m2'], ['logged.energy', 'logged.energy']]) {
    const recorded = read.times.map((time) => Number(byTime.get(time)[head.indexOf(column)]));
    assert.deepEqual(columnOf(read, key), recorded.map((value) => (Number.isNaN(value) ? null : value)), key);
  }
  await choose('way');
  await page.locator('#plot-charts .u-over').first().waitFor();
});

test('the end of a run shows that its score was met', async () => {
  await page.click('#tab-robots');
  await order('/playback', 'open short');
  await order('/playback', 'pause');
  await order('/playback', 'seek 0.2');
  await hasText(page, '#scores', /^time0\.200 suntil >= 0\.5 · limit 3 s$/);
  await order('/playback', 'seek 3');
  await hasText(page, '#scores', /^time0\.500 s✓ met$/);
  await order('/playback', 'close');
});

test('many scores leave room for the rest', async () => {
  await order('/simulation', 'load_scenario many');
  await hasText(page, '#scores', /score60/);
  const place = await page.locator('#scores-place').boundingBox();
  const robots = await page.locator('#robots-title').boundingBox();
  assert.ok(place.height < 160 && robots.y < 700, JSON.stringify([place, robots]));
});

test('without scores nothing is shown', async () => {
  await order('/simulation', 'load_scenario classroom');
  await moreStatuses(page, 2);
  await page.waitForSelector('#scores-box', {state: 'hidden'});
  assert.ok(await page.isVisible('#robots-title'));
});

test('nothing went wrong meanwhile', () => assert.deepEqual(page.mistakes, []));
