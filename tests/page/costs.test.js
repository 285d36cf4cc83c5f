// SPDX-License-Identifier: MIT
// The cost table: who slows the run.
import assert from 'node:assert/strict';
import {before, test} from 'node:test';
import {call, eventually, hasText, openClassroom, openModule} from './harness.js';

let daemon, page;

before(async () => {
  ({daemon, page} = await openClassroom());
});

const rows = () => page.evaluate(() => [...document.querySelectorAll('#cost-table tbody tr')].map((row) =>
  ({name: row.children[0].textContent, ms: Number(row.children[1].textContent), kind: row.dataset.kind})));

test('in real time the parts of a step and the spare time make up the step', async () => {
  await page.click('#tab-cost');
  let listed, said;
  await eventually(async () => {
    [listed, said] = await page.evaluate(() => [[...document.querySelectorAll('#cost-table tbody tr')].map((row) =>
      ({name: row.children[0].textContent, ms: Number(row.children[1].textContent), kind: row.dataset.kind})),
    document.getElementById('cost-verdict').textContent]);
    return /^A step takes \d+\.\d\d ms, \d+\.\d\d ms of it to spare: nothing in the run slows it\.$/.test(said) &&
      listed[0].kind === 'spare' && listed.some(({name}) => name === 'physics');
  });
  const sum = listed.reduce((total, {ms}) => total + ms, 0), length = Number(said.match(/takes (\S+) ms/)[1]);
  assert.ok(Math.abs(sum - length) < 0.02, `${sum} ms, and it says ${length}`);
  assert.ok(length > 5, `${length} ms for steps of 10 ms`);
});

test('a slow client is named, with how long the world waits for it', async () => {
  const client = await openModule(daemon.names, '/robot1/motors');
  client.on('data', () => setTimeout(() => client.write('set_velocity 0.1 0\n'), 20));
  client.write('hello ana\n');
  await call(daemon.url, {module: '/simulation', line: 'set_mode lockstep'});
  await hasText(page, '#cost-verdict', /^A step takes (?:[2-9]\d|\d{3,})\.\d\d ms\. robot1's client: the world waited (?:[2-9]\d|\d{3,})\.\d\d ms per step for it\.$/);
  const [first] = await rows();
  assert.equal(first.name, "robot1's client");
  assert.match(await page.getAttribute('#cost-table tbody tr', 'title'), /^ana: the world waited (?:[2-9]\d|\d{3,})\./);
  client.destroy();
  await call(daemon.url, {module: '/simulation', line: 'set_mode realtime'});
});

test('the average since the reset is there too', async () => {
  await call(daemon.url, {module: '/simulation', line: 'reset'});
  await page.click('[data-period="all"]');
  await eventually(async () => {
    const {steps} = await (await fetch(new URL('api/costs', daemon.url))).json();
    const shown = Number.parseInt(await page.textContent('#cost-table + p'), 10);
    return steps > 20 && shown > 10 && shown <= steps;
  });
  assert.equal(await page.getAttribute('[data-period="all"]', 'aria-pressed'), 'true');
  await page.click('[data-period="last"]');
});

test('rows are sorted by name, if one wants', async () => {
  await page.click('[data-sort="name"]');
  await eventually(async () => {
    const names = (await rows()).map(({name}) => name);
    return names.length > 2 && JSON.stringify(names) === JSON.stringify([...names].sort());
  });
  await page.click('[data-sort="ms"]');
});

test('threads beside the steps are listed', async () => {
  await page.waitForFunction(() => [...document.querySelectorAll('#cost-threads tbody th')].some(({textContent}) => textContent.startsWith('viewers')));
});
