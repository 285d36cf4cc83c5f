// SPDX-License-Identifier: MIT
// The panel: who did what, loads that can be taken back, readings as pictures, small windows.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {readFileSync} from 'node:fs';
import {networkInterfaces} from 'node:os';
import {afterEach, describe, test} from 'node:test';
import {promisify} from 'node:util';
import {programOf, inLanguages} from '../../server/web/page/console_copy.js';
import {stateVerdict} from '../../server/web/page/costs.js';
import {partingText} from '../../server/web/page/recordings.js';
import {liveName} from '../../server/web/page/series.js';
import {call, endAll, eventually, hasText, moreStatuses, newFolder, openClassroom, openPage, openScenario, order, startDaemon} from './harness.js';

const run = promisify(execFile);
const SOURCE = new URL('../..', import.meta.url).pathname;
const WEBGL = {webgl: true};
const scenario = (more, type = 'coopbot') => `[SIMULATION]\nmode realtime\n${more}\n[FLOOR]\nsize 6 6 0.1\n[ROBOT_1]\ntype ${type}\nname robot1\nposition 0 0\n`;

afterEach(endAll);

const upload = (page, name, text) => page.setInputFiles('#upload', {name, mimeType: 'text/plain', buffer: Buffer.from(text)});
const things = async (url) => JSON.parse((await call(url, {module: '/world', line: 'list'})).text).things.map(({name}) => name);

const CROWD = '[SIMULATION]\nmode realtime\n[FLOOR]\nsize 40 40 0.1\n[SWARM_1]\ntype minibot\ncount 600\nname bot\n';
const cards = (page) => page.locator('#robots > .card summary strong').allTextContents();

test('all robots of a crowd are reached by scrolling, and few are in the page at a time', async () => {
  const {page} = await openScenario(CROWD);
  await hasText(page, '#robot-count', /^600$/);
  await eventually(async () => (await cards(page)).includes('bot_1'));
  assert.ok((await cards(page)).length < 80, 'only those near the visible part');
  await eventually(async () => {  // the end of the list moves while heights become known
    await page.evaluate(() => document.getElementById('robots').lastElementChild.scrollIntoView());
    return (await cards(page)).includes('bot_600');
  });
  assert.ok((await cards(page)).length < 80);
  const last = page.locator('.card[data-robot="bot_600"]');
  await last.locator('summary strong').click();
  await hasText(page, '.card[data-robot="bot_600"] .readings-place', /position/);
  await page.evaluate(() => document.getElementById('robots').firstElementChild.scrollIntoView());
  await page.evaluate(() => { document.getElementById('robots').closest('.tab-panel').scrollTop = 0; });
  await eventually(async () => (await cards(page)).includes('bot_1') && !(await cards(page)).includes('bot_600'));
});

test('a robot of a crowd is found by its name', async () => {
  const {page} = await openScenario(CROWD);
  await page.fill('#robot-search', 'T_59');
  await hasText(page, '#robot-count', /^11 of 600$/);
  await eventually(async () => (await cards(page)).join() === ['bot_59', ...Array.from({length: 10}, (_, i) => `bot_59${i}`)].join());
  await page.fill('#robot-search', 'nobody');
  await hasText(page, '#robot-count', /^0 of 600$/);
  await eventually(async () => (await cards(page)).length === 0);
  await page.fill('#robot-search', '');
  await eventually(async () => (await cards(page)).includes('bot_1'));
});

test('the search of a crowd shows what stands in its field, in whatever order the names come', async () => {
  const {page} = await openScenario(CROWD);
  await hasText(page, '#robot-count', /^600$/);
  const held = [];
  await page.route('**/api/scene', (route) => { held.push(route); });
  await page.fill('#robot-search', 't_5');
  await eventually(async () => held.length === 1);
  await page.fill('#robot-search', 't_59');
  await eventually(async () => held.length === 2);
  await held[1].continue();
  await hasText(page, '#robot-count', /^11 of 600$/);
  await Promise.all([page.waitForResponse('**/api/scene'), held[0].continue()]);
  await moreStatuses(page, 2);
  await hasText(page, '#robot-count', /^11 of 600$/);
});

test('a search that waits for names is of the robots of the world loaded meanwhile', async () => {
  const {daemon, page} = await openScenario(CROWD);
  await hasText(page, '#robot-count', /^600$/);
  let answered = 0, letGo;
  const released = new Promise((done) => { letGo = done; });
  await page.route('**/api/scene', async (route) => {
    const response = await route.fetch();
    ++answered;
    await released;
    await route.fulfill({response});
  });
  await page.fill('#robot-search', 't_59');
  await eventually(async () => answered === 1);
  const {error, text} = await call(daemon.url, {module: '/simulation', command: 'load_scenario', text: CROWD.replace('600', '400')});
  assert.equal(error, 0, text);
  await hasText(page, '#robot-count', /400$/);
  letGo();
  await hasText(page, '#robot-count', /^1 of 400$/);
  await page.fill('#robot-search', 't_599');
  await hasText(page, '#robot-count', /^0 of 400$/);
});

test('a loaded scenario that ends stands, and Reset starts it again', async () => {
  const {daemon, page} = await openClassroom();
  await upload(page, 'short.scenario', scenario('duration 0.5'));
  await hasText(page, '#state', /^ended: the run has reached its duration$/);
  await page.setViewportSize({width: 1280, height: 800});
  assert.ok(await page.$eval('#state', (state) => state.scrollWidth <= state.clientWidth + 1), 'the reason is cut off');
  assert.equal(daemon.process.exitCode, null);
  await page.click('#reset');
  await hasText(page, '#state', /^running$/);
});

test('a load can be taken back: what was built by hand is there again', async () => {
  const {daemon, page} = await openClassroom();
  await order(daemon.url, '/world', 'insert "[TOWER] | type box | size 0.2 0.2 1 | position 2 2"');
  await page.waitForSelector('#scenarios option[value="corridor"]', {state: 'attached'});
  await page.selectOption('#scenarios', 'corridor');
  await page.click('#load');
  await hasText(page, '#scenario-name', /^corridor$/);
  await hasText(page, '#message-offer', /^Undo: back to classroom$/);
  await page.click('#message-offer');
  await hasText(page, '#scenario-name', /^classroom$/);
  assert.ok((await things(daemon.url)).includes('TOWER'));
});

test('a load that failed offers no way back', async () => {
  const {page} = await openClassroom();
  await upload(page, 'wrong.scenario', '[ROBOT_1]\ncolr red\n');
  await page.waitForSelector('#diagnostics li');
  assert.equal(await page.isVisible('#message-offer'), false);
});

test('who did something is named to the others, by name or by address', async () => {
  const {daemon, page} = await openClassroom();
  const other = await openPage(daemon.url);
  await page.waitForSelector('button.person');
  await page.click('button.person');
  await page.fill('#own-name', 'Ana Lima');
  await page.press('#own-name', 'Enter');
  await other.waitForSelector('.person[title^="Ana Lima"]');
  await page.click('#pause');
  await hasText(other, '#latest', /^\d+\.\d\d s: pause by Ana Lima$/);
  await hasText(other, '#message', /^pause by Ana Lima$/);
  assert.doesNotMatch(await page.textContent('#message'), /by Ana/, 'who did it knows');
  await other.click('#reset');
  await hasText(page, '#events', /0\.00 s: reset by page 127\.0\.0\.1:\d+/);
  await order(daemon.url, '/world', 'insert "[TOWER] | type box | size 0.2 0.2 1 | position 2 2"');
  await hasText(page, '#latest', /insert TOWER by page/);
  await other.close();
  await page.close();
});

test('with --read-only the page says so, and offers nothing that would be refused', async () => {
  const daemon = await startDaemon('classroom', '--read-only', '--no-render');
  const page = await openPage(daemon.url);
  await page.waitForSelector('#view-only', {state: 'visible'});
  assert.equal(await page.textContent('#view-only'), 'view only');
  assert.equal(await page.isVisible('#locked'), false);
  for (const id of ['run', 'pause', 'reset', 'reload', 'stop-all', 'record', 'load', 'set-mode']) {
    await page.waitForFunction((which) => document.getElementById(which).disabled, id);
    assert.match(await page.getAttribute(`#${id}`, 'title'), /--read-only/, id);
  }
});

test('after a load the card says what its robot is now', async () => {
  // Without ports of its own, and with the same modules: only the type differs.
  const text = (type) => `${scenario('', type)}sockets no\n`;
  const twin = readFileSync(`${SOURCE}robots/coopbot/model.sdf`, 'utf8').replace('name="coopbot"', 'name="twin"');
  const {page} = await openScenario(text('coopbot'), {files: {'robots/twin/model.sdf': twin}});
  await hasText(page, '.card[data-robot="robot1"] .card-body > p', /^coopbot$/);
  await upload(page, 'twin.scenario', text('twin'));
  await hasText(page, '.card[data-robot="robot1"] .card-body > p', /^twin$/);
});

test('Ctrl+Enter with a mistake stays in the editor, which marks it', async () => {
  const {daemon, page} = await openClassroom();
  await page.click('#tab-text');
  await page.waitForFunction(() => window.coopdyn.editor.report);
  await page.evaluate(() => window.coopdyn.editor.code.replace('[ROBOT_1]\ntype coopbot\nposition 0 0\ncolr red\n'));
  await hasText(page, '#editor-state', /^1 error; line 4/);
  await page.evaluate(() => window.coopdyn.editor.code.view.focus());
  await page.keyboard.press('Control+Enter');
  await hasText(page, '#message.error', /errors; nothing was changed/);
  assert.equal(await page.isVisible('#editor'), true);
  assert.equal((await daemon.status()).scenario, 'classroom');
});

test('what is dragged is shown where it would stand, and beside the floor it is refused', async () => {
  const {daemon, page} = await openScenario(scenario(''), WEBGL);
  await page.waitForFunction(() => window.coopdyn.shadow && window.coopdyn.view.scene);
  await page.click('#tab-world');
  await page.click('#view-tools button:has-text("top")');
  const drag = (at, type) => page.evaluate(([[x, y], last]) => {
    const {view} = window.coopdyn;
    view.renderNow();
    const p = view.camera.position.clone().set(x, y, 0).project(view.camera), box = view.canvas.getBoundingClientRect();
    const where = {clientX: box.left + (p.x + 1) / 2 * box.width, clientY: box.top + (1 - p.y) / 2 * box.height};
    const dataTransfer = new DataTransfer();
    const fire = (element, kind) => element.dispatchEvent(new DragEvent(kind, {bubbles: true, cancelable: true, dataTransfer, ...where}));
    fire(document.querySelector('#palette [data-kind="box"]'), 'dragstart');
    const frame = document.getElementById('view-frame');
    fire(frame, 'dragover');
    if (last === 'drop') fire(frame, 'drop');
    return window.coopdyn.shadow.shown;
  }, [at, type]);
  const over = await drag([2, 1], 'dragover');
  assert.ok(Math.hypot(over.x - 2, over.y - 1) < 0.1 && over.isFree, JSON.stringify(over));
  assert.equal((await drag([3.4, 0], 'dragover')).isFree, false);
  assert.equal(await drag([3.4, 0], 'drop'), null, 'nothing is shown any more');
  await hasText(page, '#message.error', /^There is no floor/);
  assert.deepEqual(await things(daemon.url), []);
});

test('the recorded values have the names of the live ones', () => {
  const modules = ['motors', 'pose', 'distance', 'target', 'imu'];
  const named = ['x', 'd3', 'red1_distance', 'left_setpoint', 'imu_qw', 'joint_2'].map((name) => Object.values(liveName(name, modules)).join('/'));
  assert.deepEqual(named, ['pose/x', 'distance/range 3', 'target/distance red1', 'set-points/left', 'imu/qw', 'joints/joint_2']);
});

test('where two recordings part is said in a sentence, with numbers that can be read', () => {
  const parting = {equal: false, step: 101, time_s: 1.01, what: 'robot1', field: 'left_setpoint_rad_s', one: '0.29999999999999999', other: '7.4500000000000002'};
  assert.equal(partingText(parting, 'a.run', 'b.run'),
    'a and b part at step 101, 1.01 s: left setpoint of robot1 is 0.3 rad/s in the first and 7.45 rad/s in the second');
});

test('Speed says first what the strip says', () => {
  assert.equal(stateVerdict({state: 'paused'}, true), 'The run is paused: Run lets it go on.');
  assert.match(stateVerdict({state: 'waiting', awaiting: [{robot: 'robot1', why: 'no client', seconds: 3}]}, false), /^Waiting for robot1 \(no client\), 3\.0 s\.$/);
  assert.match(stateVerdict({state: 'running', mode: 'realtime', speed: 1, rtf: 0.5}, true), /keeps × 0\.50 of × 1\.00.*other programs/);
  assert.equal(stateVerdict({state: 'running', mode: 'realtime', speed: 1, rtf: 0.99}, true), '');
});

test('commands are copied as the functions of the clients, and the program runs', async () => {
  const {daemon} = await openClassroom();
  const sent = [{module: '/simulation', name: 'set_mode', line: 'set_mode free', params: [2]},
    {module: '/robot1/motors', name: 'set_velocity', line: 'set_velocity 0.2 0.5', data: [0.2, 0.5]}];
  const lines = sent.map((one) => inLanguages(one).Python);
  assert.deepEqual(lines, ['sim.set_mode("free")', 'robot1.set_velocity(0.2, 0.5)']);
  assert.equal(inLanguages(sent[1]).MATLAB, 'robot1.set_velocity(0.2, 0.5);');
  assert.equal(inLanguages(sent[1])['C++'], 'robot1.set_velocity(0.2, 0.5);');
  const program = programOf('Python', '127.0.0.1', Number(daemon.names.split(':').at(-1)), lines, ['robot1']);
  const {stdout} = await run('python3', ['-c', `${program}print(sim.mode)`], {env: {...process.env, PYTHONPATH: `${SOURCE}/clients/python`}});
  assert.equal(stdout.trim(), 'free');
});

describe('a recording', () => {
  test('is named when it ends, and deleted after a question', async () => {
    const daemon = await startDaemon('classroom', '--recordings', newFolder(), '--no-render');
    const page = await openPage(daemon.url);
    const names = async () => (await (await fetch(new URL('runs', daemon.url))).json()).map(({name}) => name);
    await page.click('#record');
    await hasText(page, '#record', /^Stop recording$/);
    await eventually(async () => (await (await fetch(new URL('runs', daemon.url))).json())[0]?.steps > 5);
    await page.click('#record');
    await hasText(page, '#message-offer', /^Name it$/);
    await page.click('#message-offer');
    await page.fill('#runs-list input.run-name', 'my first try');
    await page.press('#runs-list input.run-name', 'Enter');
    await eventually(async () => JSON.stringify(await names()) === '["my first try.run"]');
    await hasText(page, '#runs-list', /^my first try\.run/);
    await page.click('#runs-list button[title^="Delete"]');
    await page.click('dialog button[value="no"]');
    assert.equal((await names()).length, 1);
    await page.click('#runs-list button[title^="Delete"]');
    await page.click('dialog button[value="yes"]');
    await hasText(page, '#runs-list', /^none yet/);
    assert.deepEqual(await names(), []);
  });
});

test('from another machine a robot is driven without the token, as by a program, and nothing else', async () => {
  const outer = Object.values(networkInterfaces()).flat().find(({internal, family}) => !internal && family === 'IPv4');
  assert.ok(outer, 'this test needs a network address besides loopback');
  const daemon = await startDaemon('classroom', '--no-render', '--host', '0.0.0.0', '--token', 'the-right-token');
  const address = new URL(daemon.url);
  address.hostname = outer.address;
  const page = await openPage(address.href);
  await page.waitForSelector('#locked', {state: 'visible'});
  await page.click('#joystick summary');
  await hasText(page, '#joystick-owner', /nobody/);
  await page.focus('#joystick-pad');
  await page.keyboard.down('ArrowUp');
  await hasText(page, '#joystick-said', /^you drive$/);
  await page.keyboard.up('ArrowUp');
  await hasText(page, '#joystick-said', /^stopped$/);
  await page.click('#pause');
  await hasText(page, '#message.error', /press Unlock/);
});

test('lockstep offers a button where a command is the cure', async () => {
  const {daemon, page} = await openClassroom();
  await order(daemon.url, '/simulation', 'set_mode lockstep');
  await page.click('#go-realtime');
  await hasText(page, '#mode', /^realtime$/);
  await page.waitForSelector('#go-realtime', {state: 'hidden'});
});

test('sensors are pictures with a caption, and all numbers are there on demand', async () => {
  const {page} = await openClassroom();
  await hasText(page, '.instrument[data-module="distance"] figcaption', /^distance: nearest \d\.\d\d m$/);
  await hasText(page, '.instrument[data-module="target"] figcaption', /^targets: red \d\.\d\d m$/);
  const painted = await page.evaluate(() => {
    const canvas = document.querySelector('.instrument[data-module="distance"] canvas');
    const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((_, i) => i % 4 === 3).some((alpha) => alpha > 0);
  });
  assert.ok(painted);
  assert.equal(await page.isVisible('.numbers dd'), false);
  await page.click('.numbers > summary');
  await page.waitForSelector('.numbers dd');
});

test('on a phone Stop all stays in sight, and no value of a joint is cut', async () => {
  const {page} = await openScenario(scenario('', 'lwa'));
  await page.setViewportSize({width: 390, height: 844});
  const box = await page.locator('#stop-all').boundingBox();
  assert.ok(box.x >= 0 && box.x + box.width <= 390, JSON.stringify(box));
  await page.waitForSelector('.card[open] .joints tr');
  await page.waitForFunction(() => /→/.test(document.querySelector('.joints .number').textContent));
  const cut = await page.locator('.joints .number, .joints .joint').evaluateAll((cells) => cells.filter((cell) => cell.scrollWidth > cell.clientWidth + 1).map(({textContent}) => textContent));
  assert.deepEqual(cut, []);
});

test('banners stand beside the view, not over it', async () => {
  const {page} = await openClassroom();
  const view = await page.locator('#view-frame').boundingBox();
  await page.selectOption('#set-mode', 'lockstep');
  await hasText(page, '#waiting', /^waiting for robot1/);
  const news = await page.locator('#news').boundingBox();
  assert.ok(news.y >= view.y + view.height, JSON.stringify([news, view]));
  assert.deepEqual(await page.locator('#view-frame').boundingBox(), view, 'nothing moves');
});
