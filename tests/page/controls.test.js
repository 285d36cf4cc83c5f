// SPDX-License-Identifier: MIT
// The run, its time, its scenario and its lockstep, changed on the page as by a user.
import assert from 'node:assert/strict';
import {afterEach, beforeEach, test} from 'node:test';
import {call, endAll, enterNumber, eventually, hasText, moreStatuses, openClassroom, openModule} from './harness.js';

let daemon;
let page;


beforeEach(async () => { ({daemon, page} = await openClassroom()); });
afterEach(endAll);

test('run, pause, step and reset do what they say', async () => {
  await page.click('#pause');
  await hasText(page, '#state', /^paused$/);
  const {step} = await daemon.status();
  await page.fill('#step-count', '7');
  await page.click('#step');
  await eventually(async () => (await daemon.status()).step === step + 7);
  await page.fill('#seed', '42');
  await page.click('#reset');
  await hasText(page, '#time', /^0\.00 s$/);
  assert.equal((await daemon.status()).seed, 42);
  await page.click('#run');
  await hasText(page, '#state', /^running$/);
});

test('another scenario can be chosen', async () => {
  await page.waitForSelector('#scenarios option[value="formation"]', {state: 'attached'});
  await page.selectOption('#scenarios', 'formation');
  await page.click('#load');
  await hasText(page, '#scenario-name', /^formation$/);
  await page.waitForFunction(() => document.querySelectorAll('.card').length === 5);
  await page.waitForFunction(() => [...document.querySelectorAll('#console-module option')]
    .some((option) => option.value === '/robot5/motors'));
  await call(daemon.url, {module: '/simulation', command: 'load_scenario', text: 'classroom'});
  await page.waitForFunction(() => document.getElementById('scenarios').value === 'classroom');
});

test('an uploaded scenario with mistakes shows them by line and changes nothing', async () => {
  const text = '[WORLD]\nfile empty\n\n[ROBOT_1]\ntype single\nname ana\nposition 0 zero\ncolr red\n';
  await page.setInputFiles('#upload', {name: 'mine.scenario', mimeType: 'text/plain', buffer: Buffer.from(text)});
  await page.waitForSelector('#diagnostics li');
  const entries = await page.locator('#diagnostics li').allTextContents();
  assert.ok(entries.some((entry) => /^line 7: .*position 0 zero$/.test(entry)), entries.join('\n'));
  assert.ok(entries.some((entry) => /^line 8: .*colr red$/.test(entry)), entries.join('\n'));
  assert.equal((await daemon.status()).scenario, 'classroom');
});

test('many errors in an uploaded scenario leave the robots in sight', async () => {
  const text = '[ROBOT_1]\n' + 'colr red\n'.repeat(60);
  await page.setInputFiles('#upload', {name: 'mine.scenario', mimeType: 'text/plain', buffer: Buffer.from(text)});
  await page.waitForFunction(() => document.querySelectorAll('#diagnostics li').length > 50);
  const card = await page.locator('.card').first().boundingBox();
  assert.ok(card.y < 768, `the first card is at ${card.y}`);
});

test('an uploaded scenario is run', async () => {
  const text = '[ROBOT_1]\ntype single\nname ana\nposition 0 0\n[ROBOT_2]\ntype single\nname bo\nposition 1 1\n';
  await page.setInputFiles('#upload', {name: 'mine.scenario', mimeType: 'text/plain', buffer: Buffer.from(text)});
  await hasText(page, '#message', /^loaded mine\.scenario$/);
  await page.waitForSelector('.card[data-robot="ana"]');
  await page.waitForSelector('.card[data-robot="bo"]');
  await page.waitForSelector('.card[data-robot="robot1"]', {state: 'detached'});
  await hasText(page, '#scenario-name', /^mine$/);
  assert.equal((await daemon.status()).scenario, 'mine');
});

test('lockstep says whom it waits for', async () => {
  await page.selectOption('#set-mode', 'lockstep');
  await hasText(page, '#waiting', /^waiting for robot1 \(no client\), \d+\.\d s$/);
  await hasText(page, '#state', /^waiting$/);
  await page.selectOption('#set-mode', 'realtime');
  await hasText(page, '#state', /^running$/);
  assert.equal(await page.textContent('#waiting'), '');
});

test('lockstep says how to go on without a robot that has no client', async () => {
  await page.selectOption('#set-mode', 'lockstep');
  await hasText(page, '#cure', /^start its program, or set_mode realtime$/);
  await page.selectOption('#set-mode', 'realtime');
  await hasText(page, '#cure', /^$/);
});

test('lockstep that advances is shown as running', async () => {
  const client = await openModule(daemon.names, '/robot1/motors');
  let replies = 0, longest_ms = 0, last = Infinity;
  client.on('data', (data) => {
    replies += String(data).split('\n').length - 1;
    longest_ms = Math.max(longest_ms, performance.now() - last);
    last = performance.now();
    client.write('set_velocity 0.1 0\n');
  });
  await page.selectOption('#set-mode', 'lockstep');
  await hasText(page, '#waiting', /^waiting for robot1/);
  const height = await page.locator('#strip').evaluate((strip) => strip.offsetHeight);
  client.write('set_velocity 0.1 0\n');
  await hasText(page, '#state', /^running$/);
  longest_ms = 0;
  await page.evaluate(() => {
    globalThis.waits = 0;
    new MutationObserver(() => { globalThis.waits += document.getElementById('waiting').textContent ? 1 : 0; })
      .observe(document.getElementById('strip'), {childList: true, subtree: true, characterData: true});
  });
  const earlier = replies;
  await moreStatuses(page, 10);
  assert.ok(replies > earlier);
  // On a busy machine the client itself may have let the world wait.
  if (longest_ms < 400) assert.equal(await page.evaluate(() => globalThis.waits), 0);
  assert.equal(await page.textContent('#mode'), 'lockstep');
  assert.equal(await page.locator('#strip').evaluate((strip) => strip.offsetHeight), height);
  client.destroy();
});

test('time and scenario are in sight', async () => {
  for (const [width, height] of [[1024, 768], [1440, 900]]) {
    await page.setViewportSize({width, height});
    for (const id of ['set-mode', 'set-step', 'set-speed', 'scenarios', 'load']) {
      const box = await page.locator(`#${id}`).boundingBox();
      assert.ok(box.y >= 0 && box.y + box.height <= height, `${id} at ${width} x ${height}`);
    }
  }
});

test('only connected robots take part, if one wants', async () => {
  await call(daemon.url, {module: '/simulation', command: 'load_scenario', text: 'formation'});
  await call(daemon.url, {module: '/simulation', line: 'set_mode lockstep'});
  await hasText(page, '#waiting', /robot1, robot2, robot3, robot4 and 1 more \(no client\)/);
  await page.click('#only-connected');
  await hasText(page, '#message', /connect one first/);
  const client = await openModule(daemon.names, '/robot3/motors');
  client.write('claim\n');
  await page.waitForFunction(() =>
    !document.querySelector('.card[data-robot="robot3"] .owner').textContent.startsWith('nobody'));
  await page.click('#only-connected');
  await hasText(page, '#waiting', /^waiting for robot3 \(/);
  await page.waitForSelector('#go-on', {state: 'hidden'});
  await page.click('#all-participants');
  await hasText(page, '#waiting', /robot1/);
  await page.click('#go-on');
  await hasText(page, '#waiting', /^waiting for robot3 \(/);
  client.destroy();
});

test('step size and speed are set', async () => {
  await enterNumber(page, '#set-step', '20');
  await enterNumber(page, '#set-speed', '2');
  const {step_s, speed} = await daemon.status();
  assert.deepEqual([step_s, speed], [0.02, 2]);
  await page.fill('#set-step', '500');
  await page.press('#set-step', 'Enter');
  await hasText(page, '#message', /^step size: a step lasts 0\.5 to 100 ms, not 500 ms$/);
  await page.fill('#set-step', '');
  await page.press('#set-step', 'Enter');
  await page.waitForFunction(() => document.getElementById('set-step').value === '20');
});

test('a wrong number for the speed is refused, in red, and changes nothing', async () => {
  await enterNumber(page, '#set-speed', '2');
  for (const wrong of ['-1', '1e', '0', '--']) {
    await page.fill('#set-speed', '');
    await page.focus('#set-speed');
    await page.keyboard.type(wrong);
    await page.press('#set-speed', 'Enter');
    await hasText(page, '#message.error', /^speed: write a number above 0/);
    assert.equal(await page.getAttribute('#set-speed', 'aria-invalid'), 'true', wrong);
    assert.equal((await daemon.status()).speed, 2, wrong);
  }
  await page.fill('#set-speed', '');
  await page.press('#set-speed', 'Tab');
  await page.waitForFunction(() => document.getElementById('set-speed').value === '2');
  assert.equal(await page.getAttribute('#set-speed', 'aria-invalid'), null);
  await page.click('#no-limit');
  await eventually(async () => (await daemon.status()).speed === null);
});

test('a refused number gives way to what holds when its field is left', async () => {
  await enterNumber(page, '#set-speed', '2');
  for (const [id, wrong, key, holds] of [['set-speed', '0', 'Enter', '2'], ['set-speed', '-1', 'Tab', '2'], ['set-step', '500', 'Enter', '10']]) {
    await page.fill(`#${id}`, wrong);
    await page.press(`#${id}`, key);
    await hasText(page, '#message.error', /^(speed|step size): /);
    await page.locator(`#${id}`).blur();
    await page.waitForFunction(([field, value]) => document.getElementById(field).value === value, [id, holds]);
    assert.equal(await page.getAttribute(`#${id}`, 'aria-invalid'), null, id);
    assert.notEqual(await page.textContent('#message'), '', id);
  }
});

test('a refused seed goes when its field is left', async () => {
  await page.fill('#seed', '-1');
  await page.click('#reset');
  await hasText(page, '#message.error', /^seed must be /);
  assert.equal(await page.getAttribute('#seed', 'aria-invalid'), 'true');
  await page.press('#seed', 'Tab');
  assert.equal(await page.inputValue('#seed'), '');
  assert.equal(await page.getAttribute('#seed', 'aria-invalid'), null);
});

test('a seed or a number of steps that cannot be is not sent', async () => {
  await page.fill('#seed', '2147483648');
  await page.click('#reset');
  await hasText(page, '#message', /^seed must be a whole number up to 2147483647$/);
  await page.click('#pause');
  await hasText(page, '#state', /^paused$/);
  const {step} = await daemon.status();
  assert.ok(step > 0);
  await page.fill('#step-count', '0');
  await page.click('#step');
  assert.equal(await page.inputValue('#step-count'), '1');
  await eventually(async () => (await daemon.status()).step === step + 1);
});
