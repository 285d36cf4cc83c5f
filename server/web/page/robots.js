// SPDX-License-Identifier: MIT
// The list of robots: their clients, modules and addresses, and live readings of open cards.
import {connectionLines} from './lines.js';
import {byId, icon, make, say, setOff, setText} from './dom.js';
import {Readings} from './readings.js';
import {VirtualList} from './virtual_list.js';
import {t} from './words.js';

const MAX_OPEN = 6;  // robots whose readings are shown at once
const ROBOTS_AT_ONCE = 256;
const FEW = 20;         // more robots have rows of equal height, and a search
const MOST_ASKED = 64;  // robots in an answer
const ASK_MS = 500;

/** The last word of "/robot1/motors". */
const lastWord = (name) => name.slice(name.lastIndexOf('/') + 1);

class Card {
  #connection;
  #name;
  #readings = null;
  #owner = make('span', {class: 'owner'});
  #release;
  #body = make('div', {class: 'card-body'});
  #place = make('div', {class: 'readings-place'});
  #read = '';  // the modules of the current readings
  #modules = [];
  #lines = '';  // the key of the current body
  #type = '';
  #namePort = 0;
  #off = '';  // why the robot cannot be driven; empty if it can
  element;

  constructor(connection, name, onToggle) {
    this.#connection = connection;
    this.#name = name;
    this.#release = make('button', {type: 'button', title: t('Close the connection of whoever drives it')}, t('Free'));
    this.#release.addEventListener('click', (event) => {
      event.preventDefault();
      this.#free();
    });
    const summary = make('summary', {}, make('strong', {}, name), this.#owner, this.#release);
    this.element = make('details', {class: 'card'}, summary, this.#body);
    this.element.dataset.robot = name;
    this.element.addEventListener('toggle', () => onToggle(this));
  }

  get isOpen() { return this.element.open; }

  /** `off`: why the robot cannot be driven; empty if it can. */
  update(robot, namePort, off) {
    this.#off = off;
    const owner = robot.owner ?? '';
    const astray = !owner && robot.still_moving === true;
    const stopped = robot.watchdog_stopped === true;
    const silence = (robot.silent_s >= 1 ? `, ${t('silent for {seconds} s', {seconds: Math.floor(robot.silent_s)})}` : '') +
      (stopped ? `, ${t('stopped until its next command')}` : '');
    const excuse = robot.participates === false ? ` ${t('(not waited for)')}` : '';
    this.#owner.title = owner && owner + silence;
    setText(this.#owner, (owner ? owner + silence : astray ? t('nobody drives it, still moving') : t('nobody drives it')) + excuse);
    this.#owner.classList.toggle('quiet', !owner && !astray);
    this.#owner.classList.toggle('warning', astray || stopped);
    this.#release.hidden = !owner;
    this.#type = robot.type ?? '';
    this.#modules = robot.modules ?? [];
    this.#namePort = namePort;
    if (this.isOpen) this.fill();
  }

  /** Makes the body and the readings if they are missing or outdated. */
  fill() {
    const lines = JSON.stringify([this.#type, this.#modules, this.#namePort]);
    if (this.#lines === lines) return this.#startReadings();
    this.#lines = lines;
    const address = (module) => (module.port > 0 ? `${location.hostname}:${module.port}` : t('by OPEN'));
    const rows = this.#modules.map((module) =>
      make('tr', {}, make('td', {}, module.name), make('td', {class: 'number'}, address(module))));
    const open = this.#body.querySelector('.connect')?.open ?? false;
    this.#body.replaceChildren(
      make('p', {class: 'quiet'}, this.#type),
      this.#place,
      make('details', {class: 'connect', open}, make('summary', {}, icon('plug'), t('Connect a program')),
        connectionLines(this.#name, this.#modules, this.#namePort),
        make('details', {class: 'addresses'}, make('summary', {}, t('Addresses of its modules')),
          make('table', {class: 'modules'}, make('tbody', {}, ...rows)))));
    this.#startReadings();
  }

  /** Keeps the readings if only ports have changed. */
  #startReadings() {
    const modules = this.#modules.map(({name, type}) => ({name: lastWord(name), type}));
    const read = JSON.stringify([this.#type, modules]);
    if (this.#read !== read) this.stopReadings();
    this.#read = read;
    if (!this.#readings && modules.length > 0) {
      this.#readings = new Readings(this.#connection, this.#name, modules);
      this.#place.replaceChildren(this.#readings.element);
    }
    this.#readings?.setOff(this.#off);
  }

  stopReadings() {
    this.#readings?.stop();
    this.#readings = null;
  }

  async #free() {
    const reply = await this.#connection.call({module: '/simulation', command: 'release_robot', text: this.#name});
    say(reply.error === 0 ? t('{name} is free', {name: this.#name}) : reply.text, reply.error !== 0);
  }
}

export class Robots {
  #connection;
  #list;
  #cards = new Map();  // those in the page, by name
  #namePort = 0;
  #open = new Map();  // by robot, even a removed one: whether its card was left open
  #byItself = '';  // the robot whose card was opened automatically
  #touched = false;  // the user has opened or closed a card
  #status = null;
  #others = new Map();  // robots that the status does not list, by number
  #asking = false;
  #names = null;  // of all robots, for the search
  #found = null;  // the numbers of the robots that match the search; null: all
  #run = '';      // the world, in which robots keep their numbers

  constructor(connection) {
    this.#connection = connection;
    this.#list = new VirtualList(byId('robots'), (row) => this.#row(row));
    for (const id of ['only-connected', 'go-on']) byId(id).addEventListener('click', () => this.#waitOnlyForConnected());
    byId('all-participants').addEventListener('click', () => this.#setParticipants(''));
    byId('robot-search').addEventListener('input', () => this.#search());
    document.addEventListener('scroll', () => this.#place(), {capture: true, passive: true});
    addEventListener('resize', () => this.#place());
  }

  setNamePort(port) { this.#namePort = port; }

  update(status) {
    const {robot_count: count, scenario, revision} = status, run = JSON.stringify([scenario, count, revision]);
    this.#status = status;
    byId('robot-search').hidden = count < FEW;
    byId('robots').classList.toggle('many', count >= FEW);
    if (this.#run !== run) {
      this.#run = run;
      this.#names = null;
      this.#others.clear();
      this.#found = null;  // its numbers are those of the other world
      this.#list.reset(count);
      this.#search();
    }
    this.#list.count = this.#found?.length ?? count;
    this.#place();
    byId('participants').hidden = status.mode !== 'lockstep';
    const off = status.playback ? t('A recording has nobody to wait for') : '';
    setOff('only-connected', off, t('Only robots that a client drives now take part'));
    setOff('all-participants', off, t('As the scenario says'));
  }

  #robotAt(number) { return this.#status.robots[number] ?? this.#others.get(number); }

  /** Shows and updates the cards near the visible part; asks for robots that the status does not list. */
  #place() {
    if (!this.#status) return;
    const {robot_count: count} = this.#status;
    setText(byId('robot-count'), this.#found ? t('{n} of {all}', {n: this.#found.length, all: count}) : `${count}`);
    const [first, end] = this.#list.place();
    const shown = new Set(), missing = [];
    for (let row = first; row < end; ++row) {
      const number = this.#found ? this.#found[row] : row, robot = this.#robotAt(number);
      if (number >= this.#status.robots.length) missing.push(number);
      if (!robot) continue;
      shown.add(robot.name);
      this.#cards.get(robot.name)?.update(robot, this.#namePort, this.#status.playback ? t('A recording is played: nothing drives it') : '');
    }
    for (const [name, card] of this.#cards) {
      if (shown.has(name)) continue;
      card.stopReadings();
      this.#cards.delete(name);
    }
    if (missing.length > 0) this.#ask(missing);
  }

  /** The card of a row; a place for it as long as the robot is unknown. */
  #row(row) {
    const number = this.#found ? this.#found[row] : row, robot = this.#robotAt(number);
    if (!robot) return make('div', {class: 'card'}, make('div', {class: 'summary'}, this.#names?.[number] ?? '…'));
    if (!this.#cards.has(robot.name)) this.#add(robot.name, number);
    return this.#cards.get(robot.name).element;
  }

  /** Asks for these robots (ascending numbers), neighbours at once. */
  async #ask(numbers) {
    if (this.#asking) return;
    this.#asking = true;
    const run = this.#run;
    for (let at = 0; at < numbers.length;) {
      let end = at + 1;
      while (end < numbers.length && numbers[end] - numbers[at] < MOST_ASKED) ++end;
      const first = numbers[at] + 1, reply = await this.#connection.call(
        {module: '/simulation', command: 'get_status', params: [first, numbers[end - 1] - numbers[at] + 1]});
      if (reply.error === 0 && run === this.#run) JSON.parse(reply.text).robots.forEach((robot, i) => this.#others.set(numbers[at] + i, robot));
      at = end;
    }
    setTimeout(() => { this.#asking = false; }, ASK_MS);
    this.#place();
  }

  #searched() { return byId('robot-search').hidden ? '' : byId('robot-search').value.trim().toLowerCase(); }

  /** Shows the robots whose names contain the text. */
  async #search() {
    const run = this.#run;
    if (this.#searched()) await this.#learnNames();
    const text = this.#searched();  // it may have changed meanwhile
    if (run !== this.#run || (text && !this.#names)) return;  // the banner shows that the daemon is gone
    this.#found = text ? this.#names.flatMap((name, number) => (name.toLowerCase().includes(text) ? [number] : [])) : null;
    this.#list.reset(this.#found?.length ?? this.#status.robot_count);
    this.#place();
  }

  async #learnNames() {
    const {robots, robot_count: count} = this.#status, run = this.#run;
    if (count <= robots.length) this.#names = robots.map(({name}) => name);
    if (this.#names) return;
    const names = await fetch('api/scene').then((answer) => answer.json()).then((scene) => scene.robots.map(({name}) => name), () => null);
    if (run === this.#run) this.#names = names;  // else another world was loaded meanwhile
  }

  /** Opens the first card automatically until the user opens or closes one; then restores each card's last state. */
  #add(name, number) {
    const card = new Card(this.#connection, name, (toggled) => this.#toggled(name, toggled));
    if (!this.#touched && number === 0) this.#byItself = name;
    card.element.open = this.#touched ? this.#open.get(name) ?? false : name === this.#byItself;
    this.#cards.set(name, card);
    const robot = this.#robotAt(number);
    card.update(robot, this.#namePort, this.#status.playback ? t('A recording is played: nothing drives it') : '');
  }

  /** Opens a robot's card and scrolls it into view. */
  async reveal(name) {
    await this.#learnNames();
    const number = (this.#names ?? []).indexOf(name), row = this.#found ? this.#found.indexOf(number) : number;
    if (row < 0) return;
    if (!this.#cards.has(name)) {
      this.#touched = true;
      this.#open.set(name, true);
      this.#list.reveal(row);
      return this.#place();
    }
    const {element} = this.#cards.get(name);
    element.open = true;
    element.scrollIntoView({block: 'nearest'});
  }

  #toggled(name, card) {
    if (this.#cards.get(name) !== card) return;  // removed meanwhile
    if (!card.isOpen || name !== this.#byItself) this.#touched = true;
    this.#open.set(name, card.isOpen);
    if (card.isOpen) {
      const others = [...this.#cards.values()].filter((other) => other.isOpen && other !== card);
      if (others.length >= MAX_OPEN) others[0].element.open = false;
      card.fill();
    } else {
      card.stopReadings();
    }
    this.#place();
  }

  async #waitOnlyForConnected() {
    const connected = await this.#connectedRobots();
    if (!connected) return;
    if (connected.length === 0) {
      return say(t('no robot has a client yet: connect one first, or choose another mode under Time'), true);
    }
    this.#setParticipants(connected.join(' '));
  }

  /** The names of all robots that clients drive; null after an error. A status lists 256 robots at a time. */
  async #connectedRobots() {
    const connected = [];
    for (let first = 1, count = 1; first <= count; first += ROBOTS_AT_ONCE) {
      const reply = await this.#connection.call({module: '/simulation', command: 'get_status', params: [first, ROBOTS_AT_ONCE]});
      if (reply.error !== 0) {
        say(reply.text, true);
        return null;
      }
      const status = JSON.parse(reply.text);
      count = status.robot_count;
      connected.push(...status.robots.filter((robot) => robot.owner && !robot.controller).map((robot) => robot.name));
    }
    return connected;
  }

  async #setParticipants(text) {
    const reply = await this.#connection.call({module: '/simulation', command: 'set_participants', text});
    if (reply.error !== 0) say(reply.text, true);
    else say(text ? t('lockstep waits for {robots}', {robots: text}) : t('lockstep waits for the robots that the scenario names'));
  }
}
