// SPDX-License-Identifier: MIT
// The page as a person uses it, in a real browser against a real daemon.
import assert from 'node:assert/strict';
import {after, afterEach, before, beforeEach, describe, test} from 'node:test';
import {call, eventually, launchBrowser, moreStatuses, nextPicture, openConsole, openModule, openPage, picture, startDaemon} from './harness.js';

let browser;
let daemon;
let page;

before(async () => { browser = await launchBrowser(); });
after(async () => { await browser?.close(); });

/** Waits until the text of `selector` matches. */
const hasText = (selector, pattern) => page.waitForFunction(
  ([where, source]) => new RegExp(source).test(document.querySelector(where)?.textContent ?? ''),
  [selector, pattern.source]);

async function sendLine(module, line) {
  await openConsole(page);
  await page.selectOption('#console-module', module);
  await page.fill('#console-line', line);
  await page.press('#console-line', 'Enter');
  const reply = page.locator('#console-log > .reply').last();
  await page.waitForFunction(() => document.querySelector('#console-log')?.lastElementChild?.classList.contains('reply'));
  return reply.textContent();
}

const status = async () => (await fetch(new URL('api/status', daemon.url))).json();

/** Position of the robot in the first open card. */
async function position() {
  await page.waitForSelector('.card[open] .readings dd');
  return page.locator('.card[open] .readings dd').first().textContent();
}

describe('the page', () => {
  beforeEach(async () => {
    daemon = await startDaemon('classroom');
    page = await openPage(browser, daemon.url);
  });
  afterEach(async () => {
    assert.deepEqual(page.mistakes, []);
    await page.close();
    await daemon.stop();
  });

  test('shows the world, the robots and how the run stands', async () => {
    await nextPicture(page);
    await hasText('#state', /^running$/);
    await hasText('#mode', /^realtime$/);
    await hasText('#rtf', /^× \d/);
    await hasText('.card[data-robot="robot1"]', /\/robot1\/motors/);
    assert.match(await position(), /^−?\d+\.\d\d, −?\d+\.\d\d m$/);
  });

  test('a command by console drives the robot, and the picture and the readings follow', async () => {
    await page.waitForSelector('#console-module option[value="/robot1/motors"]', {state: 'attached'});
    const before = await position();
    const earlier = await nextPicture(page);
    assert.match(await sendLine('/robot1/motors', 'set_velocity 0.4 0'), /^0 "" 11 /);
    await page.waitForFunction(
      (was) => document.querySelector('.card[open] .readings dd').textContent !== was, before);
    assert.notEqual(await nextPicture(page), earlier);
    await hasText('.card .owner', /^page /);
  });

  test('a wrong command is answered with what to write instead', async () => {
    await page.waitForSelector('#console-module option[value="/robot1/motors"]', {state: 'attached'});
    assert.match(await sendLine('/robot1/motors', 'set_velocity 0,4 0'), /write 0\.4/);
    assert.match(await sendLine('/robot1/motors', 'set_velocty 1 0'), /set_velocity/);
  });

  test('Tab completes a command and the hint explains it', async () => {
    await page.waitForSelector('#console-module option[value="/robot1/motors"]', {state: 'attached'});
    await openConsole(page);
    await page.selectOption('#console-module', '/robot1/motors');
    await page.focus('#console-line');
    await hasText('#console-hint', /set_velocity/);
    await page.keyboard.type('set_v');
    await page.keyboard.press('Tab');
    assert.equal(await page.inputValue('#console-line'), 'set_velocity ');
    await hasText('#console-hint', /linear.*angular/);
  });

  test('run, pause, step and reset do what they say', async () => {
    await page.click('#pause');
    await hasText('#state', /^paused$/);
    const {step} = await status();
    await page.fill('#step-count', '7');
    await page.click('#step');
    await eventually(async () => (await status()).step === step + 7);
    await page.fill('#seed', '42');
    await page.click('#reset');
    await hasText('#time', /^0\.00 s$/);
    assert.equal((await status()).seed, 42);
    await page.click('#run');
    await hasText('#state', /^running$/);
  });

  test('dragging, moving and the wheel change the picture of a world that stands still', async () => {
    await page.click('#pause');
    await hasText('#state', /^paused$/);
    await nextPicture(page).catch(() => {});
    const box = await page.locator('#view').boundingBox();
    const centre = [box.x + box.width / 2, box.y + box.height / 2];
    const drag = async (button, dx, dy) => {
      await page.mouse.move(...centre);
      await page.mouse.down({button});
      const moved = nextPicture(page);
      await page.mouse.move(centre[0] + dx, centre[1] + dy, {steps: 4});
      await page.mouse.up({button});
      return moved;
    };
    const first = await picture(page);
    const turned = await drag('left', 120, 30);
    assert.notEqual(turned, first);
    const moved = await drag('right', 80, 0);
    assert.notEqual(moved, turned);
    const zooming = nextPicture(page);
    await page.mouse.wheel(0, -400);
    assert.notEqual(await zooming, moved);
    const back = nextPicture(page);
    await page.click('#whole');
    await back;
  });

  test('a world that stands still is not drawn again', async () => {
    await page.click('#pause');
    await hasText('#state', /^paused$/);
    const {step} = await status();
    await page.waitForFunction((last) => document.getElementById('view').dataset.step === String(last), step);
    const shown = () => page.evaluate(() => Number(document.getElementById('view').dataset.shown));
    const before = await shown();
    const later = page.statuses + 10;  // two seconds
    await eventually(async () => (await shown()) >= 0 && page.statuses >= later);
    assert.ok((await shown()) - before <= 1);
  });

  test('another scenario can be chosen', async () => {
    await page.waitForSelector('#scenarios option[value="formation"]', {state: 'attached'});
    await page.selectOption('#scenarios', 'formation');
    await page.click('#load');
    await hasText('#scenario-name', /^formation$/);
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
    assert.equal((await status()).scenario, 'classroom');
  });

  test('an uploaded scenario is run', async () => {
    const text = '[ROBOT_1]\ntype single\nname ana\nposition 0 0\n[ROBOT_2]\ntype single\nname bo\nposition 1 1\n';
    await page.setInputFiles('#upload', {name: 'mine.scenario', mimeType: 'text/plain', buffer: Buffer.from(text)});
    await page.waitForSelector('.card[data-robot="ana"]');
    await page.waitForSelector('.card[data-robot="bo"]');
    await page.waitForSelector('.card[data-robot="robot1"]', {state: 'detached'});
    await hasText('#scenario-name', /^mine$/);
    await hasText('#message', /^loaded mine\.scenario$/);
    assert.equal((await status()).scenario, 'mine');
  });

  test('lockstep says whom it waits for', async () => {
    await page.selectOption('#set-mode', 'lockstep');
    await hasText('#waiting', /^waiting for robot1 \(no client\), \d+\.\d s$/);
    await hasText('#state', /^waiting$/);
    await page.selectOption('#set-mode', 'realtime');
    await hasText('#state', /^running$/);
    assert.equal(await page.textContent('#waiting'), '');
  });

  test('lockstep that advances is shown as running', async () => {
    const client = await openModule(daemon.names, '/robot1/motors');
    let replies = 0;
    client.on('data', (data) => {
      replies += String(data).split('\n').length - 1;
      client.write('set_velocity 0.1 0\n');
    });
    await page.selectOption('#set-mode', 'lockstep');
    await hasText('#waiting', /^waiting for robot1/);
    const height = await page.locator('#strip').evaluate((strip) => strip.offsetHeight);
    client.write('set_velocity 0.1 0\n');
    await hasText('#state', /^running$/);
    await page.evaluate(() => {
      globalThis.waits = 0;
      new MutationObserver(() => { globalThis.waits += document.getElementById('waiting').textContent ? 1 : 0; })
        .observe(document.getElementById('strip'), {childList: true, subtree: true, characterData: true});
    });
    const later = page.statuses + 10;
    const earlier = replies;
    const waits = () => page.evaluate(() => globalThis.waits);
    await eventually(async () => (await waits()) >= 0 && page.statuses >= later && replies > earlier);
    assert.equal(await waits(), 0);
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
    await hasText('#waiting', /robot1, robot2, robot3, robot4 and 1 more \(no client\)/);
    await page.click('#only-connected');
    await hasText('#message', /connect one first/);
    const client = await openModule(daemon.names, '/robot3/motors');
    client.write('claim\n');
    await page.waitForFunction(() =>
      !document.querySelector('.card[data-robot="robot3"] .owner').textContent.startsWith('nobody'));
    await page.click('#only-connected');
    await hasText('#waiting', /^waiting for robot3 \(/);
    await page.waitForSelector('#go-on', {state: 'hidden'});
    await page.click('#all-participants');
    await hasText('#waiting', /robot1/);
    await page.click('#go-on');
    await hasText('#waiting', /^waiting for robot3 \(/);
    client.destroy();
  });

  test('step size and speed are set', async () => {
    await page.fill('#set-step', '20');
    await page.press('#set-step', 'Enter');
    await page.fill('#set-speed', '2');
    await page.press('#set-speed', 'Enter');
    await eventually(async () => {
      const {step_s, speed} = await status();
      return step_s === 0.02 && speed === 2;
    });
    await page.fill('#set-step', '500');
    await page.press('#set-step', 'Enter');
    await hasText('#message', /^step size: a step lasts 0\.5 to 100 ms, not 500 ms$/);
    await page.fill('#set-step', '');
    await page.press('#set-step', 'Enter');
    await page.waitForFunction(() => document.getElementById('set-step').value === '20');
  });

  test('a wrong number for the speed is refused, in red, and changes nothing', async () => {
    await page.fill('#set-speed', '2');
    await page.press('#set-speed', 'Enter');
    await eventually(async () => (await status()).speed === 2);
    for (const wrong of ['-1', '1e', '0', '--']) {
      await page.fill('#set-speed', '');
      await page.focus('#set-speed');
      await page.keyboard.type(wrong);
      await page.press('#set-speed', 'Enter');
      await hasText('#message.error', /^speed: write a number above 0/);
      assert.equal(await page.getAttribute('#set-speed', 'aria-invalid'), 'true', wrong);
      assert.equal((await status()).speed, 2, wrong);
    }
    await page.fill('#set-speed', '');
    await page.press('#set-speed', 'Tab');
    await page.waitForFunction(() => document.getElementById('set-speed').value === '2');
    assert.equal(await page.getAttribute('#set-speed', 'aria-invalid'), null);
    await page.click('#no-limit');
    await eventually(async () => (await status()).speed === null);
  });

  test('without a status for two seconds the page says "no answer"', async () => {
    await hasText('#state', /^running$/);
    daemon.process.kill('SIGSTOP');
    try {
      await hasText('#state', /^no answer$/);
    } finally {
      daemon.process.kill('SIGCONT');
    }
    await hasText('#state', /^running$/);
  });

  test('nothing in the strip and the toolbar moves while the run changes', async () => {
    const places = () => page.evaluate(() =>
      Object.fromEntries([...document.querySelectorAll('.strip-row > span:not(:empty), .toolbar > *, #view')]
        .filter((element) => !['recording', 'playback', 'scenario-name'].includes(element.id))
        .map((element) => [element.id, ['x', 'y', 'width', 'height'].map((key) => element.getBoundingClientRect()[key]).join(' ')])));
    await hasText('#rtf', /^× \d/);
    const first = await places();
    const changes = [['#pause', () => hasText('#state', /^paused$/)], ['#run', () => hasText('#state', /^running$/)]];
    for (const [button, done] of changes) {
      await page.click(button);
      await done();
      assert.deepEqual(await places(), first, button);
    }
    for (const [mode, state] of [['lockstep', /^waiting$/], ['free', /^running$/], ['realtime', /^running$/]]) {
      await page.selectOption('#set-mode', mode);
      await hasText('#mode', new RegExp(`^${mode}$`));
      await hasText('#state', state);
      assert.deepEqual(await places(), first, mode);
    }
  });

  test('the picture takes at least half of the window', async () => {
    for (const [width, height] of [[1024, 768], [1280, 720], [1920, 1080]]) {
      await page.setViewportSize({width, height});
      const box = await page.locator('#view').boundingBox();
      assert.ok(box.width * box.height >= 0.5 * width * height, `${box.width} x ${box.height} of ${width} x ${height}`);
    }
  });

  test('a card that was closed stays closed, whatever closed it', async () => {
    await page.waitForSelector('.card[open] .readings dd');
    await page.evaluate(() => { document.querySelector('.card').open = false; });
    const opened = async (statuses) => {
      const later = page.statuses + statuses;
      let seen = 0;
      await eventually(async () => {
        seen = Math.max(seen, await page.locator('.card[open]').count());
        return page.statuses >= later;
      });
      return seen;
    };
    assert.equal(await opened(5), 0);
    await call(daemon.url, {module: '/simulation', command: 'load_scenario', text: 'formation'});
    await page.waitForSelector('.card[data-robot="robot5"]');
    await call(daemon.url, {module: '/simulation', command: 'load_scenario', text: 'classroom'});
    await page.waitForSelector('.card[data-robot="robot5"]', {state: 'detached'});
    assert.equal(await opened(5), 0);
  });

  test('a card that is closed before its readings have come keeps no connection', async () => {
    await page.waitForSelector('.card[open] .readings dd');
    const card = page.locator('.card[data-robot="robot1"]');
    await card.locator('summary strong').click();
    const connections = async () => (await status()).clients.filter(({module}) => module.startsWith('/robot1/')).length;
    await eventually(async () => (await connections()) === 0);
    await page.evaluate(() => {
      const send = WebSocket.prototype.send;
      WebSocket.prototype.send = function sendAndClose(data) {
        send.call(this, data);
        if (String(data).includes('get_targets')) document.querySelector('.card').open = false;
      };
    });
    await card.locator('summary strong').click();
    await page.waitForFunction(() => !document.querySelector('.card').open);
    await moreStatuses(page, 5);
    assert.equal(await connections(), 0);
  });

  test('more robots than a status lists are not asked for again and again', async () => {
    const swarm = '[FLOOR]\nsize 40 40 0.1\n[SWARM_1]\ntype minibot\ncount 300\nname bot\n';
    let fetched = 0;
    page.on('request', (request) => { fetched += request.url().endsWith('/api/modules') ? 1 : 0; });
    assert.equal((await call(daemon.url, {module: '/simulation', command: 'load_scenario', text: swarm})).error, 0);
    await hasText('#robot-count', /^300 \(first 256 listed\)$/);
    await page.waitForFunction(() => [...document.querySelectorAll('#console-module option')].some(({value}) => value === '/bot_300/motors'));
    const earlier = fetched;
    await moreStatuses(page, 25);  // five seconds
    assert.equal(fetched, earlier);
  });

  test('a seed or a number of steps that cannot be is not sent', async () => {
    await page.fill('#seed', '2147483648');
    await page.click('#reset');
    await hasText('#message', /^seed must be a whole number up to 2147483647$/);
    await page.click('#pause');
    await hasText('#state', /^paused$/);
    const {step} = await status();
    assert.ok(step > 0);
    await page.fill('#step-count', '0');
    await page.click('#step');
    assert.equal(await page.inputValue('#step-count'), '1');
    await eventually(async () => (await status()).step === step + 1);
  });

  test('a robot can be freed', async () => {
    await page.waitForSelector('#console-module option[value="/robot1/motors"]', {state: 'attached'});
    await sendLine('/robot1/motors', 'set_velocity 0.1 0');
    await hasText('.card .owner', /^page /);
    await page.click('.card summary button');
    await hasText('.card .owner', /^nobody drives it/);
    await hasText('#console-log', /closed: /);
  });

  test('a page that is closed frees its robots', async () => {
    const other = await openPage(browser, daemon.url);
    await other.waitForSelector('#console-module option[value="/robot1/motors"]', {state: 'attached'});
    await openConsole(other);
    await other.selectOption('#console-module', '/robot1/motors');
    await other.fill('#console-line', 'claim');
    await other.press('#console-line', 'Enter');
    await hasText('.card .owner', /^page /);
    await other.close();
    await hasText('.card .owner', /^nobody drives it/);
  });

  test('each robot has its connection lines with the address that the browser used', async () => {
    const card = page.locator('.card[data-robot="robot1"]');
    if (!(await card.evaluate((element) => element.open))) await card.locator('summary').click();
    await card.locator('.lines code').first().waitFor();
    const lines = await card.locator('.lines code').allTextContents();
    const port = daemon.names.split(':').at(-1);
    assert.ok(lines.includes(`sim = coopdyn.connect("127.0.0.1:${port}");\nr = sim.robot("robot1");`), lines.join('\n'));
    assert.ok(lines.some((line) => /^telnet 127\.0\.0\.1 \d+$/.test(line)), lines.join('\n'));
    for (const file of ['matlab.zip', 'coopdyn.py']) {
      const response = await fetch(new URL(file, daemon.url));
      assert.equal(response.status, 200, file);
      assert.ok((await response.arrayBuffer()).byteLength > 1000, file);
    }
  });

  test('everything can be reached by keyboard', async () => {
    await openConsole(page);
    await page.focus('#run');
    const reached = new Set();
    for (let i = 0; i < 60; ++i) {
      reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.tagName));
      await page.keyboard.press('Tab');
    }
    for (const id of ['run', 'pause', 'reset', 'stop-all', 'view', 'rays', 'console-line', 'set-mode', 'load', 'upload']) {
      assert.ok(reached.has(id), `${id} not among ${[...reached].join(' ')}`);
    }
  });
});

test('twenty robots are listed, and the page stays quick', async () => {
  daemon = await startDaemon('arena20');
  page = await openPage(browser, daemon.url);
  await page.waitForFunction(() => document.querySelectorAll('.card').length === 20);
  await page.locator('.card summary strong').nth(19).click();
  await page.waitForFunction(() => document.querySelectorAll('.card')[19].querySelectorAll('.readings dd').length > 3);
  const moved = nextPicture(page);
  await page.focus('#view');
  await page.keyboard.press('ArrowLeft');
  await moved;
  assert.deepEqual(page.mistakes, []);
  await page.close();
  await daemon.stop();
});

test('a daemon that has gone is noticed, and found again', async () => {
  daemon = await startDaemon('classroom');
  page = await openPage(browser, daemon.url);
  const port = new URL(daemon.url).port;
  await daemon.stop();
  await page.waitForSelector('#lost', {state: 'visible'});
  daemon = await startDaemon('classroom', '--http-port', port);
  await page.waitForSelector('#lost', {state: 'hidden'});
  await hasText('#state', /^running$/);
  await page.close();
  await daemon.stop();
});

test('a robot that moves without anybody who drives it says so', async () => {
  daemon = await startDaemon('classroom');
  page = await browser.newPage();
  let moving = true;
  await page.routeWebSocket(/\/ws$/, (socket) => {
    const server = socket.connectToServer();
    server.onMessage((message) => {
      const status = typeof message === 'string' ? JSON.parse(message) : {};
      if (status.type !== 'status') return socket.send(message);
      status.status.robots[0].still_moving = moving;
      socket.send(JSON.stringify(status));
    });
  });
  await page.goto(daemon.url);
  await hasText('.card .owner', /^nobody drives it, still moving$/);
  moving = false;
  await hasText('.card .owner', /^nobody drives it$/);
  await page.close();
  await daemon.stop();
});

test('the API answers scripts', async () => {
  daemon = await startDaemon('classroom');
  const reply = await call(daemon.url, {id: 1, module: '/robot1/pose', command: 'get_pose'});
  assert.equal(reply.error, 0);
  assert.equal(reply.data.length, 7);
  await daemon.stop();
});
