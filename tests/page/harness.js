// SPDX-License-Identifier: MIT
// Starts the daemon that COOPDYN_BINARY names and opens its page in a headless Chromium, which all tests share.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {connect} from 'node:net';
import {mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {createInterface} from 'node:readline';
import {setTimeout as sleep} from 'node:timers/promises';
import {chromium} from 'playwright-core';

const SOURCE_DIR = new URL('../..', import.meta.url).pathname;
const LIMIT_MS = 120000;  // only a hang reaches it
const SIZE = {width: 1024, height: 768};  // a projector's
const daemons = new Set(), pages = new Set(), folders = new Set();
const kept = [];  // used pages: a new one costs three times as much as another address on a used one
let browser;

/** A daemon on free ports: {url, names, process, status(), stop()}. `scenario`: a name or path. */
export const startDaemon = (scenario = 'classroom', ...flags) => start({}, 'serve', scenario, ...flags);

/** Like startDaemon(), in another environment. */
export const startDaemonIn = (environment, scenario, ...flags) => start(environment, 'serve', scenario, ...flags);

/** Plays a recording on free ports; like startDaemon(). */
export const startPlayer = (file, ...flags) => start({}, 'play', file, ...flags);

/** A class with these seats ({seat, name, group}; the PIN of each is 7305), like startDaemon(); also has `folder` and `token`. */
export async function startClass(seats, ...lessons) {
  const folder = newFolder(), list = join(folder, 'list.csv');
  writeFileSync(list, ['seat,name,group,pin', ...seats.map(({seat, name, group = ''}) => `${seat},${name},${group},7305`)].join('\n'));
  const host = await start({}, 'host', ...lessons, '--class', list, '--folder', join(folder, 'class'), '--no-render');
  return Object.assign(host, {folder: join(folder, 'class'), token: readFileSync(join(folder, 'class', 'token'), 'utf8').trim()});
}

async function start(environment, ...words) {
  const binary = process.env.COOPDYN_BINARY;
  if (!binary) throw new Error('set COOPDYN_BINARY to the daemon to test, e.g. build/release/coopdyn');
  const child = spawn(binary, [...words, '--port', '0'], {stdio: ['ignore', 'pipe', 'pipe'],
    env: {...process.env, COOPDYN_PATH: process.env.COOPDYN_PATH ?? SOURCE_DIR, ...environment}});
  const ended = once(child, 'exit');
  const daemon = {
    process: child,
    async status() { return (await fetch(new URL('api/status', daemon.url))).json(); },
    async stop() {
      child.kill('SIGTERM');
      await ended;
      daemons.delete(daemon);
    },
  };
  daemons.add(daemon);
  let log = '';
  child.stderr.on('data', (chunk) => { log += chunk; });
  for await (const line of createInterface({input: child.stdout})) {
    const match = /^ready names=(\S+) http=(\S+)/.exec(line);
    if (match) return Object.assign(daemon, {names: match[1], url: match[2]});
  }
  await ended;
  throw new Error(`the daemon ended before it was ready:\n${log}`);
}

/** An empty page that collects its errors in `page.mistakes`. `webgl`: it can draw the view itself, by software rendering, which takes
 *  most of a test's time; otherwise it shows the daemon's pictures. `locale`: the browser's language. */
export async function newPage({webgl = false, locale = 'en-US'} = {}) {
  const at = kept.findIndex((page) => page.webgl === webgl && page.locale === locale);
  const page = at >= 0 ? kept.splice(at, 1)[0] : await makePage(webgl, locale);
  page.mistakes = [];
  pages.add(page);
  return page;
}

/** The browser shared by all tests. */
export const startBrowser = () => (browser ??= chromium.launch({
  executablePath: process.env.COOPDYN_CHROMIUM ?? '/usr/bin/chromium',
  args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync'],
}));

async function makePage(webgl, locale) {
  const page = Object.assign(await (await startBrowser()).newPage({viewport: SIZE, reducedMotion: 'reduce', locale}), {webgl, locale});
  page.setDefaultTimeout(LIMIT_MS);
  page.on('close', () => pages.delete(page));
  // A few pictures a second are enough.
  await page.addInitScript(([pause_ms, draws]) => {
    const soon = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (draw) => setTimeout(() => soon(draw), pause_ms);
    window.cancelAnimationFrame = (number) => clearTimeout(number);
    const {getContext} = HTMLCanvasElement.prototype;
    if (!draws) HTMLCanvasElement.prototype.getContext = function flat(kind, ...more) {
      return kind.startsWith('webgl') ? null : getContext.call(this, kind, ...more);
    };
  }, [150, webgl]);
  // By a timer, because software rendering delays animation frames.
  const waitForFunction = page.waitForFunction.bind(page);
  page.waitForFunction = (condition, arg) => waitForFunction(condition, arg, {polling: 40});
  page.on('pageerror', (error) => page.mistakes.push(String(error)));
  page.on('console', (message) => { if (message.type() === 'error') page.mistakes.push(message.text()); });
  return page;
}

/** A page as of newPage() that has received the daemon's status. */
export async function openPage(url, options) {
  const page = await newPage(options);
  await page.goto(url);
  await page.waitForFunction(() => window.coopdyn && /^[\d.]+ s$/.test(document.getElementById('time').textContent));
  return page;
}

/** Without WebGL the daemon draws for its page, which takes most of its time: only on request, `pictures`. */
const drawing = ({webgl, pictures} = {}) => (webgl || pictures ? [] : ['--no-render']);

/** A daemon with the classroom, and its page. */
export async function openClassroom(options) {
  const daemon = await startDaemon('classroom', ...drawing(options));
  return {daemon, page: await openPage(daemon.url, options)};
}

/** A daemon with the scenario of this text, which also finds `files` (texts by path), and its page. */
export async function openScenario(text, {files = {}, ...options} = {}) {
  const folder = newFolder();
  for (const [name, content] of Object.entries({...files, 'page.scenario': text})) {
    mkdirSync(dirname(join(folder, name)), {recursive: true});
    writeFileSync(join(folder, name), content);
  }
  const daemon = await startDaemon(join(folder, 'page.scenario'), '--scenarios', folder, ...drawing(options));
  return {daemon, page: await openPage(daemon.url, options)};
}

/** Loads this text into a daemon, and waits until the page has drawn the new scene. */
export async function loadAnew(daemon, page, text) {
  await page.waitForFunction(() => window.coopdyn.view.scene);
  const last = await page.evaluate(() => window.coopdyn.view.scene.number);
  const {error, text: said} = await call(daemon.url, {module: '/simulation', command: 'load_scenario', text});
  assert.equal(error, 0, said);
  await page.waitForFunction((old) => window.coopdyn.view.scene.number !== old, last);
}

/** A temporary folder, removed with the daemons. */
export function newFolder() {
  const folder = mkdtempSync(join(tmpdir(), 'coopdyn_page_'));
  folders.add(folder);
  return folder;
}

/** Ends everything that tests have started, after each test or after all tests of a file; expects no errors on open pages. Tests that
 *  change more of a page than is reset here must close it. */
export async function endAll() {
  const mistakes = [...pages].flatMap((page) => page.mistakes);
  for (const page of pages) {
    page.removeAllListeners('request');
    await page.unrouteAll();
    await page.goto('about:blank');
    await page.setViewportSize(SIZE);
    kept.push(page);
  }
  pages.clear();
  await Promise.all([...daemons].map((daemon) => daemon.stop()));
  for (const folder of folders) rmSync(folder, {recursive: true, force: true});
  folders.clear();
  assert.deepEqual(mistakes, []);
}

export const closeBrowser = async () => (await browser)?.close();

/** Waits until the page has received and shown `count` more statuses. */
export const moreStatuses = (page, count) => page.evaluate((more) => new Promise((done) => {
  let left = more;
  window.coopdyn.connection.addEventListener('status', () => { if (--left === 0) done(); });
}), count);

/** Waits until the text of `selector` matches. */
export const hasText = (page, selector, pattern) => page.waitForFunction(
  ([where, source]) => new RegExp(source).test(document.querySelector(where)?.textContent ?? ''),
  [selector, pattern.source]);

/** Types a number into a field, leaves it, and waits for the reply. */
export async function enterNumber(page, field, number) {
  await page.fill(field, number);
  await page.press(field, 'Enter');
  await page.waitForFunction((of) => !document.activeElement.matches(of), field);
}

/** Unfolds the console. */
export const openConsole = (page) => page.evaluate(() => { document.getElementById('console-box').open = true; });

/** The reply to `command` of a module, by HTTP. */
export async function call(url, request) {
  const response = await fetch(new URL('api/call', url), {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(request)});
  if (!response.ok) throw new Error(`${response.status}: ${await response.text()}`);
  return response.json();
}

/** Like call() with a line of the text form; must not fail. */
export async function order(url, module, line) {
  const reply = await call(url, {module, line});
  assert.equal(reply.error, 0, `${line}: ${reply.text}`);
  return reply;
}

/** A text connection to a module, through the name port. */
export async function openModule(names, module) {
  const separator = names.lastIndexOf(':');
  const client = connect(Number(names.slice(separator + 1)), names.slice(0, separator));
  client.write(`OPEN ${module}\n`);
  const [answer] = await once(client, 'data');
  if (!String(answer).startsWith('ok')) throw new Error(String(answer));
  return client;
}

/** Polls until `condition` resolves to true; yields the processor in between. */
export async function eventually(condition) {
  const end = performance.now() + LIMIT_MS;
  while (!(await condition())) {
    if (performance.now() > end) throw new Error(`still not so after ${LIMIT_MS / 1000} seconds: ${condition}`);
    await sleep(40);
  }
}

/** Waits until the page shows a picture of the present or a later moment; returns the pixels as a data URL. */
export async function nextPicture(page) {
  const before = await page.evaluate(() => Number(document.getElementById('view').dataset.shown ?? 0));
  await page.waitForFunction((count) => Number(document.getElementById('view').dataset.shown ?? 0) > count, before);
  return picture(page);
}

export function picture(page) {
  return page.evaluate(() => document.getElementById('view').toDataURL());
}
