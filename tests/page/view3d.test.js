// SPDX-License-Identifier: MIT
// The view drawn by the page itself: objects, motion, clicks, and its substitute without WebGL.
import assert from 'node:assert/strict';
import {before, beforeEach, test} from 'node:test';
import {Interpolator} from '../../server/web/page/poses.js';
import {eventually, loadAnew, openPage, openScenario, order} from './harness.js';

const SCENARIO = `[SIMULATION]
mode realtime
[FLOOR]
size 10 10 0.1
[BOX_1]
type box
size 1 1 1
position 2 1
color red
mass 5
[TARGET]
green -2 0 0.3
[ROBOT_1]
type coopbot
position -1 0
[ROBOT_2]
type humanoid
position 0 -3
`;

let daemon, page;

before(async () => { ({daemon, page} = await openScenario(SCENARIO, {webgl: true})); });
beforeEach(async () => {
  await loadAnew(daemon, page, SCENARIO);
  await order(daemon.url, '/simulation', 'run');
});

/** The position of a thing in the view: x, y, z. */
const placeOf = (name) => page.evaluate((which) => {
  const {scene} = window.coopdyn.view;
  return scene.pose(scene.find(which))[0].toArray();
}, name);
const near = (a, b, far = 0.002) => a.every((x, i) => Math.abs(x - b[i]) < far);

test('things, robots and targets stand where the daemon has them', async () => {
  await eventually(async () => near(await placeOf('BOX_1'), [2, 1, 0.5]));
  await eventually(async () => near(await placeOf('green_target_1'), [-2, 0, 0.3]));
  await eventually(async () => near(await placeOf('robot1'), [-1, 0, 0], 0.01));
});

test('a robot that drives moves in the view', async () => {
  const from = (await placeOf('robot1'))[0];
  await order(daemon.url, '/robot1/motors', 'set_velocity 0.4 0');
  await eventually(async () => (await placeOf('robot1'))[0] > from + 0.2);
});

test('a robot that has stopped is shown where it stands', async () => {
  await order(daemon.url, '/robot1/motors', 'set_velocity 0.4 0');
  const pose = async () => (await order(daemon.url, '/robot1/pose', 'get_pose')).data;
  await eventually(async () => (await pose())[3] > 0.3);
  await order(daemon.url, '/simulation', 'pause');
  const [x, y] = await pose();
  await eventually(async () => near((await placeOf('robot1')).slice(0, 2), [x, y], 0.001));
});

test('what others insert, move and remove is seen', async () => {
  const edit = (line) => order(daemon.url, '/world', line);
  await edit('insert [CRATE_1] type box | size 0.4 0.4 0.4 | position 3 3');
  await page.waitForFunction(() => window.coopdyn.view.scene.find('CRATE_1'));
  await edit('set_pose CRATE_1 -3 3 0.2 0');
  await eventually(async () => near(await placeOf('CRATE_1'), [-3, 3, 0.2]));
  await edit('remove CRATE_1');
  await page.waitForFunction(() => !window.coopdyn.view.scene.find('CRATE_1'));
});

test('a click selects what is there', async () => {
  await page.click('button:has-text("top")');
  const at = await page.evaluate(() => {
    const {view} = window.coopdyn;
    view.renderNow();
    const p = view.scene.pose(view.scene.find('BOX_1'))[0].project(view.camera);
    const box = view.canvas.getBoundingClientRect();
    return [box.left + (p.x + 1) / 2 * box.width, box.top + (1 - p.y) / 2 * box.height];
  });
  await page.mouse.click(...at);
  await page.waitForFunction(() => window.coopdyn.view.selected?.name === 'BOX_1');
});

/** Where the points that enclose the scene are in the picture, from -1 to 1, and how far down the tools reach up. */
const outlineInPicture = () => page.evaluate(() => {
  const {scene, camera, canvas} = window.coopdyn.view;
  const box = canvas.getBoundingClientRect(), tools = document.getElementById('view-tools').getBoundingClientRect();
  return {points: scene.outline().map((p) => { const {x, y} = p.project(camera); return [x, y]; }), tools: 2 * (box.bottom - tools.top) / box.height - 1};
});

test('a fit shows all of every robot and thing, above the tools', async () => {
  for (const size of [{width: 1024, height: 768}, {width: 390, height: 844}]) {
    await page.setViewportSize(size);
    for (const press of ['Home', 't', '1', '2']) {
      await page.focus('#view');
      await page.keyboard.press(press);
      const {points, tools} = await outlineInPicture();
      const edges = [0, 1].map((axis) => points.map((p) => p[axis])).map((all) => [Math.min(...all), Math.max(...all)]);
      assert.ok(Math.max(...edges.flat().map(Math.abs)) < 0.96 && edges[1][0] > tools, `${press}: ${JSON.stringify(edges)}, tools ${tools}`);
      assert.ok(Math.max(edges[0][1] - edges[0][0], edges[1][1] - edges[1][0]) > 0.9, `${press}: it fills the picture: ${JSON.stringify(edges)}`);
    }
  }
  await page.setViewportSize({width: 1024, height: 768});
});

test('named views look from above, the front and the side', async () => {
  const from = () => page.evaluate(() => {
    const {camera, controls} = window.coopdyn.view;
    return camera.position.clone().sub(controls.target).normalize().toArray();
  });
  await page.click('#view-tools button:has-text("top")');
  assert.ok((await from())[2] > 0.99);
  for (const [name, axis, sign] of [['front', 0, 1], ['side', 1, -1]]) {
    await page.click('#looks > summary');
    await page.click(`#looks-list button:has-text("${name}")`);
    assert.ok(sign * (await from())[axis] > 0.9, name);
  }
});

test('behind a robot, the camera turns with it', async () => {
  const ahead = () => page.evaluate(() => {
    const {scene, camera, controls} = window.coopdyn.view, [, q] = scene.pose(scene.find('robot1'));
    const way = controls.target.clone().sub(camera.position).setZ(0).normalize();
    return {ahead: way.dot(way.clone().set(1, 0, 0).applyQuaternion(q)), yaw: 2 * Math.atan2(q.z, q.w)};
  });
  await page.focus('#view');
  await page.keyboard.press('3');
  assert.ok((await ahead()).ahead > 0.99);
  await order(daemon.url, '/robot1/motors', 'set_velocity 0 1');
  await eventually(async () => Math.abs((await ahead()).yaw) > 1);
  await eventually(async () => (await ahead()).ahead > 0.95);
  await page.keyboard.press('Escape');
});

test('the camera flies to a view, unless motion is to be reduced', async () => {
  const press = (key) => page.evaluate((pressed) => {
    const {view} = window.coopdyn;
    view.canvas.dispatchEvent(new KeyboardEvent('keydown', {key: pressed}));
    return view.flies;
  }, key);
  assert.equal(await press('Home'), false);
  await page.emulateMedia({reducedMotion: 'no-preference'});
  assert.equal(await press('t'), true);
  await page.waitForFunction(() => !window.coopdyn.view.flies);
  assert.ok(await page.evaluate(() => window.coopdyn.view.camera.position.z > 5));
  await page.emulateMedia({reducedMotion: 'reduce'});
});

test('words of colours are shown calmly, other colours as written', async () => {
  await order(daemon.url, '/world', 'insert [PLAIN_1] type box | size 0.4 0.4 0.4 | position 3 3 | color 0.3 0.5 0.7');
  await page.waitForFunction(() => window.coopdyn.view.scene.find('PLAIN_1'));
  const shown = (name) => page.evaluate((which) => {
    const {color} = window.coopdyn.view.scene.find(which).object.material;
    return color.clone().convertLinearToSRGB().toArray();
  }, name);
  assert.ok(near(await shown('PLAIN_1'), [0.3, 0.5, 0.7]));
  const [r, g, b] = await shown('BOX_1');
  assert.ok(r > 0.6 && r < 0.9 && g > 0.1 && b > 0.1 && r > 2 * Math.max(g, b), `${[r, g, b]}`);
});

test('poses that are as before move nothing', () => {
  const still = {write: (poses) => poses.set([1, 2, 3, 0, 0, 0, 1])}, moved = {write: (poses) => poses.set([1, 2.5, 3, 0, 0, 0, 1])};
  const between = new Interpolator();
  between.reset(1);
  between.push(still, 1000);
  assert.equal(between.push(still, 1033), false);
  assert.equal(between.moves(1034), false);
  assert.equal(between.push(moved, 1066), true);
  assert.equal(between.moves(1067), true);
});

test('meshes come, and nothing is asked of other hosts', async () => {
  const hosts = new Set();
  page.on('request', (request) => { if (!request.url().startsWith('data:')) hosts.add(new URL(request.url()).host); });
  await page.reload();
  await page.waitForFunction(() => window.coopdyn?.view.framesDrawn > 1);
  assert.deepEqual([...hosts], [new URL(daemon.url).host]);
  assert.deepEqual(page.mistakes, []);
});

const SQUARE = `v -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nmtllib square.mtl\nusemtl picture\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n`;
const CARPET = `<sdf version="1.9"><model name="carpet"><link name="body"><inertial><mass>1</mass></inertial>
<collision name="c"><geometry><box><size>1 1 0.02</size></box></geometry></collision>
<visual name="v"><pose>0 0 0.02 0 0 0</pose><geometry><mesh><uri>square.obj</uri></mesh></geometry></visual></link></model></sdf>`;
// 2 x 2 pixels: red, green; below them blue, white.
const PICTURE = Buffer.from('iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFUlEQVR4nGO4w8DAcAKIGe48e/YMABsWBTMkorh9AAAAAElFTkSuQmCC', 'base64');

test('a texture lies on its mesh the right way up', async () => {
  const other = await openScenario('[SIMULATION]\nmode realtime\n[ROBOT_1]\ntype carpet\nname rug\nposition 0 0\n', {webgl: true,
    files: {'robots/carpet/model.sdf': CARPET, 'robots/carpet/square.obj': SQUARE, 'robots/carpet/square.mtl': 'newmtl picture\nKd 1 1 1\nmap_Kd picture.png\n',
      'robots/carpet/picture.png': PICTURE}});
  await other.page.waitForFunction(() => window.coopdyn?.view.scene);
  const colorAt = (x, y) => other.page.evaluate(([left, ahead]) => {
    const {view} = window.coopdyn;
    view.fit('top');
    view.renderNow();
    const gl = view.canvas.getContext('webgl2'), p = view.scene.pose(view.scene.find('rug'))[0];
    p.set(p.x + left, p.y + ahead, 0.02).project(view.camera);
    const pixel = new Uint8Array(4);
    gl.readPixels(Math.round((p.x + 1) / 2 * gl.drawingBufferWidth), Math.round((p.y + 1) / 2 * gl.drawingBufferHeight), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return [...pixel];
  }, [x, y]);
  const most = ([r, g, b]) => (Math.min(r, g, b) > 120 ? 'white' : r > g + 60 && r > b + 60 ? 'red' : g > r + 60 && g > b + 60 ? 'green' : b > r + 60 ? 'blue' : '');
  for (const [x, y, color] of [[-0.25, 0.25, 'red'], [0.25, 0.25, 'green'], [-0.25, -0.25, 'blue'], [0.25, -0.25, 'white']]) {
    await eventually(async () => most(await colorAt(x, y)) === color);
  }
});

test('without WebGL the daemon draws', async () => {
  const other = await openPage(daemon.url);
  await other.waitForFunction(() => Number(document.getElementById('view').dataset.shown ?? 0) > 0);
  assert.equal(await other.evaluate(() => Boolean(window.coopdyn.view.scene)), false);
});

test('the scenario says where the view begins', async () => {
  const {page: placed} = await openScenario(`${SCENARIO}[VIEW]\neye 3 -2 2\nlook 0 0 0.2\n`, {webgl: true});
  await placed.waitForFunction(() => window.coopdyn.view.scene);
  const seen = await placed.evaluate(() => [window.coopdyn.view.camera.position.toArray(), window.coopdyn.view.controls.target.toArray()]);
  assert.ok(near(seen[0], [3, -2, 2]) && near(seen[1], [0, 0, 0.2]), JSON.stringify(seen));
  const {page: above} = await openScenario(`${SCENARIO}[VIEW]\nfrom top\n`, {webgl: true});
  await above.waitForFunction(() => window.coopdyn.view.scene);
  const [x, y, z] = await above.evaluate(() => {
    const {camera, controls} = window.coopdyn.view;
    return camera.position.clone().sub(controls.target).toArray();
  });
  assert.ok(Math.hypot(x, y) < 0.02 * z, `${x} ${y} ${z}`);
});
