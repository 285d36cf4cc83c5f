// SPDX-License-Identifier: MIT
// The console: completion of commands and arguments, readable replies, and copies that run in our clients.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {once} from 'node:events';
import {connect} from 'node:net';
import {before, test} from 'node:test';
import {promisify} from 'node:util';
import {inLanguages, programOf} from '../../server/web/page/console_copy.js';
import {call, hasText, openClassroom, openConsole} from './harness.js';

const SOURCE = new URL('../..', import.meta.url).pathname;
const run = promisify(execFile);
let daemon, page;

before(async () => {
  ({daemon, page} = await openClassroom());
  await page.waitForSelector('#console-module option[value="/robot1/motors"]', {state: 'attached'});
  await openConsole(page);
  await page.evaluate(() => { globalThis.copied = ''; navigator.clipboard.writeText = async (text) => { globalThis.copied = text; }; });
});

const value = () => page.inputValue('#console-line');

/** Begins a line to a module with known commands. */
async function type(module, line) {
  await page.evaluate(() => { document.getElementById('console-hint').textContent = ''; });  // of another module
  await page.selectOption('#console-module', module);
  await page.fill('#console-line', '');
  await page.focus('#console-line');
  await hasText(page, '#console-hint', /\w/);
  await page.keyboard.type(line);
}

async function send(module, line) {
  await type(module, line);
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.querySelector('#console-log').lastElementChild.classList.contains('reply'));
}

/** The text copied by the button of the last command. */
async function copyOf(language) {
  await page.locator(`#console-log > .sent [data-copy="${language}"]`).last().click();
  await hasText(page, '#message', new RegExp(`^copied as ${language.replaceAll('+', '\\+')}$`));
  return page.evaluate(() => globalThis.copied);
}

const names = () => Number(daemon.names.slice(daemon.names.lastIndexOf(':') + 1));

/** Runs lines after the lines that connect; returns the program's output. */
async function python(lines) {
  const code = programOf('Python', '127.0.0.1', names(), lines);
  return (await run('python3', ['-c', code], {env: {...process.env, PYTHONPATH: `${SOURCE}/clients/python`}})).stdout;
}
async function octave(lines) {
  const code = `addpath('${SOURCE}/clients/matlab');\n${programOf('MATLAB', '127.0.0.1', names(), lines)}`;
  return (await run('octave-cli', ['--no-gui', '--quiet', '--eval', code])).stdout;
}

test('Tab goes through the words that an argument may be', async () => {
  await type('/simulation', 'set_mode ');
  await hasText(page, '#console-hint', /now: mode, realtime \| lockstep \| free/);
  const seen = [];
  for (let i = 0; i < 4; ++i) {
    await page.keyboard.press('Tab');
    seen.push(await value());
  }
  assert.deepEqual(seen, ['set_mode realtime', 'set_mode lockstep', 'set_mode free', 'set_mode realtime']);
  await page.keyboard.press('Shift+Tab');
  assert.equal(await value(), 'set_mode free');
});

test('Tab completes a word of an argument', async () => {
  await type('/simulation', 'set_mode lo');
  await page.keyboard.press('Tab');
  assert.equal(await value(), 'set_mode lockstep ');
});

test('Tab completes robots and scenarios by name', async () => {
  await type('/simulation', 'release_robot ro');
  await page.keyboard.press('Tab');
  assert.equal(await value(), 'release_robot robot1 ');
  await page.waitForSelector('#scenarios option[value="corridor"]', {state: 'attached'});
});

test('Tab offers the example where any number may stand, and the hint says its unit', async () => {
  await type('/robot1/motors', 'set_velocity ');
  await hasText(page, '#console-hint', /now: linear, m\/s/);
  await page.keyboard.press('Tab');
  assert.equal(await value(), 'set_velocity 0.2 ');
  await hasText(page, '#console-hint', /now: angular, rad\/s/);
  await page.keyboard.press('Tab');
  assert.equal(await value(), 'set_velocity 0.2 0.5 ');
});

test('a reply is explained in names and units', async () => {
  await send('/robot1/motors', 'get_limits');
  const reply = await page.locator('#console-log > .reply').last().textContent();
  assert.match(reply, /^0 "" 13 0 5 /);
  assert.match(reply, /max_wheel_speed \S+ rad\/s, wheel_radius \S+ m, track \S+ m, at \S+ s, step \d+$/);
});

test('a long reply is folded, and JSON in it is laid out', async () => {
  await send('/simulation', 'get_status');
  const folded = page.locator('#console-log > .reply details').last();
  await folded.locator('summary').click();
  assert.match(await folded.textContent(), /\n "scenario": "classroom",\n/);
});

test('a command is copied as a line for each client', async () => {
  await send('/robot1/motors', 'set_velocity (10) 0.2 0.5');
  assert.equal(await copyOf('Python'), 'reply = sim.call("/robot1/motors", "set_velocity", params=[10], data=[0.2, 0.5])');
  assert.equal(await copyOf('MATLAB'), "reply = sim.call('/robot1/motors', 'set_velocity', [10], [0.2 0.5])");
  assert.equal(await copyOf('C++'), 'sim.call("/robot1/motors", "set_velocity", {10}, {0.2, 0.5});');
  assert.equal(await copyOf('telnet'), 'OPEN /robot1/motors\nset_velocity (10) 0.2 0.5');
});

test('the log is copied as a program that runs', async () => {
  await page.evaluate(() => document.getElementById('console-log').replaceChildren());
  await send('/simulation', 'set_mode free');
  await send('/simulation', 'set_mode realtime');
  await send('/robot1/target', 'get_target red');
  await page.selectOption('#console-copy', 'Python');
  await hasText(page, '#message', /^copied as Python$/);
  const program = await page.evaluate(() => globalThis.copied);
  const {stdout} = await run('python3', ['-c', `${program}print(reply.data)`], {env: {...process.env, PYTHONPATH: `${SOURCE}/clients/python`}});
  assert.match(stdout, /^\(?array|^\(|^\[/);
});

/** Commands of all kinds: with words, texts with quotes and line ends, lists, non-finite numbers. */
const LINES = [
  ['/robot1/pose', 'get_pose'], ['/robot1/target', 'get_target red'], ['/simulation', 'ping (1 2) 0.5 inf'],
  ['/world', 'insert "[BOX_*]\\n# it\'s \\"one\\"\\ntype box\\nsize 0.2 0.2 0.2\\nposition 3 3"'], ['/world', 'list'],
];

async function resolved() {
  const table = [];
  for (const [module, line] of LINES) {
    const described = JSON.parse((await call(daemon.url, {module, command: 'describe'})).text).commands;
    const {sent, error, text} = await call(daemon.url, {module, line});
    assert.equal(error, 0, `${line}: ${text}`);
    if (line.startsWith('insert')) assert.equal((await call(daemon.url, {module: '/world', command: 'undo'})).error, 0);
    table.push({module, line, name: described.find(({id}) => id === sent.command).name, ...sent});
  }
  return table;
}

/** Each line of `out` begins with the sent command of the table; that of ping has these values. */
function runAsSent(table, out, pinged) {
  const lines = out.trim().split('\n');
  assert.equal(lines.length, table.length, out);
  table.forEach((sent, i) => assert.equal(Number.parseInt(lines[i], 10), sent.command, `${sent.line}: ${lines[i]}`));
  const at = table.findIndex(({name}) => name === 'ping');
  assert.equal(lines[at].trim(), `${table[at].command} ${pinged}`);
}

/** The box inserted by the lines, which is then removed. */
async function boxIsThere() {
  const things = async () => (await call(daemon.url, {module: '/world', command: 'list'})).text;
  const before = await things();
  assert.equal((await call(daemon.url, {module: '/world', command: 'undo'})).error, 0);
  assert.ok(before.length > (await things()).length, 'nothing was inserted');
}

test('the Python lines run, and send what the console sent', async () => {
  const table = await resolved();
  const out = await python(table.flatMap((sent) =>
    [inLanguages(sent).Python, 'print(reply.command, list(reply.params), list(reply.data))']));
  runAsSent(table, out, '[1, 2] [0.5, inf]');
  await boxIsThere();
});

test('the MATLAB lines run in Octave, and send what the console sent', async () => {
  const table = await resolved();
  const out = await octave(table.flatMap((sent) =>
    [`${inLanguages(sent).MATLAB};`, "printf('%g ', reply.command, reply.params, reply.data); printf('\\n');"]));
  runAsSent(table, out, '1 2 0.5 Inf');
  await boxIsThere();
});

test('the telnet lines run', async () => {
  const table = (await resolved()).filter(({name}) => name !== 'insert');
  for (const sent of table) {
    const client = connect(names(), '127.0.0.1');
    let heard = '';
    client.on('data', (chunk) => { heard += chunk; });
    client.end(`${inLanguages(sent).telnet}\n`);
    await once(client, 'close');
    assert.match(heard, new RegExp(`^ok\\r?\\n0 ".*" ${sent.command} `, 's'), sent.line);
  }
});
