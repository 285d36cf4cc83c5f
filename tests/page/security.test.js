// SPDX-License-Identifier: MIT
// Attacks on the page and through it.
import assert from 'node:assert/strict';
import {once} from 'node:events';
import {createServer} from 'node:http';
import {connect} from 'node:net';
import {networkInterfaces} from 'node:os';
import {afterEach, test} from 'node:test';
import {endAll, hasText, newPage, openClassroom, openConsole, openModule, openPage, startDaemon} from './harness.js';

const MARKUP = '<img/src=x/onerror=globalThis.hit=1>';

afterEach(endAll);

test('names with markup are shown as text', async () => {
  const {daemon, page} = await openClassroom();
  const client = await openModule(daemon.names, '/robot1/motors');
  client.write(`hello ${MARKUP}\nclaim\n`);
  await page.waitForFunction((text) => document.querySelector('.card .owner')?.textContent.includes(text), MARKUP);

  const scenario = `[ROBOT_1]\ntype ${MARKUP}\n`;
  await page.setInputFiles('#upload', {name: 'x.scenario', mimeType: 'text/plain', buffer: Buffer.from(scenario)});
  await page.waitForFunction((text) => document.getElementById('diagnostics').textContent.includes(text), MARKUP);

  await openConsole(page);
  await page.selectOption('#console-module', '/robot1/motors');
  await page.fill('#console-line', MARKUP);
  await page.press('#console-line', 'Enter');
  await page.waitForFunction((text) => document.getElementById('console-log').textContent.includes(text), MARKUP);

  assert.equal(await page.evaluate(() => document.querySelectorAll('img').length), 0);
  assert.equal(await page.evaluate(() => globalThis.hit), undefined);
  client.destroy();
});

test('a page of another origin can change nothing', async () => {
  const daemon = await startDaemon('classroom', '--no-render');
  const server = createServer((request, response) => {
    response.setHeader('Content-Type', 'text/html');
    response.end('<!doctype html><title>elsewhere</title>');
  });
  server.listen(0, '127.0.0.1').unref();
  await once(server, 'listening');
  const page = await newPage();
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  const results = await page.evaluate(async (url) => {
    const body = JSON.stringify({id: 1, module: '/simulation', command: 'pause'});
    const attempt = async (options) => {
      try {
        const response = await fetch(new URL('api/call', url), {method: 'POST', body, ...options});
        return `answered ${response.status} ${response.type}`;
      } catch (error) {
        return `refused: ${error.name}`;
      }
    };
    const socket = await new Promise((resolve) => {
      const opened = new WebSocket(new URL('ws', url).href.replace('http', 'ws'));
      opened.onopen = () => { opened.send(body); resolve('open'); };
      opened.onerror = () => resolve('refused');
    });
    return {
      json: await attempt({headers: {'Content-Type': 'application/json'}}),
      plain: await attempt({mode: 'no-cors', headers: {'Content-Type': 'text/plain'}}),
      socket,
    };
  }, daemon.url);
  assert.equal(results.socket, 'refused');
  assert.match(results.json, /^refused/);
  assert.notEqual((await daemon.status()).state, 'paused');
  await page.close();  // it was refused, which is a mistake for it
});

test('the page runs no script but its own files', async () => {
  const {page} = await openClassroom();
  const ran = await page.evaluate(() => {
    const script = document.createElement('script');
    script.textContent = 'globalThis.inline = 1';
    document.head.append(script);
    return globalThis.inline;
  });
  assert.equal(ran, undefined);
  await page.close();
});

test('who opens too many connections is refused, and nobody else is', async () => {
  const outer = Object.values(networkInterfaces()).flat().find(({internal, family}) => !internal && family === 'IPv4');
  assert.ok(outer, 'this test needs a network address besides loopback');
  const open = await startDaemon('classroom', '--no-render', '--host', '0.0.0.0', '--token', 'a-long-enough-token');
  const port = Number(new URL(open.url).port);
  const come = async (host) => {
    const socket = connect(port, host);
    await once(socket, 'connect');
    socket.write(`GET /api/scenarios HTTP/1.1\r\nHost: ${host}\r\n\r\n`);
    const [answer] = await once(socket, 'data');
    return String(answer);
  };
  for (let i = 0; i < 64; ++i) assert.match(await come(outer.address), /^HTTP\/1\.1 200 /);
  assert.match(await come(outer.address), /^HTTP\/1\.1 503 [^]*\r\nRetry-After: \d+\r\n/);
  await openPage(`http://127.0.0.1:${port}/`);
});

test('who has no token sends no large bodies', async () => {
  const outer = Object.values(networkInterfaces()).flat().find(({internal, family}) => !internal && family === 'IPv4');
  assert.ok(outer, 'this test needs a network address besides loopback');
  const open = await startDaemon('classroom', '--no-render', '--host', '0.0.0.0', '--token', 'a-long-enough-token');
  const announce = async (...headers) => {
    const socket = connect(Number(new URL(open.url).port), outer.address);
    await once(socket, 'connect');
    const lines = ['POST /api/call HTTP/1.1', `Host: ${outer.address}`, 'Content-Type: application/json', 'Content-Length: 2000000',
      'Expect: 100-continue', ...headers];
    socket.write(`${lines.join('\r\n')}\r\n\r\n`);
    const [answer] = await once(socket, 'data');
    socket.destroy();
    return String(answer);
  };
  assert.match(await announce(), /^HTTP\/1\.1 413 [^]*Authorization: Bearer TOKEN/);
  assert.match(await announce('Authorization: Bearer a-long-enough-token'), /^HTTP\/1\.1 100 /);
});

/** The page as seen from another machine: its daemon requires a token. */
async function openFromOutside() {
  const outer = Object.values(networkInterfaces()).flat().find(({internal, family}) => !internal && family === 'IPv4');
  assert.ok(outer, 'this test needs a network address besides loopback');
  const open = await startDaemon('classroom', '--no-render', '--host', '0.0.0.0', '--token', 'the-right-token');
  const address = new URL(open.url);
  address.hostname = outer.address;
  const page = await openPage(address.href);
  return {address, page};
}

test('from another machine the token unlocks the page, and a wrong one is told', async () => {
  const {address, page} = await openFromOutside();
  const says = (id, text) => page.waitForFunction(
    ([where, part]) => document.getElementById(where).textContent.includes(part), [id, text]);
  await page.waitForSelector('#locked', {state: 'visible'});
  await page.click('#pause');
  await says('message', 'press Unlock');
  await page.fill('#token', 'wrong');
  await page.click('#locked button');
  await says('token-answer', 'not the token');
  await page.fill('#token', 'the-right-token');
  await page.click('#locked button');
  await page.waitForSelector('#locked', {state: 'hidden'});
  assert.equal(await page.locator('#message.error').count(), 0);
  await page.reload();
  await page.waitForFunction(() => window.coopdyn?.connection.isOpen);
  await page.click('#pause');
  await page.waitForFunction(() => document.getElementById('state').textContent === 'paused');
  assert.ok(await page.locator('#locked').isHidden());
  await page.goto(new URL('?token=stale', address).href);
  await page.waitForSelector('#locked', {state: 'visible'});
  await says('token-answer', 'not the token');
  assert.equal(new URL(page.url()).search, '');
});

test('after too many wrong tokens the page tells how long to wait', async () => {
  const {page} = await openFromOutside();
  await page.fill('#token', 'wrong');
  for (let i = 0; i < 3; ++i) await page.click('#locked button');
  await hasText(page, '#token-answer', /wait 1 s/);
});
