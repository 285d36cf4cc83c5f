// SPDX-License-Identifier: MIT
// The tab Arena, dropped files, and links.
import assert from 'node:assert/strict';
import {before, test} from 'node:test';
import {call, eventually, hasText, openClassroom, openPage, startDaemon} from './harness.js';

const WEBGL = {webgl: true};
let daemon, page;
const requests = [];

before(async () => {
  ({daemon, page} = await openClassroom(WEBGL));
  page.on('request', (request) => requests.push(request.url()));
  await page.waitForFunction(() => window.coopdyn?.handles);
});

const world = async () => JSON.parse((await call(daemon.url, {module: '/world', line: 'list'})).text);

/** Drops files with these texts onto the view, at this height. */
const drop = (files, height = 0.6) => page.evaluate(([named, down]) => {
  const data = new DataTransfer();
  for (const [name, text] of Object.entries(named)) data.items.add(new File([text], name));
  const frame = document.getElementById('view-frame'), box = frame.getBoundingClientRect();
  const where = {clientX: box.x + box.width / 2, clientY: box.y + down * box.height, dataTransfer: data, bubbles: true, cancelable: true};
  frame.dispatchEvent(new DragEvent('dragover', where));
  frame.dispatchEvent(new DragEvent('drop', where));
}, [files, height]);

test('scenarios, worlds and robots are there with their pictures', async () => {
  await page.click('#tab-arena');
  for (const [kind, name] of [['scenario', 'corridor'], ['world', 'arena'], ['robot', 'hexapod']]) {
    const card = page.locator(`.thumb[data-kind="${kind}"][data-name="${name}"]`);
    await card.scrollIntoViewIfNeeded();
    await eventually(async () => await card.locator('img').evaluate((picture) => picture.naturalWidth) === 320);
  }
});

test('few pictures are fetched at once, so that a click need not wait for them', async () => {
  const fresh = await openPage(daemon.url);
  let held = 0;
  await fresh.route('**/thumb/**', () => { ++held; });  // never answered
  await fresh.click('#tab-arena');
  await fresh.locator('.thumb-box .small').first().click();
  await eventually(() => fresh.evaluate(() => window.coopdyn.editor.code?.view.state.doc.length > 0));
  await eventually(() => held >= 3);
  assert.equal(held, 3);
  await fresh.close();
});

test('a click on a scenario loads it', async () => {
  await page.click('.thumb[data-kind="scenario"][data-name="corridor"]');
  await eventually(async () => (await daemon.status()).scenario === 'corridor');
  await page.waitForSelector('.thumb[data-name="corridor"][aria-pressed="true"]');
});

test('a click on a world loads it without robots', async () => {
  await page.click('.thumb[data-kind="world"][data-name="square10"]');
  await eventually(async () => (await daemon.status()).robot_count === 0);
});

test('a robot is dragged from the gallery onto the floor', async () => {
  await page.waitForFunction(() => !window.coopdyn.view.scene.find('robot1'));
  const card = page.locator('.thumb[data-kind="robot"][data-name="coopbot"]');
  await card.scrollIntoViewIfNeeded();
  const frame = await page.locator('#view').boundingBox();
  await card.dragTo(page.locator('#view'), {targetPosition: {x: 0.4 * frame.width, y: 0.6 * frame.height}});
  await eventually(async () => (await world()).robots.length === 1);
});

test('a name that is looked for leaves the others out', async () => {
  await page.click('#tab-arena');
  await page.fill('#gallery-find', 'hexapod');
  assert.deepEqual(await page.locator('.thumb').evaluateAll((cards) => [...new Set(cards.map(({dataset}) => dataset.kind))]), ['scenario', 'robot']);
  await page.fill('#gallery-find', '');
});

test('a dropped scenario is loaded', async () => {
  await drop({'mine.scenario': '[ROBOT_1]\ntype coopbot\nname ana\nposition 1 0\n'});
  await eventually(async () => (await daemon.status()).robots[0]?.name === 'ana');
  await page.waitForFunction(() => window.coopdyn.view.scene.find('ana'));
  await page.evaluate(() => window.coopdyn.view.select('ana'));
});

test('a dropped scenario with mistakes shows them by line, and changes nothing', async () => {
  await drop({'wrong.scenario': '[ROBOT_1]\ntype coopbot\nposition 0 0\ncolour sky\nspeeed 3\n'});
  await hasText(page, '#diagnostics', /line 5.*speeed/s);
  assert.equal((await daemon.status()).robots[0].name, 'ana');
});

test('an experiment of YARS stands among the scenarios, and a dropped one is loaded', async () => {
  assert.equal(await page.locator('.thumb[data-kind="scenario"][data-name="double_pendulum"]').count(), 1);
  await drop({'fall.xml': `<rosiml version="1.0"><movables><movable name="eve" type="active"><body>
    <object name="all" mass="1"><pose z="0.1"/><sphere radius="0.1"/><compass name="north"/></object></body></movable></movables></rosiml>`});
  await eventually(async () => (await daemon.status()).robots[0]?.name === 'eve');
});

test('a dropped world is loaded', async () => {
  await drop({'field.world': '[FLOOR]\nsize 6 6\n[PILLAR_1]\ntype cylinder\nsize 0.4 0.4 1\nposition 0 0\n'});
  await eventually(async () => (await world()).things.some(({name}) => name === 'PILLAR_1'));
  await page.waitForFunction(() => window.coopdyn.view.scene.find('PILLAR_1'));
  assert.equal(await page.evaluate(() => window.coopdyn.view.selected), null, 'what was selected is gone');
});

test('a dropped robot model is inserted where it was dropped, and stands in the gallery', async () => {
  const urdf = `<robot name="crate_bot"><link name="base">
    <inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.3 0.3 0.2"/></geometry></visual><collision><geometry><box size="0.3 0.3 0.2"/></geometry></collision>
    </link></robot>`;
  await drop({'crate_bot.urdf': urdf}, 0.85);
  const crate = async () => (await world()).robots.find(({type}) => type === 'crate_bot');
  await eventually(async () => await crate() !== undefined);
  const floor = await page.evaluate(() => {
    const box = document.getElementById('view-frame').getBoundingClientRect();
    return window.coopdyn.view.floorAt(box.x + box.width / 2, box.y + 0.85 * box.height).toArray();
  });
  const {position} = await crate();
  assert.ok(Math.hypot(position[0] - floor[0], position[1] - floor[1]) < 0.05, `${position}, not ${floor}`);
  await page.click('#tab-arena');
  await page.waitForSelector('.thumb[data-kind="robot"][data-name="crate_bot"]');
});

test('another file is refused in words', async () => {
  await drop({'photo.jpg': 'x'});
  await hasText(page, '#message.error', /^photo\.jpg: drop a \.scenario, \.xml, \.world, \.sdf or \.urdf file$/);
});

test('a scenario with a name of markup is text', async () => {
  await drop({'<img src=x onerror=alert(1)>.scenario': '[ROBOT_1]\ntype coopbot\nname bob\nposition 0 0\n'});
  await eventually(async () => (await daemon.status()).robots[0]?.name === 'bob');
  assert.equal(await page.locator('img[src="x"]').count(), 0);
});

test('a link loads its scenario and looks from where it says', async () => {
  const linked = await openPage(`${daemon.url}?scenario=corridor&view=top&tab=world`, WEBGL);
  await eventually(async () => (await daemon.status()).scenario === 'corridor');
  await linked.waitForFunction(() => window.coopdyn?.view.scene);
  await linked.waitForFunction(() => {
    const {camera, controls} = window.coopdyn.view;
    return Math.hypot(camera.position.x - controls.target.x, camera.position.y - controls.target.y) < 0.1;
  });
  assert.equal(await linked.isVisible('#panel-world'), true);
  assert.equal(new URL(linked.url()).searchParams.has('scenario'), false);
  assert.deepEqual(linked.mistakes, []);
  await linked.close();
});

test('a link to a scenario that is not there says so', async () => {
  const linked = await openPage(`${daemon.url}?scenario=nowhere`);
  await hasText(linked, '#message.error', /nowhere/);
  await linked.close();
});

test('with --read-only nothing is loaded, in words', async () => {
  const locked = await startDaemon('classroom', '--read-only', '--mode', 'free');
  const looking = await openPage(`${locked.url}?scenario=corridor`);
  await hasText(looking, '#message.error', /read-only/);
  assert.equal((await locked.status()).scenario, 'classroom');
  await looking.close();
  await locked.stop();
});

test('nothing is asked of another host', () => {
  const {host} = new URL(daemon.url);
  assert.deepEqual(requests.filter((url) => !url.startsWith('blob:') && new URL(url).host !== host), []);
});
