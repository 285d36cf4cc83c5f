// SPDX-License-Identifier: MIT
// Starts the daemon that COOPDYN_BINARY names and opens its page in a headless Chromium.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {connect} from 'node:net';
import {mkdirSync, mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {createInterface} from 'node:readline';
import {chromium} from 'playwright-core';

const SOURCE_DIR = new URL('../..', import.meta.url).pathname;

/** A daemon on free ports: {url, names, process, status(), stop()}. `scenario`: a name or path. */
export const startDaemon = (scenario = 'classroom', ...flags) => start('serve', scenario, ...flags);

/** Plays a recording on free ports; as startDaemon(). */
export const startPlayer = (file, ...flags) => start('play', file, ...flags);

async function start(...words) {
  const binary = process.env.COOPDYN_BINARY;
  if (!binary) throw new Error('set COOPDYN_BINARY to the daemon to test, e.g. build/release/coopdyn');
  const child = spawn(binary, [...words, '--port', '0'],
    {stdio: ['ignore', 'pipe', 'pipe'], env: {...process.env, COOPDYN_PATH: process.env.COOPDYN_PATH ?? SOURCE_DIR}});
  let log = '';
  child.stderr.on('data', (chunk) => { log += chunk; });
  const ended = once(child, 'exit');
  const ready = (async () => {
    for await (const line of createInterface({input: child.stdout})) {
      const match = /^ready names=(\S+) http=(\S+)/.exec(line);
      if (match) return {names: match[1], url: match[2]};
    }
    await ended;
    throw new Error(`the daemon ended before it was ready:\n${log}`);
  })();
  const addresses = await ready;
  return {
    ...addresses,
    process: child,
    async status() { return (await fetch(new URL('api/status', addresses.url))).json(); },
    async stop() {
      child.kill('SIGTERM');
      await ended;
    },
  };
}

/** `flat`: without WebGL, for tests of what stands beside the view; it draws on the processor, which takes half of a test's
 *  time. The page then shows the daemon's pictures. */
export function launchBrowser({flat = false} = {}) {
  return chromium.launch({
    executablePath: process.env.COOPDYN_CHROMIUM ?? '/usr/bin/chromium',
    args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync',
      ...(flat ? ['--disable-3d-apis'] : [])],
  });
}

/** A page at a projector's size that has the daemon's status. Errors on it are collected in `page.mistakes`;
 *  `page.statuses` counts what it was told. */
export async function openPage(browser, url) {
  const page = await browser.newPage({viewport: {width: 1024, height: 768}});
  // Software draws on the cores that the test needs: a few pictures a second are enough.
  await page.addInitScript((pause_ms) => {
    const soon = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (draw) => setTimeout(() => soon(draw), pause_ms);
    window.cancelAnimationFrame = (number) => clearTimeout(number);
  }, 60);
  page.mistakes = [];
  page.on('pageerror', (error) => page.mistakes.push(String(error)));
  page.on('console', (message) => { if (message.type() === 'error') page.mistakes.push(message.text()); });
  page.statuses = 0;
  page.on('websocket', (socket) => socket.on('framereceived', ({payload}) => {
    if (typeof payload === 'string' && payload.startsWith('{"type":"status"')) ++page.statuses;
  }));
  await page.goto(url);
  await page.waitForFunction(() => /^[\d.]+ s$/.test(document.getElementById('time').textContent));
  return page;
}

/** A daemon with the classroom, and its page. */
export async function openClassroom(browser) {
  const daemon = await startDaemon('classroom');
  return {daemon, page: await openPage(browser, daemon.url)};
}

/** A daemon with the scenario of this text, which finds `files` (texts by path) too, and its page. closeScenario() ends them. */
export async function openScenario(browser, text, files = {}) {
  const folder = mkdtempSync(join(tmpdir(), 'coopdyn_page_'));
  for (const [name, content] of Object.entries({...files, 'page.scenario': text})) {
    mkdirSync(dirname(join(folder, name)), {recursive: true});
    writeFileSync(join(folder, name), content);
  }
  const daemon = await startDaemon(join(folder, 'page.scenario'), '--scenarios', folder);
  return {daemon, folder, page: await openPage(browser, daemon.url)};
}

/** Ends what openScenario() began; there were no errors on the page. */
export async function closeScenario({daemon, folder, page}) {
  await closeClassroom({daemon, page});
  rmSync(folder, {recursive: true, force: true});
}

/** Ends both; there were no errors on the page. */
export async function closeClassroom({daemon, page}) {
  assert.deepEqual(page.mistakes, []);
  await page.close();
  await daemon.stop();
}

/** Waits until the page was told its status `count` times more, five times a second. */
export async function moreStatuses(page, count) {
  const later = page.statuses + count;
  await eventually(async () => {
    await page.evaluate(() => 0);  // so that what comes is heard
    return page.statuses >= later;
  });
}

/** Waits until the text of `selector` matches. */
export const hasText = (page, selector, pattern) => page.waitForFunction(
  ([where, source]) => new RegExp(source).test(document.querySelector(where)?.textContent ?? ''),
  [selector, pattern.source]);

/** Shows the console, which is folded at first. */
export const openConsole = (page) => page.evaluate(() => { document.getElementById('console-box').open = true; });

/** The message with which `command` of a module is answered, by HTTP. */
export async function call(url, request) {
  const response = await fetch(new URL('api/call', url), {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(request)});
  if (!response.ok) throw new Error(`${response.status}: ${await response.text()}`);
  return response.json();
}

/** A text connection to a module, through the port of the names. */
export async function openModule(names, module) {
  const separator = names.lastIndexOf(':');
  const client = connect(Number(names.slice(separator + 1)), names.slice(0, separator));
  client.write(`OPEN ${module}\n`);
  const [answer] = await once(client, 'data');
  if (!String(answer).startsWith('ok')) throw new Error(String(answer));
  return client;
}

/** Asks again and again until `condition` resolves to true; fails after as long as Playwright's own waits. */
export async function eventually(condition) {
  const end = performance.now() + 30000;
  while (!(await condition())) {
    if (performance.now() > end) throw new Error(`still not so after thirty seconds: ${condition}`);
  }
}

/** Waits until a picture of this or a later moment than now is shown, and returns the pixels as a data URL. */
export async function nextPicture(page) {
  const shown = () => page.evaluate(() => Number(document.getElementById('view').dataset.shown ?? 0));
  const before = await shown();
  await page.waitForFunction((count) => Number(document.getElementById('view').dataset.shown ?? 0) > count, before);
  return picture(page);
}

export function picture(page) {
  return page.evaluate(() => document.getElementById('view').toDataURL());
}
