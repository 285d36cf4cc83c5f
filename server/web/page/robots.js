// SPDX-License-Identifier: MIT
// The list of robots: who drives them, their modules and addresses, live readings of those that are open.
import {connectionLines} from './lines.js';
import {byId, make, say, setText} from './dom.js';
import {Readings} from './readings.js';

const MAX_OPEN = 6;  // robots whose readings are shown at once

/** The last word of "/robot1/motors". */
const lastWord = (name) => name.slice(name.lastIndexOf('/') + 1);

class Card {
  #connection;
  #name;
  #readings = null;
  #owner = make('span', {class: 'owner'});
  #release;
  #body = make('div', {class: 'card-body'});
  #modules = [];
  element;

  constructor(connection, name, color, onToggle) {
    this.#connection = connection;
    this.#name = name;
    this.#release = make('button', {type: 'button', title: 'Close the connection of whoever drives it'}, 'Free');
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
  get owner() { return this.#owner.dataset.owner ?? ''; }

  update(robot, modules, namePort) {
    const owner = robot.owner ?? '';
    this.#owner.dataset.owner = owner;
    const excuse = robot.participates === false ? ' (not waited for)' : '';
    setText(this.#owner, (owner || 'nobody drives it') + excuse);
    this.#owner.classList.toggle('quiet', !owner);
    this.#release.disabled = !owner;
    const key = JSON.stringify([modules, namePort]);
    if (this.element.dataset.key === key) return;
    this.element.dataset.key = key;
    this.#modules = modules;
    this.#fill(robot.type ?? '', namePort);
  }

  #fill(type, namePort) {
    const address = (module) => (module.port > 0 ? `${module.address ?? location.hostname}:${module.port}` : 'by OPEN');
    const rows = this.#modules.map((module) =>
      make('tr', {}, make('td', {}, module.name), make('td', {class: 'number'}, address(module))));
    this.#body.replaceChildren(
      make('p', {class: 'quiet'}, type),
      make('div', {class: 'readings-place'}),
      make('table', {class: 'modules'}, make('tbody', {}, ...rows)),
      connectionLines(this.#name, this.#modules, namePort));
    this.stopReadings();
    if (this.isOpen) this.startReadings();
  }

  startReadings() {
    if (this.#readings || this.#modules.length === 0) return;
    this.#readings = new Readings(this.#connection, this.#name, this.#modules.map((module) => lastWord(module.name)));
    this.#body.querySelector('.readings-place')?.replaceChildren(this.#readings.element);
  }

  stopReadings() {
    this.#readings?.stop();
    this.#readings = null;
  }

  async #free() {
    const reply = await this.#connection.call({module: '/simulation', command: 'release_robot', text: this.#name});
    say(reply.error === 0 ? `${this.#name} is free` : reply.text, reply.error !== 0);
  }
}

export class Robots {
  #connection;
  #cards = new Map();
  #modules = new Map();  // by robot
  #namePort = 0;
  #touched = false;  // somebody has opened or closed a card

  constructor(connection) {
    this.#connection = connection;
    byId('only-connected').addEventListener('click', () => this.#waitOnlyForConnected());
    byId('all-participants').addEventListener('click', () => this.#setParticipants(''));
  }

  setModules(modules, namePort) {
    this.#namePort = namePort;
    this.#modules.clear();
    for (const module of modules) {
      const [, robot, rest] = module.name.split('/');
      if (!rest || module.external) continue;
      if (!this.#modules.has(robot)) this.#modules.set(robot, []);
      this.#modules.get(robot).push(module);
    }
  }

  /** True if the daemon has robots that setModules() did not know. */
  update(status) {
    const robots = status?.robots ?? [];
    setText(byId('robot-count'), status ? String(status.robot_count ?? robots.length) : '');
    const names = robots.map((robot) => robot.name);
    for (const [name, card] of this.#cards) {
      if (names.includes(name)) continue;
      card.stopReadings();
      card.element.remove();
      this.#cards.delete(name);
    }
    for (const robot of robots) {
      if (!this.#cards.has(robot.name)) this.#add(robot);
      this.#cards.get(robot.name).update(robot, this.#modules.get(robot.name) ?? [], this.#namePort);
    }
    const first = this.#cards.get(names[0]);
    if (first && !this.#touched && !first.isOpen) first.element.open = true;
    byId('only-connected').disabled = robots.length === 0;
    return names.some((name) => !this.#modules.has(name)) || [...this.#modules.keys()].some((name) => !names.includes(name));
  }

  #add(robot) {
    const card = new Card(this.#connection, robot.name, robot.color, (toggled) => this.#toggled(toggled));
    card.element.querySelector('summary').addEventListener('click', () => { this.#touched = true; });
    this.#cards.set(robot.name, card);
    byId('robots').append(card.element);
  }

  #toggled(card) {
    if (!card.isOpen) return card.stopReadings();
    const others = [...this.#cards.values()].filter((other) => other.isOpen && other !== card);
    if (others.length >= MAX_OPEN) others[0].element.open = false;
    card.startReadings();
  }

  #waitOnlyForConnected() {
    const connected = [...this.#cards].filter(([, card]) => card.owner).map(([name]) => name);
    if (connected.length === 0) return say('nobody drives a robot: connect one first', true);
    this.#setParticipants(connected.join(' '));
  }

  async #setParticipants(text) {
    const reply = await this.#connection.call({module: '/simulation', command: 'set_participants', text});
    if (reply.error !== 0) say(reply.text, true);
    else say(text ? `lockstep waits for ${text}` : 'lockstep waits for the robots that the scenario names');
  }
}
