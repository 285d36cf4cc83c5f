// SPDX-License-Identifier: MIT
// Measures the page, a line each: from first load to a moving picture, the delay of an edit from click to picture, and pictures per second
// of 960 x 540 with the processor time of each, while the camera goes round. Never a pass or fail. COOPDYN_BINARY=build/release/coopdyn node tests/page/speed.js
import {closeBrowser, startBrowser, startDaemon} from './harness.js';

const REPEATS = 9;
const MEASURED_MS = 8000;
const TURN_RAD = 0.01;  // of the camera from picture to picture
const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** Runs `use` with a page of 1280 × 800 and a daemon's address. */
async function onPage(words, use) {
  const daemon = await startDaemon(...words);
  const page = await (await startBrowser()).newPage({viewport: {width: 1280, height: 800}});
  try {
    await use(page, daemon.url);
  } finally {
    await page.close();
    await daemon.stop();
  }
}

const moves = (page) => page.waitForFunction(() => Number(document.getElementById('view')?.dataset.shown ?? 0) > 0, null, {polling: 'raf'});

async function load() {
  await onPage(['classroom'], async (page, url) => {
    const times = [];
    for (let i = 0; i < REPEATS; ++i) {
      await page.goto('about:blank');
      const begin = performance.now();
      await page.goto(url);
      await moves(page);
      times.push(performance.now() - begin);
    }
    console.log(`classroom, first load to moving picture: first ${times[0].toFixed(0)} ms, median ${median(times).toFixed(0)} ms of ${REPEATS}`);
  });
}

/** Processor time of all of the browser's processes, s. */
async function browserCpu(session) {
  const {processInfo} = await session.send('SystemInfo.getProcessInfo');
  return processInfo.reduce((sum, {cpuTime}) => sum + cpuTime, 0);
}

async function pictures(scenario) {
  await onPage([scenario, '--mode', 'realtime', '--no-render'], async (page, url) => {
    await page.goto(url);
    await moves(page);
    await page.evaluate((turn) => {
      document.getElementById('view-frame').style.cssText = 'position: fixed; left: 0; top: 0; width: 960px; height: 540px; z-index: 1000';
      const {view} = window.coopdyn;
      view.addEventListener('drawn', () => {
        const away = view.camera.position.clone().sub(view.controls.target), {x, y} = away;
        away.set(x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn), away.z);
        view.camera.position.copy(view.controls.target).add(away);
        view.controls.update();
        view.redraw();
      });
      view.redraw();
    }, TURN_RAD);
    await page.waitForTimeout(3000);
    const session = await page.context().browser().newBrowserCDPSession();
    const drawn = () => page.evaluate(() => window.coopdyn.view.framesDrawn);
    const [cpu, before, begin] = [await browserCpu(session), await drawn(), performance.now()];
    await page.waitForTimeout(MEASURED_MS);
    const count = await drawn() - before, s = (performance.now() - begin) / 1000, used_ms = 1000 * (await browserCpu(session) - cpu);
    const width = await page.evaluate(() => document.getElementById('view').width);
    console.log(`${scenario}, pictures per second: ${(count / s).toFixed(1)}, CPU of one: ${(used_ms / count).toFixed(0)} ms, ${width} pixels wide`);
  });
}

/** From a click on Box in the palette until a picture shows the box. */
async function edit() {
  await onPage(['classroom'], async (page, url) => {
    await page.goto(url);
    await moves(page);
    await page.waitForFunction(() => window.coopdyn.handles);
    await page.click('#tab-world');
    await page.waitForSelector('#palette button');
    const times = [], scenes = [];
    for (let i = 0; i < REPEATS; ++i) {
      const [scene, seen] = await page.evaluate(async () => {
        const {view} = window.coopdyn;
        const button = [...document.querySelectorAll('#palette button')].find((one) => one.textContent.includes('Box'));
        const next = (what) => new Promise((done) => { view.addEventListener(what, () => done(performance.now()), {once: true}); });
        const begin = performance.now(), scene = next('scene');
        button.click();
        const came = await scene;
        return [came - begin, await next('drawn') - begin];
      });
      scenes.push(scene);
      times.push(seen);
      await page.waitForTimeout(500);
    }
    console.log(`classroom, an edit from click to seen: median ${median(times).toFixed(0)} ms of ${REPEATS}, ` +
      `${times[0].toFixed(0)} to ${times.at(-1).toFixed(0)}; the new scene came after ${median(scenes).toFixed(0)} ms`);
  });
}

try {
  await load();
  await edit();
  for (const scenario of ['classroom', 'walk', 'swarm100', 'swarm1000']) await pictures(scenario);
} finally {
  await closeBrowser();
}
