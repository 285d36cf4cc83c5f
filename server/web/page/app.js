// SPDX-License-Identifier: MIT
// The page: puts its parts together and tells them the news.
import {Connection} from './connection.js';
import {Console} from './console.js';
import {Controls, showVersion} from './controls.js';
import {byId, say, setText} from './dom.js';
import {Record} from './record.js';
import {Robots} from './robots.js';
import {Runs} from './runs.js';
import {Strip} from './strip.js';
import {keepToken, rememberedToken} from './token.js';
import {View} from './view.js';

const connection = new Connection(rememberedToken());
const strip = new Strip();
const controls = new Controls(connection);
const record = new Record(connection);
const runs = new Runs();
const robots = new Robots(connection);
const lines = new Console(connection);
new View(connection);

let asking = false;
async function refreshModules() {
  if (asking) return;
  asking = true;
  try {
    const answer = await (await fetch('api/modules')).json();
    robots.setModules(answer.modules, answer.name_port);
    lines.setModules(answer.modules);
    showVersion(answer.version);
    await controls.refreshScenarios();
  } catch { /* the daemon is gone: the banner says so */ }
  asking = false;
}

let scenario;
let lastRefresh = 0;
connection.addEventListener('status', ({detail: status}) => {
  strip.update(status);
  controls.update(status);
  record.update(status);
  runs.update(status);
  const unknown = robots.update(status);
  const now = performance.now();
  if (status && (status.scenario !== scenario || (unknown && now - lastRefresh > 2000))) {
    scenario = status.scenario;
    lastRefresh = now;
    refreshModules();
  }
});
let unlocking = false;
connection.addEventListener('hello', ({detail}) => {
  // A token that was kept is on its way when the daemon greets: nothing is asked before it is answered.
  const underWay = connection.token !== '' && !detail.wrong_token;
  byId('locked').hidden = detail.trusted || underWay;
  setText(byId('token-answer'), detail.wrong_token ? 'This is not the token: look again at what the daemon printed.' : '');
  if (detail.wrong_token) {
    connection.forgetToken();
    keepToken('');
    if (unlocking) byId('token').select();
  } else if (detail.trusted) {
    if (connection.token) keepToken(connection.token);
    if (unlocking) say('unlocked');
    byId('token').value = '';
  } else if (underWay) {
    return;
  }
  unlocking = false;
});
connection.addEventListener('open', () => {
  byId('lost').hidden = true;
  scenario = undefined;
});
connection.addEventListener('lost', () => {
  byId('lost').hidden = false;
  strip.update(null);
});
byId('locked').addEventListener('submit', (event) => {
  event.preventDefault();
  const token = byId('token').value.trim();
  if (!token) return setText(byId('token-answer'), 'Enter the token first.');
  unlocking = true;
  connection.unlock(token);
});
