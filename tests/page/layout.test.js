// SPDX-License-Identifier: MIT
// Tabs, the bar between view and sidebar, light and dark, and small windows.
import assert from 'node:assert/strict';
import {before, beforeEach, test} from 'node:test';
import {eventually, openClassroom, openConsole} from './harness.js';

let page;

before(async () => { ({page} = await openClassroom({webgl: true})); });
beforeEach(() => page.setViewportSize({width: 1280, height: 800}));

const box = (selector) => page.locator(selector).boundingBox();

test('the view has about two thirds of the window', async () => {
  const {width, height} = await box('#view-frame');
  assert.ok(width > 0.62 * 1280 && width < 0.72 * 1280, `${width} of 1280`);
  assert.ok(height > 0.66 * 800, `${height} of 800`);
});

test('another tab moves nothing but the sidebar', async () => {
  const before = await box('#view-frame');
  await page.click('#tab-world');
  assert.equal(await page.isVisible('#panel-robots'), false);
  assert.equal(await page.isVisible('#things'), true);
  assert.deepEqual(await box('#view-frame'), before);
});

test('arrows go from tab to tab', async () => {
  await page.click('#tab-robots');
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.getAttribute('#tab-robots', 'aria-selected'), 'false');
  await page.keyboard.press('Home');
  assert.equal(await page.getAttribute('#tab-robots', 'aria-selected'), 'true');
  assert.equal(await page.isVisible('#panel-robots'), true);
});

test('the bar beside the view widens the sidebar by mouse, and a double click sets it back', async () => {
  const before = (await box('aside')).width;
  const bar = await box('#splitter');
  await page.mouse.move(bar.x + 3, 300);
  await page.mouse.down();
  await page.mouse.move(bar.x - 120, 300);
  await page.mouse.up();
  await eventually(async () => (await box('aside')).width > before + 90);
  await page.dblclick('#splitter');
  await eventually(async () => (await box('aside')).width === before);
});

test('dark is kept when the page is opened again, and the view is dark too', async () => {
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await ground();
  await page.click('#theme');
  await page.click('#theme');
  assert.equal(await page.textContent('#theme'), 'Dark');
  const dark = await ground();
  assert.notEqual(dark, light);
  await page.reload();
  await eventually(async () => await page.textContent('#theme') === 'Dark');
  assert.equal(await ground(), dark);
  await page.click('#theme');
});

for (const [width, height] of [[1024, 768], [1280, 800], [1920, 1080]]) {
  test(`at ${width}×${height} nothing has to be scrolled to reach a tab, a button or the view`, async () => {
    await page.setViewportSize({width, height});
    for (const selector of ['#run', '#record', '#view', '#theme', '#tab-robots', '#tab-runs', '#tab-cost', '#console-box']) {
      const {x, y, width: w, height: h} = await box(selector);
      assert.ok(x >= 0 && y >= 0 && x + w <= width + 1 && y + h <= height + 1, `${selector}: ${x} ${y} ${w} ${h}`);
    }
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), width);
  });
}

test('on a phone the view stays above the tabs, and nothing is wider than the window', async () => {
  await page.setViewportSize({width: 390, height: 844});
  const view = await box('#view-frame'), side = await box('aside');
  assert.ok(view.y + view.height <= side.y);
  assert.ok(side.height > 300, `${side.height}`);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
});

test('on a phone a message does not cover the tools of the view', async () => {
  await page.setViewportSize({width: 390, height: 844});
  await page.evaluate(() => { document.getElementById('message').textContent = 'playing a recording of the last lesson'; });
  const message = await box('#toast'), tools = await box('#view-tools');
  assert.ok(message.y + message.height <= tools.y, JSON.stringify([message, tools]));
  await page.evaluate(() => { document.getElementById('message').textContent = ''; });
});

test('on a phone a Stop all that can stop nothing does not shine over other buttons', async () => {
  await page.setViewportSize({width: 390, height: 844});
  assert.equal(await page.$eval('#stop-all', (button) => {
    button.disabled = true;
    const isSeen = button.checkVisibility();
    button.disabled = false;
    return isSeen;
  }), false);
  assert.equal(await page.isVisible('#stop-all'), true);
});

test('the page moves nothing while it opens', async () => {
  await page.reload();
  await page.waitForSelector('.instrument figcaption:not(:empty)');
  const moved = await page.evaluate(() => new Promise((done) => {
    new PerformanceObserver((list) => done(list.getEntries().map(({value}) => value))).observe({type: 'layout-shift', buffered: true});
    setTimeout(() => done([]), 3000);
  }));
  assert.ok(moved.reduce((sum, value) => sum + value, 0) < 0.02, String(moved));
});

test('what is written can be read: its contrast is at least 4.5, light and dark', async () => {
  await openConsole(page);
  await page.fill('#console-line', 'get_time');
  await page.press('#console-line', 'Enter');
  await page.waitForSelector('#console-log .copies button');
  await page.hover('#stop-all');
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({colorScheme});
    const poor = await page.evaluate(() => {
      const parse = (text) => text.match(/[\d.]+/g).map(Number);
      const shine = ([r, g, b]) => [r, g, b].map((c) => (c /= 255) <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
        .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
      const groundOf = (element) => {
        for (let at = element; at; at = at.parentElement) {
          const ground = parse(getComputedStyle(at).backgroundColor);
          if (ground.length === 3 || ground[3] === 1) return ground;
        }
        return [255, 255, 255];
      };
      return [...document.querySelectorAll('body *')].filter((element) =>
        element.checkVisibility() && !element.closest(':disabled') && [...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim()))
        .map((element) => {
          let opacity = 1;
          for (let at = element; at; at = at.parentElement) opacity *= Number(getComputedStyle(at).opacity);
          const ground = groundOf(element), ink = parse(getComputedStyle(element).color).slice(0, 3).map((c, i) => opacity * c + (1 - opacity) * ground[i]);
          const [a, b] = [shine(ink), shine(ground)].sort((x, y) => y - x);
          return [element.id || element.className || element.tagName, (a + 0.05) / (b + 0.05)];
        }).filter(([, contrast]) => contrast < 4.5).map(([name, contrast]) => `${name} ${contrast.toFixed(2)}`);
    });
    assert.deepEqual(poor, [], colorScheme);
  }
  await page.emulateMedia({colorScheme: null});
});
