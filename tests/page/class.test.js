// SPDX-License-Identifier: MIT
// The pages of a class: the login, a student's seat, and the teacher's wall.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {TopScene} from '../../server/web/page/top_view.js';
import {languageText} from '../../server/web/page/class_words.js';
import {gridFor} from '../../server/web/page/wall_grid.js';
import {eventually, hasText, newPage, startClass} from './harness.js';
import {seatDaemon} from './seat_daemon.js';

const SEATS = [{seat: 'ana', name: 'Ana Lima', group: '1'}, {seat: 'ben', name: 'Ben Okafor', group: '1'}, {seat: 'cleo', name: 'Cleo Rossi', group: '2'}];
let host, ana, ben, wall;

/** The browser's error about a request that the host refuses, as expected here. */
const refused = (page) => {
  assert.ok(page.mistakes.length > 0 && page.mistakes.every((text) => /status of 403/.test(text)), page.mistakes.join('\n'));
  page.mistakes.length = 0;
};
/** The seats in the order of the wall. */
const order = () => wall.$$eval('.tile:not([hidden])', (tiles) => tiles.map((tile) => tile.dataset.seat));
const tile = (seat) => `.tile[data-seat="${seat}"]`;
/** Selects a tile and presses a button of the panel. */
async function tell(seat, does) {
  if (await wall.isHidden('#panel') || await wall.textContent('#panel h2') !== SEATS.find((one) => one.seat === seat).name) await wall.click(`${tile(seat)} .name`);
  await wall.click(`#panel [data-does="${does}"]`);
}
const has = (page) => page.waitForFunction(() => window.coopdyn && /^[\d.]+ s$/.test(document.getElementById('time').textContent));

before(async () => {
  host = await startClass(SEATS, 'classroom', 'corridor');
  ana = await newPage();
  wall = await newPage();
});

test('a language is called as the program calls it, whatever the word', () => {
  assert.equal(languageText('Python'), 'Python');
  for (const word of ['constructor', '__proto__', 'toString']) assert.equal(languageText(word), word);
});

test('a wrong PIN is refused with words, and the field waits for another', async () => {
  await ana.goto(host.url);
  await ana.fill('#name', 'Ana Lima');
  await ana.fill('#pin', '0000');
  await ana.press('#pin', 'Enter');
  await hasText(ana, '#answer', /^No seat 'ana' with this PIN/);
  assert.equal(await ana.evaluate(() => document.activeElement.id), 'pin');
  refused(ana);
});

test('a PIN with letters can be typed on a phone, whose keyboard is not one of digits alone', async () => {
  assert.equal(await ana.getAttribute('#pin', 'inputmode'), null);
});

test('name and PIN lead to the seat, whose bar says who sits there', async () => {
  await ana.fill('#pin', '7305');
  await ana.click('button');
  await ana.waitForURL('**/s/ana/');
  await has(ana);
  await hasText(ana, '#class-who', /^Ana Lima seat ana · group 1$/);
});

test('the seat of another student leads to the login', async () => {
  const page = await newPage();
  await page.goto(new URL('s/ben/', host.url).href);
  await page.waitForSelector('#login');
  assert.equal(new URL(page.url()).pathname, '/');
  assert.equal(await page.evaluate(async () => (await fetch('/s/ben/class/me')).status), 403);
  refused(page);
});

test('a personal link leads to the seat without a PIN', async () => {
  const [, ...rows] = readFileSync(join(host.folder, 'class.csv'), 'utf8').trim().split('\n');
  const link = rows.find((row) => row.includes('Ben Okafor')).match(/[0-9a-f]{24}/)[0];
  ben = await newPage();
  await ben.goto(new URL(`l/${link}`, host.url).href);
  await ben.waitForURL('**/s/ben/');
  await hasText(ben, '#class-who', /^Ben Okafor/);
  await has(ben);
});

test('a robot of a seat tells how programs connect to it', async () => {
  const port = host.names.split(':').at(-1);
  await ana.waitForFunction((of) => [...document.querySelectorAll('.lines code')].some((line) =>
    line.textContent.includes(`coopdyn.connect("127.0.0.1:${of}", seat="ana", pin="PIN")`)), port);
  const lines = await ana.$$eval('.card[open] .lines code', (codes) => codes.map((code) => code.textContent));
  assert.ok(lines.includes('SEAT ana PIN\nOPEN /robot1/motors'), lines.join('\n'));
});

test('the wall asks for the token, and refuses a wrong one with words', async () => {
  await wall.goto(new URL('wall/', host.url).href);
  await wall.fill('#token', 'x'.repeat(24));
  await wall.press('#token', 'Enter');
  await hasText(wall, '#unlock-answer', /^This is not the teacher's token/);
  refused(wall);
});

test('a token that is added to the address opens the wall, and is taken out of the address', async () => {
  await wall.goto(new URL(`wall/#token=${host.token}`, host.url).href);
  await wall.waitForSelector(tile('cleo'));
  assert.equal(new URL(wall.url()).hash, '');
  assert.equal((await order()).length, 3);
});

test('who was led to the wall on the way to the sheet gets it after the token, with its styles', async () => {
  const page = await newPage();
  await page.goto(new URL('wall/#to=sheet', host.url).href);
  await page.fill('#token', host.token);
  await page.press('#token', 'Enter');
  await page.waitForURL('**/wall/class/sheet');
  assert.equal(await page.$eval('article', (article) => getComputedStyle(article).display), 'flex');
});

test('a seat where nobody has been sleeps, and its tile does not wake it', async () => {
  await hasText(wall, `${tile('cleo')} .state`, /^asleep$/);
  assert.equal(await wall.evaluate(() => window.coopdyn.wall.tiles.get('cleo').feed.received), 0);
});

test('a tile shows the world of a seat that runs', async () => {
  await hasText(wall, `${tile('ana')} .state`, /^running$/);
  await wall.waitForFunction(() => window.coopdyn.wall.tiles.get('ana').drawn > 2);
});

test('the floor of a tile is dark on a dark wall', async () => {
  const brightness = () => wall.$eval(`${tile('ana')} canvas`, (canvas) => {
    const {data} = canvas.getContext('2d').getImageData(canvas.width / 2 + 5, canvas.height / 2 + 5, 1, 1);
    return data[0];
  });
  const light = await brightness();
  assert.ok(light > 150, String(light));
  await wall.emulateMedia({colorScheme: 'dark'});
  await eventually(async () => await brightness() < 120);
  await wall.emulateMedia({colorScheme: null});
  await eventually(async () => await brightness() === light);
});

test('the wall is nobody among the people at the seat', async () => assert.equal(await ana.locator('.person').count(), 0));

test('a socket for poses alone gets no status and no people', async () => {
  const said = await wall.evaluate(() => new Promise((done) => {
    const socket = new WebSocket(new URL('s/ana/ws?only=poses', location.href).href.replace(/^http/, 'ws'));
    const texts = [];
    let poses = 0;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => socket.send(JSON.stringify({type: 'poses', rate: 10}));
    socket.onmessage = ({data}) => {
      if (typeof data === 'string') texts.push(JSON.parse(data).type);
      else if (++poses === 10) { socket.close(); done(texts); }  // one second, in which five statuses would have arrived
    };
  }));
  assert.deepEqual(said, ['hello']);
});

test('the tabs of a seat fit beside each other on a projector', async () => {
  assert.ok(await ana.evaluate(() => document.getElementById('tabs').scrollWidth <= document.getElementById('tabs').clientWidth));
});

test('the task is in sight beside the program, and goes back', async () => {
  await ana.click('#tab-program');
  await ana.waitForSelector('#panel-program > #task-box');
  assert.ok(await ana.isVisible('#task-text'));
  await ana.click('#tab-robots');
  await ana.waitForSelector('#panel-robots > #task-box:first-child');
});

test('a way is not drawn where poses were missed', () => {
  const scene = new TopScene({scene: 1, bodies: 1, things: [], targets: [], floor: {size: [9, 9]}, models: [{radius: 0.2, shapes: []}],
    robots: [{name: 'r', model: 0, body: 0, origin: [0, 0, 0], turn: [0, 0, 0, 1], color: [0, 0, 1]}]});
  const drive = (time_s, x, y, yaw) => {
    scene.time_s = time_s;
    scene.bodies.set([x, y, 0, 0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)]);
    scene.mark(0.05);
  };
  drive(0, 0, 0, 0);
  drive(0.125, 0.1, 0, 0.3);    // drives
  drive(0.25, 0.1, 0.1, 1.9);   // half a turn of a circle in one pause
  drive(2.5, 0.2, 0.1, 1.9);    // a pause
  drive(2.625, 0.2, 0.1, 3.1);  // turns on the spot
  drive(2.75, 0.1, 0.1, 3.1);
  assert.deepEqual(scene.robots[0].trail.map(([, , unknown]) => Boolean(unknown)), [false, false, true, true, false]);
});

test('thirty tiles fit on a projector and on a tablet, three are not stretched over it, and a phone scrolls', () => {
  assert.deepEqual([gridFor(30, 1900, 1010, 9).columns, gridFor(30, 1900, 1010, 9).scrolls], [6, false]);
  assert.equal(gridFor(30, 1002, 620, 9).scrolls, false);
  assert.equal(gridFor(3, 1900, 1010, 9).columns, 2);
  assert.deepEqual([gridFor(30, 370, 600, 9).columns, gridFor(30, 370, 600, 9).scrolls], [1, true]);
});

test('keys alone choose a tile, open its panel and close it', async () => {
  await wall.focus(`${tile('ana')} .name`);
  await wall.keyboard.press('ArrowRight');
  await wall.keyboard.press('Enter');
  await hasText(wall, '#panel h2', /^Ben Okafor$/);
  await wall.keyboard.press('Escape');
  await wall.waitForSelector('#panel', {state: 'hidden'});
  assert.equal(await wall.evaluate(() => document.activeElement.textContent), 'Ben Okafor');
});

test('tiles do not move under the pointer', async () => {
  await ben.click('#class-hand');
  const {x, y} = await wall.locator(tile('ana')).boundingBox();
  let way = 0;
  await eventually(async () => {
    await wall.mouse.move(x + 20 + (++way % 9), y + 20);
    return await wall.getAttribute(tile('ben'), 'data-hand') === 'true';
  });
  assert.deepEqual(await order(), ['ana', 'ben', 'cleo']);
  await wall.mouse.move(1, 1);
  await eventually(async () => (await order())[0] === 'ben');
  await ben.click('#class-hand');
  await eventually(async () => (await order())[0] === 'ana');
  await hasText(ben, '#class-hand', /^Raise hand$/);  // the next click raises it again
});

test('a raised hand comes first', async () => {
  await wall.mouse.move(1, 1);  // the wall keeps its order while the pointer is over the tiles
  assert.deepEqual(await order(), ['ana', 'ben', 'cleo']);
  await ben.click('#class-hand');
  await hasText(ben, '#class-hand', /^Hand is up$/);
  await eventually(async () => (await order())[0] === 'ben');
  await hasText(wall, `${tile('ben')} .why`, /^hand up/);
  const [hand, world] = await Promise.all(['.hand', '.world'].map((part) => wall.locator(`${tile('ben')} ${part}`).boundingBox()));
  assert.ok(hand.width * hand.height < 0.1 * world.width * world.height, 'the hand hides the world');
  await hasText(wall, '#counts', /1 hand up/);
});

test('the teacher lowers it', async () => {
  await tell('ben', 'lower_hand');
  await hasText(ben, '#class-hand', /^Raise hand$/);
});

test('a message stands out until it is read, also after a reload', async () => {
  await wall.click(`${tile('ana')} .name`);
  await wall.fill('#panel textarea', 'Look at <b>line 3');
  await wall.press('#panel textarea', 'Enter');
  await hasText(ana, '#class-news', /Look at <b>line 3/);
  await ana.click('#class-news button');
  await ana.waitForSelector('#class-news', {state: 'hidden'});
  await ana.reload();
  await hasText(ana, '#class-messages', /Look at <b>line 3/);
  assert.ok(await ana.isHidden('#class-news'));
  await has(ana);
});

test('while the teacher drives, the buttons of the student refuse with words', async () => {
  await tell('ana', 'take');
  await hasText(ana, '#class-state', /^The teacher drives now/);
  await ana.click('#pause');
  await hasText(ana, '#message', /the teacher has taken over or frozen this seat/);
  assert.equal(await ana.getAttribute('#state', 'data-state'), 'running');
});

test('given back, they work again', async () => {
  await tell('ana', 'give');
  await ana.waitForSelector('#class-state', {state: 'hidden'});
  await ana.click('#pause');
  await hasText(ana, '#state', /^paused$/);
  await hasText(wall, `${tile('ana')} .state`, /^paused$/);
  await ana.click('#run');
  await hasText(ana, '#state', /^running$/);
});

test('frozen, a world stands still until it is thawed', async () => {
  await tell('ana', 'freeze');
  await hasText(ana, '#class-state', /^Frozen by the teacher/);
  await hasText(ana, '#state', /^paused$/);
  await hasText(wall, `${tile('ana')} .state`, /^frozen$/);
  await tell('ana', 'thaw');
  await hasText(ana, '#state', /^running$/);
});

test('what is for all and cannot be undone asks first, and says whom it meets', async () => {
  await wall.click('#all .menu summary');
  await wall.click('#all [data-does="reset"]');
  await hasText(wall, '#ask', /^Reset: 3 students.*It meets Ana Lima, Ben Okafor and Cleo Rossi\./);
  await wall.keyboard.press('Escape');
  await wall.waitForSelector('#ask', {state: 'hidden'});
  assert.doesNotMatch(await wall.textContent('#message'), /reset/);
});

test('a group alone is shown, and meant by orders for all', async () => {
  await wall.selectOption('#group', '2');
  assert.deepEqual(await order(), ['cleo']);
  await wall.click('#all [data-does="message"]');
  await hasText(wall, '#ask', /^Message: Cleo Rossi/);
  await wall.keyboard.press('Escape');
  await wall.selectOption('#group', '');
  assert.equal((await order()).length, 3);
});

test('an order that the host refuses is told', async () => {
  await wall.evaluate(async () => { window.coopdyn.wall.update({...await (await fetch('class/seats')).json(), lesson: 0}); });
  await wall.route('**/class/do', (route) => route.fulfill({status: 400, body: 'this was the last scenario of the lesson'}));
  await tell('ben', 'reset');
  await hasText(wall, '#message', /^Reset: this was the last scenario of the lesson$/);
  await wall.unrouteAll();
  wall.mistakes.length = 0;
});

test('a scenario that a seat cannot load is told on its tile', async () => {
  await tell('ana', 'push');
  await wall.fill('#ask-text', 'nosuchscenario');
  await wall.click('#ask button[value="go"]');
  await hasText(wall, `${tile('ana')} .why`, /^load_scenario: .*nosuchscenario/);
  await hasText(ana, '#scenario-name', /classroom/);
});

test('the next scenario of the lesson is loaded by all', async () => {
  await wall.click('#next');
  await wall.click('#ask button[value="go"]');
  await hasText(ana, '#scenario-name', /corridor/);
  await hasText(wall, '#lessons [aria-current]', /^corridor$/);
  assert.equal(await wall.locator('#next').count(), 0);
});

test('what is handed in is told, with what was kept', async () => {
  await ana.click('#class-hand-in');
  await hasText(ana, '#class-said', /^Handed in at \d\d:\d\d\. Kept: the recording of your run\./);
  await hasText(ana, '#class-given', /^Handed in: 1/);
});

test('what the host says of hand-ins is on the tile, and in its panel', async () => {
  await wall.evaluate(async () => {
    const said = await (await fetch('class/seats')).json();
    for (const seat of said.seats) seat.handed_in = seat.seat === 'ana' ? 2 : 0;
    window.coopdyn.wall.update(said);
    window.coopdyn.wall.update = () => {};
  });
  assert.equal(await wall.textContent(`${tile('ana')} .given`), 'handed in 2');
  assert.equal(await wall.textContent(`${tile('ben')} .given`), '');
  await wall.click(`${tile('ana')} .name`);
  await hasText(wall, '#panel dl', /Handed in2 ×/);
});

test('the teacher at a seat drives it from its page', async () => {
  await wall.goto(new URL('wall/s/ana/', host.url).href);
  await has(wall);
  await hasText(wall, '#class-who', /^You are at the seat of Ana Lima as the teacher/);
  await wall.click('#class-take');
  await hasText(ana, '#class-state', /^The teacher drives now/);
  await wall.click('#pause');
  await hasText(wall, '#state', /^paused$/);
  await wall.click('#run');
  await hasText(wall, '#class-take', /^Give back$/);
  await wall.click('#class-take');
  await ana.waitForSelector('#class-state', {state: 'hidden'});
});

test('a page connects again after the daemon of its seat was killed, and says what happened', async () => {
  process.kill(seatDaemon(host.folder, 'ana'), 'SIGKILL');
  await hasText(ana, '#class-state', /^Your simulation crashed: it continues at the last recorded moment/);
  await ana.waitForSelector('#lost', {state: 'hidden'});
  await hasText(ana, '#state', /^running$/);
  await ana.click('#class-state button');
  await ana.waitForSelector('#class-state', {state: 'hidden'});
  ana.mistakes.length = 0;  // the browser reports the broken connection
  wall.mistakes.length = 0;
});

test('the wall says for a minute that a simulation crashed, and what comes after that', async () => {
  await wall.goto(new URL('wall/', host.url).href);
  await hasText(wall, `${tile('ana')} .why`, /^its daemon crashed: it continues/);
  const later = await wall.evaluate(() => {
    const {tiles} = window.coopdyn.wall, {seat} = tiles.get('ana');
    const said = (after_ms, more = {}) => {
      tiles.get('ana').update({...seat, why: '', error: '', ...more}, performance.now() + after_ms);
      return tiles.get('ana').why;
    };
    return [said(30000), said(61000), said(62000, {error: 'load_scenario: no file'}), said(63000, {daemon: 'starting'})];
  });
  assert.deepEqual(later, ['its daemon crashed: it continues at the last recorded moment', '', 'load_scenario: no file',
    'its daemon crashed: it continues at the last recorded moment']);
});

test('an open page leaves a seat that was put aside so, until its student goes on', async () => {
  await wall.goto(new URL('wall/', host.url).href);
  await tell('ben', 'aside');
  await hasText(wall, `${tile('ben')} .state`, /^asleep$/);
  await hasText(ben, '#class-state', /^Your simulation was put aside/);
  assert.ok(await ben.isHidden('#lost'));
  await ben.click('#class-state button');
  await hasText(ben, '#state', /^running$/);
  await hasText(wall, `${tile('ben')} .state`, /^running$/);
});
