// SPDX-License-Identifier: MIT
// The tab Program of a seat: a student with a browser alone writes a program that runs on the server.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';
import {eventually, hasText, newPage, openPage, startClass, startDaemon} from './harness.js';

let host, ana, link;
const has = (page) => page.waitForFunction(() => window.coopdyn?.program && /^[\d.]+ s$/.test(document.getElementById('time').textContent));
const code = (page) => page.waitForFunction(() => window.coopdyn.program.code);
const textOf = (page) => page.evaluate(() => window.coopdyn.program.code.text);
/** Types a program in place of that which is there, as a student would. */
async function write(page, text) {
  await page.evaluate(() => window.coopdyn.program.code.view.focus());
  await page.keyboard.press('ControlOrMeta+a');
  await page.keyboard.press('Delete');
  await page.keyboard.insertText(text);
}
const kept = () => readFileSync(join(host.folder, 'seats', 'ana', 'program.py'), 'utf8');
async function openProgram(page) {
  await page.goto(link);
  await has(page);
  await page.click('#tab-program');
  await code(page);
}

before(async () => {
  host = await startClass([{seat: 'ana', name: 'Ana Lima'}, {seat: 'ben', name: 'Ben Okafor'}], 'classroom');
  const rows = readFileSync(join(host.folder, 'class.csv'), 'utf8').split('\n');
  link = new URL(`l/${rows.find((row) => row.includes('Ana Lima')).match(/[0-9a-f]{24}/)[0]}`, host.url).href;
  ana = await newPage();
  await openProgram(ana);
});

test('a first program stands there, and drives the robot', async () => {
  assert.match(await textOf(ana), /coopdyn\.connect\(\)/);
  await ana.click('#program-run');
  await hasText(ana, '#program-state', /^It runs\.$/);
  await hasText(ana, '#program-output', /the nearest thing is [\d.]+ m away/);
  await ana.click('#tab-robots');
  await hasText(ana, '.card .owner', /ana@/);
  await ana.click('#tab-program');
});

test('the wall tells that a program runs', async () => {
  const wall = await newPage();
  await wall.goto(new URL(`wall/#token=${host.token}`, host.url).href);
  await hasText(wall, '.tile[data-seat="ana"] .program', /^a program of the page (drives|runs)$/);
});

test('it is stopped', async () => {
  assert.ok(await ana.isDisabled('#program-run'));
  await ana.click('#program-stop');
  await hasText(ana, '#program-state', /^The program was stopped\.$/);
  assert.ok(await ana.isDisabled('#program-stop'));
});

test('it runs again at once after a stop', async () => {
  await ana.click('#program-run');
  await hasText(ana, '#program-state', /^It runs\.$/);
  await ana.click('#program-stop');
  await ana.waitForSelector('#program-run:enabled');
  await ana.click('#program-run');
  await hasText(ana, '#program-output', /the nearest thing is/);
  await ana.click('#program-stop');
  await hasText(ana, '#program-state', /^The program was stopped\.$/);
});

test('what one types is kept by itself, and runs with Ctrl+Enter', async () => {
  await write(ana, 'print("ready", 6 * 7)');
  await eventually(() => kept() === 'print("ready", 6 * 7)');
  await ana.keyboard.press('Control+Enter');
  await hasText(ana, '#program-output', /^ready 42\n$/);
  await hasText(ana, '#program-state', /^The program has ended\.$/);
});

test('an error leads to its line', async () => {
  await write(ana, '# one\n# two\nprint(unknown)\n');
  await ana.keyboard.press('Control+Enter');
  await hasText(ana, '#program-state', /NameError: name 'unknown' is not defined/);
  await ana.waitForFunction(() => window.coopdyn.program.code.view.dom.querySelector('.cm-lintRange-error'));
  await ana.click('#program-output .place');
  assert.equal(await ana.evaluate(() => { const {state} = window.coopdyn.program.code.view; return state.doc.lineAt(state.selection.main.from).number; }), 3);
});

test('the wall tells of the error', async () => {
  const wall = await newPage();
  await wall.goto(new URL(`wall/#token=${host.token}`, host.url).href);
  await hasText(wall, '.tile[data-seat="ana"] .why', /NameError/);
  await hasText(wall, '.tile[data-seat="ana"] .program', /^a program of the page ended with an error$/);
});

test('text and output are there again after a reload', async () => {
  await ana.reload();
  await has(ana);
  await ana.click('#tab-program');
  await code(ana);
  assert.equal(await textOf(ana), '# one\n# two\nprint(unknown)\n');
  await hasText(ana, '#program-output', /NameError/);
});

test('another window of the seat follows, and nobody overwrites what the other has written', async () => {
  const other = await newPage();
  await openProgram(other);
  await write(ana, 'print("of ana")');
  await other.waitForFunction(() => window.coopdyn.program.code.text === 'print("of ana")');
  await other.route('**/class/program', (route) => (route.request().method() === 'POST' ? route.abort() : route.continue()));
  await write(other, 'print("of the other")');
  await hasText(other, '#program-state', /^Not kept: the host does not answer/);
  await write(ana, 'print("of ana again")');
  await eventually(() => kept() === 'print("of ana again")');
  await other.unrouteAll();
  await other.waitForSelector('#program-choice:not([hidden])');
  assert.equal(kept(), 'print("of ana again")');
  await other.click('#program-theirs');
  await other.waitForFunction(() => window.coopdyn.program.code.text === 'print("of ana again")');
  assert.ok(await other.isHidden('#program-choice'));
  other.mistakes.length = 0;  // the browser reports the requests that failed
});

test('it is handed in as it is typed', async () => {
  await write(ana, 'print("handed in")');
  await ana.click('#class-hand-in');
  await hasText(ana, '#class-said', /your program/);
  assert.equal(kept(), 'print("handed in")');
});

test('keys alone reach it, run it and leave the field', async () => {
  await ana.focus('#tab-robots');
  await ana.keyboard.press('ArrowRight');
  await ana.waitForSelector('#panel-program:not([hidden])');
  await ana.evaluate(() => window.coopdyn.program.code.view.focus());
  await ana.keyboard.press('Escape');
  await ana.keyboard.press('Tab');
  assert.equal(await ana.evaluate(() => document.activeElement.id), 'program-output');
});

test('nothing overflows on a phone', async () => {
  await ana.setViewportSize({width: 390, height: 844});
  for (const id of ['program-run', 'program-stop', 'program-code', 'program-output']) {
    const {x, width, height} = await ana.locator(`#${id}`).boundingBox();
    assert.ok(x >= 0 && x + width <= 390 && height > 20, `${id}: ${x} ${width} ${height}`);
  }
  assert.ok(await ana.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
});

test('the teacher at the seat reads the program, and cannot change it', async () => {
  const teacher = await newPage();
  await teacher.goto(new URL(`wall/#token=${host.token}`, host.url).href);
  await teacher.waitForSelector('.tile[data-seat="ana"]');
  await teacher.goto(new URL('wall/s/ana/', host.url).href);
  await has(teacher);
  await teacher.click('#tab-program');
  await code(teacher);
  assert.equal(await textOf(teacher), 'print("handed in")');
  assert.equal(await teacher.locator('#program-run').count(), 0);
  await write(teacher, 'x');
  assert.equal(await textOf(teacher), 'print("handed in")');
});

test('a daemon without a class has no such tab', async () => {
  const page = await openPage((await startDaemon('classroom', '--no-render')).url);
  assert.equal(await page.locator('#tab-program').count(), 0);
});
