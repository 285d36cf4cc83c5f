// SPDX-License-Identifier: MIT
// The page: creates its parts and forwards the daemon's events to them.
import {Connection} from './connection.js';
import {Console} from './console.js';
import {Controls, showVersion} from './controls.js';
import {Costs} from './costs.js';
import {byId, disableAll, say, setText} from './dom.js';
import {Dropped} from './dropped.js';
import {Editor} from './editor.js';
import {Film} from './film.js';
import {Gallery} from './gallery.js';
import {Joystick} from './joystick.js';
import {isShown, startLayout, tab} from './layout.js';
import {ofType} from './lines.js';
import {Links} from './links.js';
import {People} from './people.js';
import {Plots} from './plots.js';
import {Record, Runs} from './recordings.js';
import {Robots} from './robots.js';
import {Scores} from './scores.js';
import {ask, askHost, isAwake, SEAT} from './seat.js';
import {Strip} from './strip.js';
import {StripHistory} from './strip_history.js';
import {Task} from './task.js';
import {Timeline} from './timeline.js';
import {keepToken, rememberedToken} from './token.js';
import {View} from './view.js';
import {t} from './words.js';
import {World} from './world.js';

startLayout();
for (const [id, title] of [['world', t('World')], ['arena', t('Gallery')], ['plots', t('Plots')], ['runs', t('Recordings')], ['text', t('Text')], ['cost', t('Speed')]]) tab(id, title);
const connection = new Connection(rememberedToken(), SEAT ? isAwake : undefined);
const bar = SEAT ? import('./class.js').then(({ClassBar}) => new ClassBar(connection)) : null;
const OWN_MS = 1500;
const strip = new Strip((deed) => { if (!people.isOwn(deed) && performance.now() - connection.actedAt > OWN_MS) say(deed); });
const rates = new StripHistory();
const controls = new Controls(connection);
const editor = new Editor(connection, controls);
const gallery = new Gallery(controls, (kind, name) => editor.open(kind, name));
const dropped = new Dropped(connection, controls, gallery);
const links = new Links(connection, controls);
const people = new People(connection);
if (SEAT) askHost().then(({name}) => people.call(SEAT.teaches ? t('Teacher') : name), () => {});
const record = new Record(connection);
const timeline = new Timeline(connection);
const runs = new Runs(connection, timeline);
const plots = new Plots(connection, timeline);
const costs = new Costs();
const joystick = new Joystick(connection);
const robots = new Robots(connection);
const lines = new Console(connection);
const scores = new Scores();
const task = new Task();

/** The view drawn by the browser; without WebGL, or with ?view=server, the daemon's pictures. */
async function openView() {
  if (new URLSearchParams(location.search).get('view') !== 'server') {
    try {
      const {View3d, webGl} = await import('./view3d.js');
      const quality = webGl();
      if (quality !== 'none') return new View3d(connection, quality);
    } catch { /* fall back to the daemon's pictures */ }
  }
  return new View(connection);
}
openView().then(async (view) => {
  const world = new World(connection, view);
  window.coopdyn = {view, connection, world, plots, editor};  // for tests, and for the curious
  window.coopdyn.film = new Film(view);
  bar?.then(({program}) => { window.coopdyn.program = program; });
  if (!view.controls) return;
  view.addEventListener('select', ({detail}) => people.select(detail?.name ?? ''));
  gallery.setWorld(world);
  dropped.setWorld(world);
  view.addEventListener('select', ({detail}) => { if (detail?.kind === 'robot') joystick.choose(detail.name); });
  view.addEventListener('select', ({detail}) => { if (detail?.kind === 'robot' && isShown('robots')) robots.reveal(detail.name); });
  const [{Handles}, {Ghost}, {ViewMarks}, {DragShadow}] = await Promise.all(
    [import('./handles.js'), import('./ghost.js'), import('./view_marks.js'), import('./drag_shadow.js')]);
  window.coopdyn.shadow = new DragShadow(view);
  world.setShadow(window.coopdyn.shadow);
  runs.setGhost(new Ghost(view));
  window.coopdyn.marks = new ViewMarks(view, connection);
  window.coopdyn.handles = new Handles(view, world, (text, title, act) => view.addTool(text, title, act));
});

const RETRY_MS = 2000;
let asked = 0;
async function refreshModules(listed) {
  const turn = ++asked;
  try {
    const host = SEAT ? await askHost() : null;
    const answer = await (await ask('api/modules')).json();
    const namePort = host?.names ?? answer.name_port;
    if (turn !== asked) return;  // a later request is pending
    robots.setNamePort(namePort);
    lines.setModules(answer.modules, listed.map((robot) => ofType(robot.modules, 'motors')).find(Boolean)?.name, namePort);
    showVersion(answer.version);
    await controls.refreshScenarios();
  } catch {  // the banner shows that the daemon is gone
    if (turn === asked) setTimeout(() => { known = ''; }, RETRY_MS);
  }
}

/** The key of the list of modules, to detect changes. The daemon adds all modules of a scene between two statuses, so the robots
 *  listed in a status (the first 256) suffice. */
const moduleKey = ({scenario, robot_count: count, robots: listed}) =>
  JSON.stringify([scenario, count, listed.map((robot) => robot.modules.map(({name, port}) => [name, port]))]);

let known = '';
connection.addEventListener('status', ({detail: status}) => {
  strip.update(status);
  controls.update(status);
  if (!status) return;  // the other parts keep their last state
  scores.update(status);
  task.update(status);
  timeline.update(status.playback);
  if (greeted) links.follow(status);
  plots.update(status);
  gallery.update(status);
  editor.update(status);
  record.update(status);
  runs.update(status);
  robots.update(status);
  joystick.update(status);
  rates.update(status);
  costs.update(status);
  const key = moduleKey(status);
  if (key === known) return;
  known = key;
  refreshModules(status.robots);
});
connection.addEventListener('silence', () => strip.update(null));
let unlocking = false;
let greeted = false;  // and this page's rights are settled
connection.addEventListener('hello', ({detail}) => {
  // A kept token is in transit when the daemon greets: do not ask for one before its answer.
  const underWay = connection.token !== '' && !detail.wrong_token;
  byId('view-only').hidden = detail.read_only !== true;
  disableAll(detail.read_only ? byId('view-only').title : '');
  byId('locked').hidden = detail.trusted || underWay || detail.read_only === true;
  const no = detail.token_wait ?? t('This is not the token: look again at what the daemon printed.');
  setText(byId('token-answer'), detail.wrong_token ? no : '');
  if (detail.wrong_token) {
    connection.forgetToken();
    keepToken('');
    if (unlocking) byId('token').select();
  } else if (detail.trusted) {
    if (connection.token) keepToken(connection.token);
    if (unlocking) say(t('unlocked'));
    byId('token').value = '';
  } else if (underWay) {
    return;
  }
  unlocking = false;
  greeted = true;
});
connection.addEventListener('open', () => {
  byId('lost').hidden = true;
  known = '';
});
connection.addEventListener('lost', () => {
  byId('lost').hidden = false;
  strip.update(null);
});
byId('locked').addEventListener('submit', (event) => {
  event.preventDefault();
  const token = byId('token').value.trim();
  if (!token) return setText(byId('token-answer'), t('Enter the token first.'));
  unlocking = true;
  connection.unlock(token);
});
