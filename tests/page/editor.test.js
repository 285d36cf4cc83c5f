// SPDX-License-Identifier: MIT
// The tab Text: mistakes shown while typing, completion, load, and a persistent draft.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {before, test} from 'node:test';
import {GRAMMAR, kindOf} from '../../server/web/page/grammar.js';
import {eventually, hasText, openClassroom} from './harness.js';

let daemon, page;

before(async () => {
  ({daemon, page} = await openClassroom());
  await page.click('#tab-text');
  await page.waitForFunction(() => window.coopdyn.editor.report);
});

const text = () => page.evaluate(() => window.coopdyn.editor.text);
const write = async (what) => {
  await page.evaluate(() => window.coopdyn.editor.code.view.focus());
  await page.keyboard.press('Control+a');
  await page.evaluate((pasted) => {
    const data = new DataTransfer();
    data.setData('text/plain', pasted);
    window.coopdyn.editor.code.view.contentDOM.dispatchEvent(new ClipboardEvent('paste', {clipboardData: data, bubbles: true, cancelable: true}));
  }, what);
};
const marks = () => page.locator('#editor .cm-lint-marker').count();

test('it begins with what runs', async () => {
  assert.match(await text(), /\[WORLD\]\nfile +classroom\.world/);
  await hasText(page, '#editor-state', /^This runs\. 1 robot/);
});

test('mistakes are marked at their lines as one types', async () => {
  await write('[ROBOT_1]\ntype coopbot\nposition 0 0\n\n[BOX_1]\ntype box\nsize 1 1 1\nposition 3 0\nfrction 2\n');
  await hasText(page, '#editor-state', /^1 error; line 9: unknown word 'frction'/);
  await eventually(async () => await marks() === 1);
});

test('a mistake that is mended has no mark any more', async () => {
  await page.keyboard.press('Backspace');
  for (let i = 0; i < 'frction 2'.length; ++i) await page.keyboard.press('Backspace');
  await page.keyboard.type('friction 2 ');
  await hasText(page, '#editor-state', /^Not what runs\. 1 robot/);
  await eventually(async () => await marks() === 0);
});

// Only those that Enter would take: a list that is being asked for again is shown, but disabled.
const options = () => page.locator('#editor .cm-tooltip-autocomplete:not(.cm-tooltip-autocomplete-disabled) .cm-completionLabel').allTextContents();

test('completion offers the words of the section', async () => {
  await page.keyboard.press('Escape');
  await page.keyboard.press('Enter');
  await page.keyboard.type('ma');
  await eventually(async () => (await options()).includes('mass'));
  assert.equal((await options()).includes('deadline'), false, 'a word of a robot');
  await page.keyboard.press('Enter');
  await eventually(async () => /mass {6}$/.test(await text()));
  await page.keyboard.type('2');
});

test('completion offers choices, robots among them', async () => {
  await page.keyboard.press('Enter');
  await page.keyboard.type('[');
  await eventually(async () => (await options()).includes('[ROBOT_1]'));
  await page.keyboard.press('Escape');
  await page.keyboard.type('ROBOT_2]');
  await page.keyboard.press('Enter');
  await page.keyboard.type('type h');
  await eventually(async () => (await options()).includes('hexapod'));
  await page.keyboard.type('exa');
  await page.keyboard.press('Enter');
  await eventually(async () => /type hexapod$/.test(await text()));
  await page.keyboard.press('Enter');
  await page.keyboard.type('position 0 2');
});

test('the draft is there after the page was opened again', async () => {
  const before = await text();
  await page.reload();
  await page.click('#tab-text');
  await page.waitForFunction(() => window.coopdyn?.editor.report);
  assert.equal(await text(), before);
});

test('Load runs the text', async () => {
  await page.click('#editor-load');
  await eventually(async () => (await daemon.status()).robot_count === 2);
  await hasText(page, '#editor-state', /^This runs\. /);
});

test('a text with mistakes is not run', async () => {
  await write('[ROBOT_1]\ntype nobody\nposition 0 0\n');
  await page.evaluate(() => window.coopdyn.editor.code.view.focus());
  await page.keyboard.press('Control+Enter');
  await hasText(page, '#message.error', /errors; nothing was changed/);
  assert.equal((await daemon.status()).robot_count, 2);
  await page.click('#tab-text');
});

test('the present world comes as a text, and undo brings back what was there', async () => {
  await page.click('#editor-world');
  await eventually(async () => /hexapod/.test(await text()));
  await page.evaluate(() => window.coopdyn.editor.code.view.focus());
  await page.keyboard.press('Control+z');
  await eventually(async () => /nobody/.test(await text()));
});

test('the text of a shipped scenario is opened from the gallery', async () => {
  await page.click('#tab-arena');
  await page.locator('.thumb-box', {hasText: 'corridor'}).first().locator('.small').click();
  await eventually(async () => /file +corridor\.world/.test(await text()));
});

test('Save as file gives the text', async () => {
  const [file] = await Promise.all([page.waitForEvent('download'), page.click('#editor-save')]);
  assert.equal(file.suggestedFilename(), 'corridor.scenario');
  assert.equal(await readFile(await file.path(), 'utf8'), await text());
});

test('the words of the grammar are those that the reader knows', async () => {
  const needed = {WORLD: 'file square10.world', ROBOT: 'type coopbot\nposition 0 0', SWARM: 'type coopbot\ncount 2', LIGHT: 'position 0 0 2',
    THING: 'type box\nsize 1 1 1\nposition 3 3'};
  const known = async (kind, extra = '') => {
    const name = {ROBOT: 'ROBOT_1', SWARM: 'SWARM_1', LIGHT: 'LIGHT_1', THING: 'BOX_1'}[kind] ?? kind;
    const answer = await fetch(new URL('api/check', daemon.url), {method: 'POST', headers: {'Content-Type': 'application/json'},
      body: JSON.stringify({name: 'probe.scenario', text: `[${name}]\n${extra || (needed[kind] ?? '')}\nzzzzz 1\n`})});
    const {diagnostics} = await answer.json();
    const said = diagnostics.map((one) => one.text).find((line) => line.includes("'zzzzz'"));
    return /known are? (.*)$/.exec(said)[1].split(/, | and /);
  };
  for (const kind of Object.keys(GRAMMAR).filter((one) => one !== 'TARGET')) {
    assert.equal(kindOf(kind === 'THING' ? 'BOX_1' : `${kind}_1`), kind);
    const reader = new Set(await known(kind));
    if (kind === 'THING') for (const word of await known(kind, 'type box\nsize 1 1 1\ncount 2')) reader.add(word);
    if (kind === 'LIGHT') for (const word of ['type', 'size']) reader.delete(word);  // asked for to tell a thing from a lamp
    if (kind === 'SWARM') reader.delete('position');
    assert.deepEqual(Object.keys(GRAMMAR[kind]).sort(), [...reader].sort(), kind);
  }
});
