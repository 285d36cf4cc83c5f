// SPDX-License-Identifier: MIT
// The page: puts its parts together and tells them the news.
import {Connection} from './connection.js';
import {Console} from './console.js';
import {Controls, showVersion} from './controls.js';
import {byId} from './dom.js';
import {Robots} from './robots.js';
import {Strip} from './strip.js';
import {View} from './view.js';

const connection = new Connection(new URLSearchParams(location.search).get('token') ?? '');
const strip = new Strip();
const controls = new Controls(connection);
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
  const unknown = robots.update(status);
  const now = performance.now();
  if (status && (status.scenario !== scenario || (unknown && now - lastRefresh > 2000))) {
    scenario = status.scenario;
    lastRefresh = now;
    refreshModules();
  }
});
connection.addEventListener('hello', ({detail}) => { byId('locked').hidden = detail.trusted; });
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
  connection.unlock(byId('token').value.trim());
});
