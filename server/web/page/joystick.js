// SPDX-License-Identifier: MIT
// The panel Drive: a pad for mouse and finger, keys and a gamepad drive one robot. The robot stops when they are released,
// when the focus is lost and when the page is hidden; then other clients may drive it.
import {byId, make, setText, showNumber} from './dom.js';
import {tab} from './layout.js';
import {t} from './words.js';

const CHANNEL = 'joystick';
const PERIOD_MS = 50;      // at most twenty commands a second
const ALIVE_MS = 500;      // repeats a constant command for the robot's watchdog
const DEAD = 0.12;         // dead zone of a gamepad's stick
const MOST_TURN = 2.5;     // rad/s
const USUAL = {linear: 0.5, angular: 1.5};  // if a robot does not report its limits

/** Keys: [axis, direction]. Axes: ahead, left, aside, up. */
const KEYS = {
  ArrowUp: ['ahead', 1], ArrowDown: ['ahead', -1], ArrowLeft: ['left', 1], ArrowRight: ['left', -1],
  w: ['ahead', 1], s: ['ahead', -1], a: ['left', 1], d: ['left', -1], q: ['aside', 1], e: ['aside', -1], r: ['up', 1], f: ['up', -1],
};

/** The axis that drives a command's value, by the value's name. */
const AXES = {
  linear: 'ahead', forward: 'ahead', vx: 'ahead', angular: 'left', turn: 'left', yaw: 'left', yaw_rate: 'left', wz: 'left',
  lateral: 'aside', left: 'aside', vy: 'aside', vertical: 'up', up: 'up', vz: 'up', climb: 'up',
};

/** The command that drives, and the axis of each value: {name, axes}; null if none. `commands`: of a `describe`. */
export function driveOf(commands) {
  const command = commands.find(({name}) => name === 'set_velocity');
  const axes = command?.data.map(({name}) => AXES[name] ?? null) ?? [];
  return axes.includes('ahead') ? {name: command.name, axes} : null;
}

/** The deflection of a gamepad's stick, without its dead zone. */
export const pushOf = (value) => (Math.abs(value) < DEAD ? 0 : Math.sign(value) * (Math.abs(value) - DEAD) / (1 - DEAD));

/** Sends the newest velocity to one module, at most twenty times a second and only after the last reply. */
class Driver {
  #connection;
  #module;
  #onReply;
  #wanted = null;  // {data}; data null: stop and release the robot
  #busy = false;
  #sentAt = -Infinity;
  #named = false;
  #drives = false;
  #alive = 0;  // the timer that repeats the command

  constructor(connection, module, onReply) {
    this.#connection = connection;
    this.#module = module;
    this.#onReply = onReply;
  }

  want(command, data) {
    this.#wanted = {command, data};
    this.#run();
  }

  /** Stops at once, even while the page is being hidden. */
  stop() {
    if (!this.#drives && !this.#wanted && !this.#busy) return;
    this.#wanted = {command: 'stop', data: null};
    this.#run();
  }

  close() {
    this.stop();
    this.#connection.send({type: 'close', module: this.#module, channel: CHANNEL});
    this.#named = this.#drives = false;
  }

  #call(request) { return this.#connection.call({module: this.#module, channel: CHANNEL, ...request}); }

  async #run() {
    if (this.#busy) return;
    this.#busy = true;
    while (this.#wanted) {
      const {data} = this.#wanted;
      const wait = this.#sentAt + PERIOD_MS - performance.now();
      if (data && wait > 0) {
        await new Promise((resolve) => setTimeout(resolve, wait));
        continue;  // there may be a newer command
      }
      const {command} = this.#wanted;
      this.#wanted = null;
      if (data) await this.#drive(command, data);
      else await this.#letGo();
    }
    this.#busy = false;
  }

  async #drive(command, data) {
    if (!this.#named) {  // a robot stops when it loses a named client
      const name = `joystick-${Math.random().toString(36).slice(2, 7)}`;
      this.#named = (await this.#call({command: 'hello', text: name})).error === 0;
    }
    this.#sentAt = performance.now();
    const reply = await this.#call({command, data});
    this.#drives = reply.error === 0;
    if (this.#drives) this.#stayAlive();
    if (reply.error !== 0) this.#named = this.#named && reply.error !== -1;
    this.#onReply(reply);
  }

  #stayAlive() {
    clearTimeout(this.#alive);
    this.#alive = setTimeout(async () => {
      if (this.#drives && (await this.#call({command: 'ping'})).error === 0) this.#stayAlive();
    }, ALIVE_MS);
  }

  async #letGo() {
    if (!this.#drives) return;
    this.#drives = false;
    const stopped = this.#call({command: 'stop'});
    const released = this.#call({command: 'release'});
    const reply = await stopped;
    await released;
    this.#onReply(reply.error === 0 ? null : reply);
  }
}

export class Joystick {
  #connection;
  #status = null;
  #robot = '';
  #module = '';
  #drive = null;    // {name, axes}
  #driver = null;
  #most = USUAL;
  #keys = new Set();
  #push = {ahead: 0, left: 0, aside: 0, up: 0};
  #pointer = null;
  #padding = 0;     // the animation frame requested for the gamepad
  #box = make('details', {id: 'joystick', class: 'panel'});
  #robots = make('select', {id: 'joystick-robot', 'aria-label': t('Robot to drive')});
  #knob = make('span', {class: 'knob'});
  #pad = make('div', {id: 'joystick-pad', tabIndex: 0, role: 'application',
    'aria-label': t('Pad: drag, or arrow keys or W A S D; let go to stop')}, this.#knob);
  #share = make('input', {id: 'joystick-speed', type: 'range', min: 5, max: 100, value: 40, 'aria-label': t('Speed in percent of the maximum')});
  #speed = make('span', {class: 'number'});
  #owner = make('p', {id: 'joystick-owner', class: 'quiet'});
  #said = make('p', {id: 'joystick-said', role: 'alert'});
  #gamepad = make('p', {id: 'joystick-gamepad', class: 'quiet', hidden: true});

  constructor(connection) {
    this.#connection = connection;
    this.#box.append(make('summary', {}, t('Drive')), make('div', {class: 'joystick'}, this.#pad,
      make('div', {class: 'joystick-side'}, make('div', {class: 'row'}, this.#robots), make('label', {}, this.#share, this.#speed),
        this.#owner, this.#said, this.#gamepad)));
    const panel = tab('robots', t('Lesson'));
    panel.insertBefore(this.#box, byId('robots-title')?.closest('.panel') ?? null);
    this.#listen(panel);
  }

  /** Drives this robot from now on. */
  choose(name) {
    if (name === this.#robot || ![...this.#robots.options].some(({value}) => value === name)) return;
    this.#robots.value = name;
    this.#take(name);
  }

  update(status) {
    this.#status = status;
    const names = status.robots.map(({name}) => name);
    if (JSON.stringify(names) !== JSON.stringify([...this.#robots.options].map(({value}) => value))) {
      this.#robots.replaceChildren(...names.map((name) => make('option', {value: name}, name)));
      if (names.includes(this.#robot)) this.#robots.value = this.#robot;
      else this.#take(names[0] ?? '');
    }
    if (!this.#box.open) return;
    if (!this.#drive && !this.#learning) this.#learn();
    const robot = status.robots.find(({name}) => name === this.#robot);
    const owner = robot?.owner ?? '';
    setText(this.#owner, status.playback ? t('A recording is played: nothing drives it') : owner ? t('driven by {owner}', {owner}) : t('nobody drives it'));
  }

  #listen(panel) {
    this.#robots.addEventListener('change', () => this.#take(this.#robots.value));
    this.#box.addEventListener('toggle', () => (this.#box.open ? this.#learn() : this.#rest()));
    this.#share.addEventListener('input', () => this.#apply());
    const pad = this.#pad;
    pad.addEventListener('pointerdown', (event) => {
      pad.setPointerCapture(event.pointerId);
      this.#pointer = event.pointerId;
      this.#point(event);
    });
    pad.addEventListener('pointermove', (event) => { if (event.pointerId === this.#pointer) this.#point(event); });
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      pad.addEventListener(end, (event) => { if (event.pointerId === this.#pointer) this.#rest(); });
    }
    pad.addEventListener('keydown', (event) => this.#key(event, true));
    pad.addEventListener('keyup', (event) => this.#key(event, false));
    pad.addEventListener('blur', () => this.#rest());
    panel.addEventListener('hidden', () => this.#rest());
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.#rest(); });
    addEventListener('blur', () => this.#rest());
    addEventListener('pagehide', () => this.#rest());
    addEventListener('gamepadconnected', ({gamepad}) => {
      setText(this.#gamepad, t('gamepad: {gamepad}; its left stick drives while this page has the focus', {gamepad: gamepad.id}));
      this.#gamepad.hidden = false;
      if (!this.#padding) this.#readGamepad();
    });
    addEventListener('gamepaddisconnected', () => {
      this.#gamepad.hidden = true;
      cancelAnimationFrame(this.#padding);
      this.#padding = 0;
      this.#rest();
    });
    this.#connection.addEventListener('open', () => this.#take(this.#robot));
  }

  #take(name) {
    this.#rest();
    this.#driver?.close();
    this.#driver = this.#drive = null;
    this.#robot = name;
    this.#say('');
    if (this.#box.open) this.#learn();
  }

  #learning = false;

  /** Asks for the command that drives the robot, and its limits. */
  async #learn() {
    const name = this.#robot;
    const modules = this.#status?.robots.find((robot) => robot.name === name)?.modules ?? [];
    if (!name || this.#drive || this.#learning) return;
    this.#learning = true;
    const wheels = modules.filter(({type}) => type === 'motors');
    for (const {name: module} of wheels.length > 0 ? wheels : modules.filter(({type}) => type !== 'joints')) {
      const ask = (command) => this.#connection.call({module, channel: 'describe', command});
      const [described, limits] = await Promise.all([ask('describe'), ask('get_limits')]);
      this.#connection.send({type: 'close', module, channel: 'describe'});
      const drive = described.error === 0 ? driveOf(JSON.parse(described.text).commands) : null;
      if (!drive || name !== this.#robot) continue;
      this.#drive = drive;
      this.#module = module;
      this.#most = USUAL;
      const [wheelSpeed, radius, track] = limits.error === 0 ? limits.data : [];
      if (wheelSpeed > 0 && radius > 0 && track > 0) {
        const linear = wheelSpeed * radius;
        this.#most = {linear, angular: Math.min(MOST_TURN, 2 * linear / track)};
      }
      this.#driver = new Driver(this.#connection, module, (reply) => this.#onReply(reply));
      break;
    }
    this.#learning = false;
    if (name !== this.#robot) return this.#learn();
    const why = this.#drive ? '' : t('{name} has no wheels to drive: move its joints by the sliders of its card, or load a controller', {name});
    setText(this.#said, why);
    this.#showSpeed();
  }

  #showSpeed() {
    const share = Number(this.#share.value) / 100;
    setText(this.#speed, this.#drive ? `${showNumber(share * this.#most.linear, 2)} m/s, ${showNumber(share * this.#most.angular, 1)} rad/s` : '');
  }

  #point(event) {
    const {left, top, width, height} = this.#pad.getBoundingClientRect();
    const x = 2 * (event.clientX - left) / width - 1, y = 2 * (event.clientY - top) / height - 1;
    const far = Math.max(1, Math.hypot(x, y));
    Object.assign(this.#push, {ahead: -y / far, left: -x / far});
    this.#apply();
  }

  #key(event, down) {
    if (event.key === ' ' && down) {
      event.preventDefault();
      return this.#rest();
    }
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!(key in KEYS) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (down) this.#keys.add(key);
    else this.#keys.delete(key);
    for (const axis of Object.keys(this.#push)) {
      const push = [...this.#keys].reduce((sum, one) => sum + (KEYS[one][0] === axis ? KEYS[one][1] : 0), 0);
      this.#push[axis] = Math.max(-1, Math.min(1, push));
    }
    this.#apply();
  }

  #readGamepad() {
    this.#padding = requestAnimationFrame(() => this.#readGamepad());
    if (!this.#box.open || this.#pointer !== null || this.#keys.size > 0 || !document.hasFocus()) return;
    const gamepad = navigator.getGamepads().find(Boolean);
    if (!gamepad) return;
    const [x = 0, y = 0, aside = 0, up = 0] = gamepad.axes;
    const push = {ahead: -pushOf(y), left: -pushOf(x), aside: -pushOf(aside), up: -pushOf(up)};
    const before = JSON.stringify(this.#push);
    Object.assign(this.#push, push);
    if (JSON.stringify(this.#push) !== before) this.#apply();
  }

  /** Releases all axes. */
  #rest() {
    this.#pointer = null;
    this.#keys.clear();
    for (const axis of Object.keys(this.#push)) this.#push[axis] = 0;
    this.#apply();
  }

  #apply() {
    const {ahead, left} = this.#push;
    this.#knob.style.left = `${50 - 50 * left}%`;
    this.#knob.style.top = `${50 - 50 * ahead}%`;
    this.#showSpeed();
    if (!this.#driver) return;
    if (Object.values(this.#push).every((push) => push === 0)) return this.#driver.stop();
    if (this.#status?.playback) return this.#say(t('a recording is played: nothing drives its robots'), true);
    const share = Number(this.#share.value) / 100;
    this.#driver.want(this.#drive.name, this.#drive.axes.map((axis) =>
      (axis ? share * this.#push[axis] * (axis === 'left' ? this.#most.angular : this.#most.linear) : 0)));
  }

  #say(text, isError = false) {
    setText(this.#said, text);
    this.#said.classList.toggle('error', isError);
  }

  /** `reply`: null if the robot was released. */
  #onReply(reply) {
    if (reply === null) return this.#say(t('stopped'));
    this.#say(reply.text, reply.error !== 0);
    if (reply.error === 0 && !reply.text) setText(this.#said, t('you drive'));
  }
}
