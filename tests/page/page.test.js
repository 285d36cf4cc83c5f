// SPDX-License-Identifier: MIT
// The page's display of a run and its robots, in a real browser with a real daemon.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {join} from 'node:path';
import {afterEach, beforeEach, describe, test} from 'node:test';
import {
  call, endAll, eventually, hasText, moreStatuses, newFolder, newPage, nextPicture, openClassroom, openConsole, openPage,
  picture, startDaemon, startDaemonIn,
} from './harness.js';

const WEBGL = {webgl: true};
// For daemons that restart: a port that no other program is given meanwhile.
const PORT = String(20000 + process.pid % 10000);
let daemon, page;

afterEach(endAll);

async function sendLine(module, line) {
  await openConsole(page);
  await page.selectOption('#console-module', module);
  await page.fill('#console-line', line);
  await page.press('#console-line', 'Enter');
  const reply = page.locator('#console-log > .reply').last();
  await page.waitForFunction(() => document.querySelector('#console-log')?.lastElementChild?.classList.contains('reply'));
  return reply.textContent();
}

/** Position of the robot in the first open card. */
async function position() {
  await page.waitForSelector('.card[open] .readings dd');
  return page.locator('.card[open] .readings dd').first().textContent();
}

test('a robot whose motors are called legs: its readings, and the console begins with them', async () => {
  const folder = newFolder();
  const make = new URL('../clients/python/legs.py', import.meta.url).pathname;
  execFileSync('python3', [make, folder]);
  daemon = await startDaemonIn({COOPDYN_PATH: folder}, join(folder, 'legs.scenario'));
  page = await openPage(daemon.url);
  await page.waitForFunction(() => [...document.querySelectorAll('.card[open] .readings dt')]
    .map((row) => row.textContent).join(' ').includes('wheels'));
  await page.waitForFunction(() => document.querySelector('#console-module').value === '/robot1/legs');
});

describe('the page and its view', () => {
  beforeEach(async () => { ({daemon, page} = await openClassroom(WEBGL)); });

  test('shows the world, the robots and how the run stands', async () => {
    await nextPicture(page);
    await hasText(page, '#state', /^running$/);
    await hasText(page, '#mode', /^realtime$/);
    await hasText(page, '#rtf', /^× \d/);
    await hasText(page, '.card[data-robot="robot1"]', /\/robot1\/motors/);
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
    await hasText(page, '.card .owner', /^page /);
  });

  test('dragging, moving and the wheel change the picture of a world that stands still', async () => {
    await page.click('#pause');
    await hasText(page, '#state', /^paused$/);
    // The picture that replaces `before`, once no more arrive: some may have been on their way.
    const settled = async (before) => {
      await eventually(async () => (await picture(page)) !== before);
      let last;
      do {
        last = await picture(page);
        await moreStatuses(page, 2);
      } while ((await picture(page)) !== last);
      return last;
    };
    await page.waitForSelector('#view');
    const box = await page.locator('#view').boundingBox();
    const centre = [box.x + box.width / 2, box.y + box.height / 2];
    const drag = async (button, dx, dy) => {
      await page.mouse.move(...centre);
      await page.mouse.down({button});
      await page.mouse.move(centre[0] + dx, centre[1] + dy, {steps: 4});
      await page.mouse.up({button});
    };
    const first = await settled(null);
    await drag('left', 120, 30);
    const turned = await settled(first);
    await drag('right', 80, 0);
    const moved = await settled(turned);
    await page.mouse.wheel(0, -400);
    const zoomed = await settled(moved);
    await page.click('#whole');
    await settled(zoomed);
  });

  test('a world that stands still is not drawn again', async () => {
    await page.click('#pause');
    await hasText(page, '#state', /^paused$/);
    const {step} = await daemon.status();
    await page.waitForFunction((last) => document.getElementById('view').dataset.step === String(last), step);
    const shown = () => page.evaluate(() => document.getElementById('view').dataset.shown);
    // The last pictures show the way to its final position.
    await eventually(async () => {
      const before = await shown();
      await moreStatuses(page, 10);  // two seconds
      return await shown() === before;
    });
  });

  test('everything can be reached by keyboard', async () => {
    await openConsole(page);
    await page.click('#show > summary');
    await page.focus('#theme');
    const reached = new Set();
    for (let i = 0; i < 70; ++i) {
      reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.tagName));
      await page.keyboard.press('Tab');
    }
    for (const id of ['run', 'pause', 'reset', 'stop-all', 'view', 'rays', 'console-line', 'theme', 'splitter', 'tab-robots', 'set-mode', 'load', 'upload']) {
      assert.ok(reached.has(id), `${id} not among ${[...reached].join(' ')}`);
    }
  });
});

describe('the page', () => {
  beforeEach(async () => { ({daemon, page} = await openClassroom()); });

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
    await hasText(page, '#console-hint', /set_velocity/);
    await page.keyboard.type('set_v');
    await page.keyboard.press('Tab');
    assert.equal(await page.inputValue('#console-line'), 'set_velocity ');
    await hasText(page, '#console-hint', /linear.*angular/);
  });

  test('without a status for two seconds the page says "no answer"', async () => {
    await hasText(page, '#state', /^running$/);
    daemon.process.kill('SIGSTOP');
    try {
      await hasText(page, '#state', /^no answer$/);
    } finally {
      daemon.process.kill('SIGCONT');
    }
    await hasText(page, '#state', /^running$/);
  });

  test('nothing in the strip and the toolbar moves while the run changes', async () => {
    const places = () => page.evaluate(() =>
      Object.fromEntries([...document.querySelectorAll('.strip-row > span:not(:empty), .toolbar > *, #view')]
        .filter((element) => !['recording', 'playback', 'scenario-name'].includes(element.id))
        .map((element) => [element.id, ['x', 'y', 'width', 'height'].map((key) => element.getBoundingClientRect()[key]).join(' ')])));
    await hasText(page, '#rtf', /^× \d/);
    const first = await places();
    const changes = [['#pause', () => hasText(page, '#state', /^paused$/)], ['#run', () => hasText(page, '#state', /^running$/)]];
    for (const [button, done] of changes) {
      await page.click(button);
      await done();
      assert.deepEqual(await places(), first, button);
    }
    for (const [mode, state] of [['lockstep', /^waiting$/], ['free', /^running$/], ['realtime', /^running$/]]) {
      await page.selectOption('#set-mode', mode);
      await hasText(page, '#mode', new RegExp(`^${mode}$`));
      await hasText(page, '#state', state);
      assert.deepEqual(await places(), first, mode);
    }
  });

  test('a seed of four digits is whole in its field', async () => {
    await page.fill('#seed', '4444');
    for (const width of [1024, 1280]) {
      await page.setViewportSize({width, height: 800});
      const [wanted, given] = await page.locator('#seed').evaluate((field) => [field.scrollWidth, field.clientWidth]);
      assert.ok(wanted <= given, `${wanted} of ${given} at ${width}`);
    }
  });

  test('the picture takes at least half of the window', async () => {
    for (const [width, height] of [[1024, 768], [1280, 720], [1920, 1080]]) {
      await page.setViewportSize({width, height});
      await page.waitForSelector('#view');
      const box = await page.locator('#view').boundingBox();
      assert.ok(box.width * box.height >= 0.5 * width * height, `${box.width} x ${box.height} of ${width} x ${height}`);
    }
  });

  test('a card that was closed stays closed, whatever closed it', async () => {
    await page.waitForSelector('.card[open] .readings dd');
    await page.evaluate(() => { document.querySelector('.card').open = false; });
    /** The greatest number of open cards while the page received this number of statuses. */
    const opened = (statuses) => page.evaluate((more) => new Promise((done) => {
      let left = more, seen = 0;
      window.coopdyn.connection.addEventListener('status', () => {
        seen = Math.max(seen, document.querySelectorAll('.card[open]').length);
        if (--left === 0) done(seen);
      });
    }), statuses);
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
    const connections = async () => (await daemon.status()).clients.filter(({module}) => module.startsWith('/robot1/')).length;
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
    await eventually(async () => (await connections()) === 0);
  });

  test('more robots than a status lists are not asked for again and again', async () => {
    const swarm = '[FLOOR]\nsize 40 40 0.1\n[SWARM_1]\ntype minibot\ncount 300\nname bot\n';
    let fetched = 0;
    page.on('request', (request) => { fetched += request.url().endsWith('/api/modules') ? 1 : 0; });
    assert.equal((await call(daemon.url, {module: '/simulation', command: 'load_scenario', text: swarm})).error, 0);
    await hasText(page, '#robot-count', /^300$/);
    await page.waitForFunction(() => [...document.querySelectorAll('#console-module option')].some(({value}) => value === '/bot_300/motors'));
    const earlier = fetched;
    await moreStatuses(page, 10);
    assert.equal(fetched, earlier);
  });

  test('a robot can be freed', async () => {
    await page.waitForSelector('#console-module option[value="/robot1/motors"]', {state: 'attached'});
    await sendLine('/robot1/motors', 'set_velocity 0.1 0');
    await hasText(page, '.card .owner', /^page /);
    await page.click('.card summary button');
    await hasText(page, '.card .owner', /^nobody drives it/);
    await hasText(page, '#console-log', /closed: /);
  });

  test('a page that is closed frees its robots', async () => {
    const other = await openPage(daemon.url, WEBGL);
    await other.waitForSelector('#console-module option[value="/robot1/motors"]', {state: 'attached'});
    await openConsole(other);
    await other.selectOption('#console-module', '/robot1/motors');
    await other.fill('#console-line', 'claim');
    await other.press('#console-line', 'Enter');
    await hasText(page, '.card .owner', /^page /);
    await other.close();
    await hasText(page, '.card .owner', /^nobody drives it/);
  });

  test('each robot has its connection lines with the address that the browser used', async () => {
    const card = page.locator('.card[data-robot="robot1"]');
    if (!(await card.evaluate((element) => element.open))) await card.locator('summary').click();
    const port = daemon.names.split(':').at(-1);
    let lines;
    await eventually(async () => {
      lines = await card.locator('.lines code').allTextContents();
      return lines.includes(`sim = coopdyn.connect("127.0.0.1:${port}");\nr = sim.robot("robot1");`);
    });
    assert.ok(lines.some((line) => /^telnet 127\.0\.0\.1 \d+$/.test(line)), lines.join('\n'));
    for (const file of ['matlab.zip', 'coopdyn.py']) {
      const response = await fetch(new URL(file, daemon.url));
      assert.equal(response.status, 200, file);
      assert.ok((await response.arrayBuffer()).byteLength > 1000, file);
    }
  });
});

test('twenty robots are listed, and the page stays quick', async () => {
  daemon = await startDaemon('arena20');
  page = await openPage(daemon.url, WEBGL);
  await page.waitForFunction(() => document.querySelectorAll('.card').length === 20);
  await page.locator('.card summary strong').nth(19).click();
  await page.waitForFunction(() => document.querySelectorAll('.card')[19].querySelectorAll('.readings dd').length > 3);
  const moved = nextPicture(page);
  await page.focus('#view');
  await page.keyboard.press('ArrowLeft');
  await moved;
});

test('a daemon that has gone is noticed, and found again', async () => {
  daemon = await startDaemon('classroom', '--no-render', '--http-port', PORT);
  page = await openPage(daemon.url);
  await daemon.stop();
  await page.waitForSelector('#lost', {state: 'visible'});
  daemon = await startDaemon('classroom', '--no-render', '--http-port', PORT);
  await page.waitForSelector('#lost', {state: 'hidden'});
  await hasText(page, '#state', /^running$/);
  await page.close();
});

test('a daemon that comes back with another scenario: the view shows its world, though scenes are numbered as before', async () => {
  daemon = await startDaemon('classroom', '--no-render', '--http-port', PORT);
  page = await openPage(daemon.url, WEBGL);
  const shows = (name) => page.evaluate((which) => Boolean(window.coopdyn?.view?.scene?.find(which)), name);
  await eventually(() => shows('CYLINDER_1'));
  await daemon.stop();
  daemon = await startDaemon('corridor', '--http-port', PORT);
  await eventually(async () => await shows('BOX_2') && !await shows('CYLINDER_1'));
  await page.close();
});

/** A page of the classroom whose status of the robot is overridden by `robot`. The caller closes it, because the route stays. */
async function openWithRobot(robot) {
  daemon = await startDaemon('classroom');
  page = await newPage();
  await page.routeWebSocket(/\/ws$/, (socket) => {
    const server = socket.connectToServer();
    server.onMessage((message) => {
      const status = typeof message === 'string' ? JSON.parse(message) : {};
      if (status.type !== 'status') return socket.send(message);
      Object.assign(status.status.robots[0], robot);
      socket.send(JSON.stringify(status));
    });
  });
  await page.goto(daemon.url);
}

test('a robot that moves without anybody who drives it says so, in at most two lines', async () => {
  const robot = {still_moving: true};
  await openWithRobot(robot);
  await hasText(page, '.card .owner', /^nobody drives it, still moving$/);
  const lines = await page.locator('.card .owner').evaluate((owner) => {
    const text = document.createRange();
    text.selectNodeContents(owner);
    return text.getClientRects().length;
  });
  robot.still_moving = false;
  await hasText(page, '.card .owner', /^nobody drives it$/);
  assert.ok(lines <= 2, `${lines} lines`);
  await page.close();
});

test('a silent client is shown beside its robot, and what the watchdog did', async () => {
  const robot = {owner: 'ana', silent_s: 12.7};
  await openWithRobot(robot);
  await hasText(page, '.card .owner', /^ana, silent for 12 s$/);
  robot.watchdog_stopped = true;
  await hasText(page, '.card .owner.warning', /^ana, silent for 12 s, stopped until its next command$/);
  await page.close();
});

test('the API answers scripts', async () => {
  daemon = await startDaemon('classroom');
  const reply = await call(daemon.url, {id: 1, module: '/robot1/pose', command: 'get_pose'});
  assert.equal(reply.error, 0);
  assert.equal(reply.data.length, 7);
});
