// SPDX-License-Identifier: MIT
// Recordings played on the page: scrubbed, reversed, stepped, branched, overlaid.
import assert from 'node:assert/strict';
import {createInterface} from 'node:readline';
import {before, test} from 'node:test';
import {eventually, hasText, newFolder, openModule, openPage, order as orderAt, startDaemon} from './harness.js';

const STEPS = 2000;  // long enough that it still plays when a slow browser presses pause
const WEBGL = {webgl: true};
let daemon, page, liveHash;

const order = (module, line) => orderAt(daemon.url, module, line);

/** Records `name` in lockstep; the robot turns from step 100 on at `turn`. */
async function record(name, turn) {
  await order('/simulation', 'reset');
  await order('/recorder', `start ${name}`);
  const motors = await openModule(daemon.names, '/robot1/motors');
  const replies = createInterface({input: motors})[Symbol.asyncIterator]();
  for (let step = 1; step <= STEPS; ++step) {
    motors.write(`set_velocity 0.3 ${step > 100 ? turn : 0}\n`);
    await replies.next();
    if (step === 50 && turn === 0) await order('/recorder', 'note half-way');
  }
  motors.end();
  await order('/recorder', 'stop');
}

before(async () => {
  daemon = await startDaemon('classroom', '--recordings', newFolder(), '--mode', 'lockstep');
  await record('straight', 0);
  await record('turning', 1);
  liveHash = (await daemon.status()).hash;
  page = await openPage(daemon.url, WEBGL);
  await page.waitForFunction(() => window.coopdyn?.handles);
});

const playback = async () => (await daemon.status()).playback;
const button = (row, text) => page.locator('#runs-list li', {hasText: row}).locator('button', {hasText: text});
const scrub = (time) => page.evaluate((value) => {
  const track = document.getElementById('timeline-track');
  track.value = value;
  track.dispatchEvent(new Event('input'));
}, time);

test('Play in the list plays a recording, and the timeline appears', async () => {
  await page.click('#tab-runs');
  assert.equal(await page.isVisible('#timeline'), false);
  await button('straight.run', 'Play').click();
  await hasText(page, '#state', /^playing$/);
  await page.waitForSelector('#timeline', {state: 'visible'});
  await page.click('#timeline-play');
  await hasText(page, '#state', /^paused$/);
});

test('scrubbing shows the time that is asked for', async () => {
  for (const time of [1.2, 0.4]) {
    await scrub(time);
    await eventually(async () => (await playback()).step === Math.round(100 * time));
    await hasText(page, '#timeline-time', new RegExp(`^${time.toFixed(2)} / 20\\.00 s, step ${100 * time}$`));
  }
});

test('steps go on and back', async () => {
  await page.click('#timeline-step');
  await eventually(async () => (await playback()).step === 41);
  await page.click('#timeline-step-back');
  await eventually(async () => (await playback()).step === 40);
});

test('a note is a mark, and a click on it goes there', async () => {
  await page.click('.mark.note');
  await eventually(async () => (await playback()).step === 50);
  assert.match(await page.getAttribute('.mark.note', 'title'), /half-way/);
});

test('keyframes are marks', async () => {
  assert.ok(await page.locator('.mark.keyframe').count() >= 1);
});

test('below 0 it goes backwards', async () => {
  await page.click('#timeline-last');
  await eventually(async () => (await playback()).step === STEPS);
  await page.selectOption('#timeline-speed', '-4');
  await page.click('#timeline-play');
  await eventually(async () => (await playback()).step < STEPS - 140);
  await page.selectOption('#timeline-speed', '1');
  await order('/playback', 'pause');
});

test('in a loop it begins again', async () => {
  await page.click('#timeline-loop');
  await page.waitForSelector('#timeline-loop[aria-pressed="true"]');
  assert.equal((await playback()).loop, true);
  await page.click('#timeline-loop');
  await page.waitForSelector('#timeline-loop[aria-pressed="false"]');
});

test('a ghost of another run is drawn where that run was, and the page tells where they part', async () => {
  await scrub(2);
  await eventually(async () => (await playback()).step === 200);
  await button('turning.run', 'Ghost').click();
  await hasText(page, '#parting', /step 10[0-9]/);
  await page.waitForFunction(() => {
    const {view} = window.coopdyn;
    const ghost = view.scene.root.parent.children.find((child) => child.userData.ghost);
    const mesh = ghost?.children.find((child) => child.isInstancedMesh);
    if (!mesh || view.step !== 200) return false;
    const [x, y] = view.scene.pose(view.scene.find('robot1'))[0].toArray();
    const apart = Math.hypot(mesh.instanceMatrix.array[12] - x, mesh.instanceMatrix.array[13] - y);
    return apart > 0.02 && apart < 0.5;
  });
  await page.waitForSelector('.mark.parting');
  await button('turning.run', 'Ghost').click();
  await page.waitForSelector('#parting', {state: 'hidden'});
  assert.equal(await page.locator('.mark.parting').count(), 0);
});

test('a recording is not a ghost that parts from itself', async () => {
  const answer = await (await fetch(new URL('runs/straight.run/parting?with=straight.run', daemon.url))).json();
  assert.equal(answer.equal, true);
  assert.equal(answer.steps, STEPS);
});

test('Back to the live run puts back what was there', async () => {
  await page.click('#timeline-close');
  await page.waitForSelector('#timeline', {state: 'hidden'});
  assert.equal((await daemon.status()).hash, liveHash);
  await hasText(page, '#playback', /^$/);
});

test('Go live from here goes on from what is shown', async () => {
  await button('straight.run', 'Play').click();
  await page.waitForSelector('#timeline', {state: 'visible'});
  await page.evaluate(() => window.coopdyn.connection.call({module: '/playback', line: 'pause'}));
  await scrub(0.5);
  await eventually(async () => (await playback()).step === 50);
  await page.click('#timeline-branch');
  await page.waitForSelector('#timeline', {state: 'hidden'});
  assert.equal((await daemon.status()).step, 50);
});

test('a note is taken while a run is recorded', async () => {
  await page.click('#record');
  await page.waitForSelector('#note', {state: 'visible'});
  await page.fill('#note', 'they <b>meet</b>');
  await page.press('#note', 'Enter');
  await hasText(page, '#message', /^noted: they <b>meet<\/b>$/);
  await page.click('#record');
  await page.waitForSelector('#note', {state: 'hidden'});
});

test('a table of a run has the numbers of its export', async () => {
  const answer = await fetch(new URL('runs/turning.run/table?robot=robot1&points=100', daemon.url));
  assert.equal(answer.status, 200);
  const [head, ...rows] = (await answer.text()).trim().split('\n');
  assert.match(head, /robot1\.x_m/);
  assert.ok(rows.length > 90 && rows.length <= 202, String(rows.length));
  const ofRun = await (await fetch(new URL('runs/turning.run/table?points=100', daemon.url))).text();
  assert.match(ofRun, /^step,time_s,hash\n0,0,[0-9a-f]{16}\n/, 'without scores and logged numbers no more');
});

test('what is asked of a recording wrongly is refused in words', async () => {
  for (const [path, status, words] of [['runs/none.run/timeline', 404, /no recording/],
    ['runs/straight.run/parting', 400, /with=/], ['runs/straight.run/parting?with=../x.run', 400, /with=/],
    ['runs/straight.run/poses?rate=0', 400, /0\.1 to/], ['runs/straight.run/table?robot=nobody', 409, /nobody/]]) {
    const answer = await fetch(new URL(path, daemon.url));
    assert.equal(answer.status, status, path);
    assert.match(await answer.text(), words, path);
  }
});

test('nothing went wrong meanwhile', () => assert.deepEqual(page.mistakes, []));
