// SPDX-License-Identifier: MIT
// The panel Drive: mouse, touch and keys drive a robot, which stops on release.
import assert from 'node:assert/strict';
import {afterEach, beforeEach, test} from 'node:test';
import {call, endAll, eventually, hasText, openClassroom, openModule, openPage} from './harness.js';

let daemon, page;

beforeEach(async () => {
  ({daemon, page} = await openClassroom());
  await page.click('#joystick > summary');
  await hasText(page, '#joystick label .number', /^\d\.\d\d m\/s, \d\.\d rad\/s$/);
});
afterEach(endAll);

const speeds = async () => (await call(daemon.url, {module: '/robot1/pose', line: 'get_pose'})).data.slice(3, 5);
const moves = () => eventually(async () => Math.abs((await speeds())[0]) > 0.05);
const stands = () => eventually(async () => (await speeds()).every((speed) => Math.abs(speed) < 1e-3));
const owner = async () => (await daemon.status()).robots[0].owner;
const free = () => eventually(async () => (await owner()) === null);

/** Presses the pad at a point: x to the right, y up, from −1 to 1. */
async function press(x, y) {
  const box = await page.locator('#joystick-pad').boundingBox();
  const at = (u, v) => [box.x + box.width * (1 + u) / 2, box.y + box.height * (1 - v) / 2];
  await page.mouse.move(...at(0, 0));
  await page.mouse.down();
  await page.mouse.move(...at(x, y), {steps: 3});
}

test('the pad drives ahead while it is pulled, and lets go of the robot after', async () => {
  await press(0, 0.9);
  await moves();
  assert.match(await owner(), /^joystick-/);
  await hasText(page, '#joystick-owner', /^driven by joystick-/);
  assert.ok((await speeds())[0] > 0);
  await page.mouse.up();
  await stands();
  await free();
});

test('a pad that is held still says that somebody is there', async () => {
  await press(0, 0.9);
  await moves();
  const silent = async () => (await daemon.status()).robots[0].silent_s;
  await eventually(async () => await silent() > 0.3);
  await eventually(async () => await silent() < 0.2);
  await page.mouse.up();
});

test('pulled to the left the robot turns left', async () => {
  await press(-0.9, 0);
  await eventually(async () => (await speeds())[1] > 0.2);
  await page.mouse.up();
  await stands();
});

test('keys drive while they are held', async () => {
  await page.focus('#joystick-pad');
  await page.keyboard.down('ArrowDown');
  await eventually(async () => (await speeds())[0] < -0.05);
  await page.keyboard.up('ArrowDown');
  await stands();
  await page.keyboard.down('w');
  await page.keyboard.down('d');
  await eventually(async () => (await speeds())[0] > 0.05 && (await speeds())[1] < -0.1);
  await page.keyboard.up('d');
  await eventually(async () => Math.abs((await speeds())[1]) < 1e-3);
  await page.keyboard.up('w');
  await stands();
});

test('the robot stops when the pad loses the focus with a key held', async () => {
  await page.focus('#joystick-pad');
  await page.keyboard.down('ArrowUp');
  await moves();
  await page.focus('#joystick-robot');
  await stands();
  await free();
  await page.keyboard.up('ArrowUp');
});

test('the robot stops when the page is hidden', async () => {
  await page.focus('#joystick-pad');
  await page.keyboard.down('ArrowUp');
  await moves();
  await page.evaluate(() => {
    Object.defineProperty(document, 'hidden', {value: true, configurable: true});
    document.dispatchEvent(new Event('visibilitychange'));
  });
  await stands();
  await page.keyboard.up('ArrowUp');
});

test('the robot stops when the page is closed', async () => {
  const second = await openPage(daemon.url);
  await second.waitForFunction(() => document.querySelectorAll('#joystick-robot option').length > 0);
  await second.click('#joystick > summary');
  await second.waitForFunction(() => /m\/s/.test(document.querySelector('#joystick label .number').textContent));
  await second.focus('#joystick-pad');
  await second.keyboard.down('ArrowUp');
  await moves();
  await second.close();
  await stands();
  await free();
});

test('who drives already is said, and the robot is left alone', async () => {
  const client = await openModule(daemon.names, '/robot1/motors');
  client.write('hello ana\nclaim\n');
  await hasText(page, '#joystick-owner', /^driven by ana$/);
  await press(0, 0.9);
  await hasText(page, '#joystick-said.error', /^robot1 is driven by ana: /);
  await page.mouse.up();
  assert.equal(await owner(), 'ana');
  client.destroy();
});

test('at most twenty commands a second are sent, and the newest wins', async () => {
  await page.evaluate(() => {
    globalThis.sent = [];
    // The time that the page itself reads for a command: a later reading may be late by any time.
    let read = 0;
    const now = performance.now.bind(performance);
    performance.now = () => (read = now());
    const {connection} = window.coopdyn;
    const send = connection.send.bind(connection);
    connection.send = (message) => {
      if (message.command === 'set_velocity') globalThis.sent.push({time: read, data: message.data});
      send(message);
    };
  });
  const box = await page.locator('#joystick-pad').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2, box.y + 1, {steps: 150});
  await eventually(async () => {
    const last = await page.evaluate(() => globalThis.sent.at(-1)?.data[0] ?? 0);
    return last > 0.9 * await page.evaluate(() => parseFloat(document.querySelector('#joystick label .number').textContent));
  });
  await page.mouse.up();
  const times = await page.evaluate(() => globalThis.sent.map(({time}) => time));
  for (let i = 1; i < times.length; ++i) assert.ok(times[i] - times[i - 1] > 49.9, `${times[i] - times[i - 1]} ms apart`);
});

test('a gamepad drives with its left stick', async () => {
  await page.evaluate(() => {
    globalThis.stick = [0, 0];
    navigator.getGamepads = () => [{id: 'test pad', axes: globalThis.stick}];
    const event = new Event('gamepadconnected');
    event.gamepad = {id: 'test pad'};
    dispatchEvent(event);
  });
  await hasText(page, '#joystick-gamepad', /^gamepad: test pad/);
  await page.evaluate(() => { globalThis.stick = [0.05, -1]; });
  await moves();
  assert.ok(Math.abs((await speeds())[1]) < 1e-3, 'the dead zone holds');
  await page.evaluate(() => { globalThis.stick = [0, 0]; });
  await stands();
});

test('a finger drives as the mouse does', async () => {
  const pad = page.locator('#joystick-pad');
  const {x, y, width} = await pad.boundingBox();
  const touch = (type, dy) => pad.dispatchEvent(type, {pointerId: 7, pointerType: 'touch', isPrimary: true, bubbles: true,
    clientX: x + width / 2, clientY: y + width / 2 - dy});
  await page.evaluate(() => { document.getElementById('joystick-pad').setPointerCapture = () => {}; });
  await touch('pointerdown', 0);
  await touch('pointermove', width / 2);
  await moves();
  await touch('pointerup', width / 2);
  await stands();
});

test('who lets go before the first answer has come stops the robot too', async () => {
  await page.evaluate(() => {
    const pad = document.getElementById('joystick-pad'), {x, y, width} = pad.getBoundingClientRect();
    pad.setPointerCapture = () => {};
    const touch = (type, dy) => pad.dispatchEvent(new PointerEvent(type, {pointerId: 7, bubbles: true,
      clientX: x + width / 2, clientY: y + width / 2 - dy}));
    touch('pointerdown', 0);
    touch('pointermove', width / 2);
    touch('pointerup', width / 2);
  });
  await hasText(page, '#joystick-said', /^stopped$/);
  await stands();
  await free();
});
