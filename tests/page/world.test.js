// SPDX-License-Identifier: MIT
// The panel World: objects are inserted, moved, changed and removed by mouse, form and keys.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {before, beforeEach, test} from 'node:test';
import {call, eventually, loadAnew, openPage, openScenario, order} from './harness.js';

const SCENARIO = `[SIMULATION]
mode realtime
[FLOOR]
size 10 10 0.1
[BOX_1]
type box
size 0.6 0.6 0.6
position 2 1
color red
[WALL_1]
type box
size 4 0.2 0.5
position 0 -3
[TARGET]
green -2 0 0.3
[ROBOT_1]
type coopbot
position -1 0
`;

const WEBGL = {webgl: true};
let daemon, page;

before(async () => {
  ({daemon, page} = await openScenario(SCENARIO, WEBGL));
  await page.waitForFunction(() => window.coopdyn.handles);
  await page.click('#tab-world');
});
beforeEach(async () => {
  await loadAnew(daemon, page, SCENARIO);
  await order(daemon.url, '/simulation', 'pause');
  await page.evaluate(() => window.coopdyn.view.select(null));
  await page.waitForSelector('#things button:has-text("BOX_1")');
  await page.click('#view-tools button:has-text("top")');
});

const world = async () => JSON.parse((await call(daemon.url, {module: '/world', line: 'list'})).text);
const thing = async (name) => {
  const {things, robots, targets} = await world();
  return [...things, ...robots, ...targets].find((one) => one.name === name);
};
/** The point of the window that shows a point of the world. */
const windowAt = (x, y, z = 0) => page.evaluate(([px, py, pz]) => {
  const {view} = window.coopdyn;
  view.renderNow();
  const p = view.camera.position.clone().set(px, py, pz).project(view.camera);
  const box = view.canvas.getBoundingClientRect();
  return [box.left + (p.x + 1) / 2 * box.width, box.top + (1 - p.y) / 2 * box.height];
}, [x, y, z]);
const select = (name) => page.click(`#things button:has-text("${name}")`);
const field = (label) => page.locator(`#thing input[name="${label}"]`);
async function change(label, value) {
  await field(label).fill(value);
  await field(label).press('Enter');
}

test('the list shows colours as the view does', async () => {
  const swatch = await page.$eval('#things button:has-text("BOX_1") .swatch', (element) => getComputedStyle(element).backgroundColor);
  assert.equal(swatch, 'rgb(189, 51, 48)');  // 0.74, 0.20, 0.19 of palette.js
});

test('a click on the palette inserts a box that is selected then, and undo and redo by key', async () => {
  await page.click('#palette button:has-text("Box")');
  await eventually(async () => (await thing('BOX_2')) !== undefined);
  await page.waitForFunction(() => window.coopdyn.view.selected?.name === 'BOX_2');
  await page.focus('#view');
  await page.keyboard.press('Control+z');
  await eventually(async () => (await thing('BOX_2')) === undefined);
  await page.keyboard.press('Control+y');
  await eventually(async () => (await thing('BOX_2')) !== undefined);
});

test('a box is dragged from the palette to a place of the floor', async () => {
  const [x, y] = await windowAt(-3, 3);
  await page.evaluate(([clientX, clientY]) => {
    const dataTransfer = new DataTransfer();
    const fire = (element, type, more) => element.dispatchEvent(new DragEvent(type, {bubbles: true, cancelable: true, dataTransfer, ...more}));
    fire(document.querySelector('#palette [data-kind="box"]'), 'dragstart');
    const frame = document.getElementById('view-frame');
    if (fire(frame, 'dragover', {clientX, clientY})) throw new Error('the view takes nothing');
    fire(frame, 'drop', {clientX, clientY});
  }, [x, y]);
  await eventually(async () => (await thing('BOX_2')) !== undefined);
  const [px, py] = (await thing('BOX_2')).position;
  assert.ok(Math.hypot(px + 3, py - 3) < 0.15, `${px} ${py}`);
});

test('what would overlap is refused with what it meets, and stays where it was', async () => {
  await select('robot1');
  const {position} = await thing('robot1');
  await change('y m', '-3');
  await page.waitForFunction(() => /inside WALL_1/.test(document.getElementById('message').textContent));
  assert.deepEqual((await thing('robot1')).position, position);
});

test('the form resizes, recolours, weighs, turns and renames', async () => {
  await select('BOX_1');
  await change('size m', '1 0.5 0.4');
  await eventually(async () => (await thing('BOX_1')).size[0] === 1);
  await change('mass kg', '3');
  await eventually(async () => (await thing('BOX_1')).mass === 3);
  await field('color').evaluate((input) => { input.value = '#00ff00'; input.dispatchEvent(new Event('change')); });
  await eventually(async () => (await thing('BOX_1')).color[1] === 1);
  await change('turn °', '90');
  await eventually(async () => Math.abs((await thing('BOX_1')).quaternion[3] - Math.SQRT1_2) < 1e-4);
  await change('name', 'crate');
  await eventually(async () => (await thing('crate')) !== undefined);
});

test('a target is removed by key, a thing is duplicated', async () => {
  await select('green_target_1');
  await page.focus('#view');
  await page.keyboard.press('Delete');
  await eventually(async () => (await world()).targets.length === 0);
  await select('BOX_1');
  await page.click('#thing button:has-text("Duplicate")');
  await eventually(async () => (await thing('BOX_2'))?.size[0] === 0.6);
});

test('an inserted robot is driven from the console', async () => {
  await page.click('#palette button:has-text("Robot")');
  await eventually(async () => (await thing('robot2')) !== undefined);
  await page.waitForSelector('#console-module option[value="/robot2/motors"]', {state: 'attached'});
  await page.click('#console-box summary');
  await page.selectOption('#console-module', '/robot2/motors');
  await page.fill('#console-line', 'set_velocity 0.3 0');
  await page.press('#console-line', 'Enter');
  await page.click('#run');
  const from = (await thing('robot2')).position[0];
  await eventually(async () => Math.abs((await thing('robot2')).position[0] - from) > 0.05);
});

test('the saved file loads to the same hash', async () => {
  await order(daemon.url, '/simulation', 'reset');
  await page.click('#palette button:has-text("Cylinder")');
  await eventually(async () => (await world()).things.length === 3);
  const {hash} = await daemon.status();
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('button:has-text("Save as file")')]);
  const text = readFileSync(await download.path(), 'utf-8');
  assert.equal((await call(daemon.url, {module: '/simulation', command: 'load_scenario', text})).text, '');
  assert.equal((await daemon.status()).hash, hash);
});

test('an arrow is dragged with the mouse, and moves what is selected', async () => {
  await select('BOX_1');
  await page.waitForFunction(() => window.coopdyn.view.selected?.name === 'BOX_1');
  await page.click('#whole');
  const before = (await thing('BOX_1')).position;
  // The position of the handles' x arrow: a point where the handles react to the pointer.
  const at = await page.evaluate(() => {
    const {view} = window.coopdyn, {camera} = view;
    view.renderNow();  // makes the arrows' positions up to date
    const box = view.canvas.getBoundingClientRect(), [p] = view.scene.pose(view.selected);
    const onScreen = (point) => {
      const q = point.clone().project(view.camera);
      return [box.left + (q.x + 1) / 2 * box.width, box.top + (1 - q.y) / 2 * box.height];
    };
    // TransformControls draws its arrows at a fixed size on the screen; this is 0.7 of their length.
    const away = p.distanceTo(camera.position), tip = p.clone();
    tip.x += 0.7 * 0.45 * away * Math.min(1.9 * Math.tan(Math.PI * camera.fov / 360), 7) / 4;
    return {from: onScreen(tip), to: onScreen(tip.clone().setX(tip.x + 1))};
  });
  await page.mouse.move(...at.from);
  await page.mouse.move(at.from[0] + 1, at.from[1]);
  await page.mouse.down();
  for (let i = 1; i <= 8; ++i) await page.mouse.move(at.from[0] + i / 8 * (at.to[0] - at.from[0]), at.from[1] + i / 8 * (at.to[1] - at.from[1]));
  await page.mouse.up();
  await eventually(async () => Math.abs((await thing('BOX_1')).position[0] - before[0]) > 0.5);
  assert.equal((await thing('BOX_1')).position[1], before[1], 'along x alone');
  await page.keyboard.press('Control+z');
  await eventually(async () => (await thing('BOX_1')).position[0] === before[0]);
  await select('BOX_1');
});

test('two browsers see each other\'s edits', async () => {
  const other = await openPage(daemon.url, WEBGL);
  await other.waitForFunction(() => window.coopdyn?.view.scene);
  await page.click('#palette button:has-text("Ball")');
  await other.waitForFunction(() => window.coopdyn.view.scene.find('SPHERE_1'));
  await other.waitForSelector('#things button:has-text("SPHERE_1")', {state: 'attached'});
  await other.close();
});

test('nothing went wrong meanwhile', async () => {
  await select('robot1');
  await select('robot1');
  assert.deepEqual(page.mistakes, []);
});
