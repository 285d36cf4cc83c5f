// SPDX-License-Identifier: MIT
// Measures the page, a line each: from first load to a moving picture, pictures per second with a crowd, and the delay of an edit from
// click to picture. Never a pass or fail. COOPDYN_BINARY=build/release/coopdyn node tests/page/speed.js
import {closeBrowser, startBrowser, startDaemon} from './harness.js';

const REPEATS = 9;
const CROWD_PICTURES = 120;
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

async function crowd() {
  await onPage(['swarm1000', '--mode', 'realtime'], async (page, url) => {
    await page.goto(url);
    await moves(page);
    const drawn = () => page.evaluate(() => window.coopdyn.view.framesDrawn);
    const before = await drawn(), begin = performance.now();
    await page.waitForFunction((enough) => window.coopdyn.view.framesDrawn >= enough, before + CROWD_PICTURES, {polling: 'raf'});
    const pictures = await drawn() - before;
    console.log(`swarm1000, pictures per second: ${(1000 * pictures / (performance.now() - begin)).toFixed(1)}`);
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
  await crowd();
} finally {
  await closeBrowser();
}
