// SPDX-License-Identifier: MIT
// Live readings of one robot: the first readings of all its modules from one frame, in one round trip on their own
// connection, five times a second while shown.
import {make, setText, showNumber} from './dom.js';
import {attitude, distanceFan, forceArrow, gauge, needle, targetCompass} from './instruments.js';
import {JointPanel} from './joints.js';
import {CameraTile, ScanPlot} from './sensors.js';
import {plural, t} from './words.js';

const PERIOD_MS = 200;
const MOST_VALUES = 4096;  // of one module
const order = ['pose', 'motors', 'odometry', 'distance', 'target', 'compass', 'support', 'imu', 'wrench', 'contact'];
const degrees = (rad) => (typeof rad === 'number' ? (rad * 180) / Math.PI : rad);

/** The types whose numbers are always in sight; those of the others are on demand. */
const PLAIN = ['pose', 'motors'];

/** Pads to the width of "9.99" to keep columns still; figure spaces are as wide as digits. */
const inColumn = (text) => text.padStart(4, '\u2007');

/** Three numbers of `data` from `first` on. */
const triple = (data, first, digits) =>
  data.slice(first, first + 3).map((value) => showNumber(value, digits).padStart(digits + 3, '\u2007')).join('  ');

/** Rows of [name, text] for the first reading of a module. */
function describeReading({name, type}, data, colours) {
  switch (type) {
    case 'pose':
      return [
        [t('position'), `${showNumber(data[0], 2)}, ${showNumber(data[1], 2)} m`],
        [t('heading'), `${showNumber(degrees(data[2]), 0)}°`],
        [t('speed'), `${showNumber(data[3], 2)} m/s, ${showNumber(data[4], 2)} rad/s`],
      ];
    case 'motors':
      return [[t('wheels'), `${showNumber(data[2], 1)}, ${showNumber(data[3], 1)} rad/s`]];
    case 'compass':
      return [[name, `${showNumber(degrees(data[0]), 0)}°`]];
    case 'support':
      return [
        [name, `${showNumber(100 * data[0], 1)}, ${showNumber(100 * data[1], 1)} cm, ${showNumber(degrees(data[2]), 0)}°`],
      ];
    case 'distance':
      return [[name === 'distance' ? t('distances') : name, data.map((range) => inColumn(showNumber(range, 2))).join('  ')]];
    case 'target': {
      const targets = [];
      for (let i = 0; 2 * i + 1 < data.length; ++i) {
        const name = colours[i] ?? t('target {number}', {number: i + 1});
        targets.push(`${name} ${showNumber(data[2 * i], 2)} m, ${showNumber(degrees(data[2 * i + 1]), 0)}°`);
      }
      return [[t('targets'), targets.length > 0 ? targets.join('; ') : t('none')]];
    }
    case 'joints':
    case 'camera':
    case 'lidar':
      return [];  // shown in their own panel
    case 'odometry':
      return [[name, `${showNumber(data[0], 2)}, ${showNumber(data[1], 2)} m, ${showNumber(degrees(data[2]), 0)}°`]];
    case 'imu':
      return [
        [name, `${triple(data, 7, 2)} m/s²`],
        [t('{name}, turning', {name}), `${triple(data, 4, 2)} rad/s`],
      ];
    case 'wrench':
      return [
        [name, `${triple(data, 0, 1)} N`],
        [t('{name}, torque', {name}), `${triple(data, 3, 2)} N m`],
      ];
    case 'contact': {
      const contacts = Math.floor(data.length / 7);
      let force = 0;
      for (let i = 0; i < contacts; ++i) force += typeof data[7 * i] === 'number' ? data[7 * i] : 0;
      return [[name, contacts === 0 ? t('nothing touches it') : plural(contacts, '{force} N at {count} point', '{force} N at {count} points', {force: showNumber(force, 1)})]];
    }
    case 'battery':
      return [[name, `${showNumber(100 * data[1], 1)} %, ${showNumber(data[2], 1)} W`]];
    case 'sonar':
      return [[name, data.map((range) => inColumn(showNumber(range, 2))).join('  ')]];
    default:
      return [[name, data.map((value) => showNumber(value, 3)).join('  ')]];
  }
}

export class Readings {
  #connection;
  #robot;
  #modules;
  #attached = false;
  #colours = [];
  #timer = 0;
  #rows = new Map();
  #stopped = false;
  #list = make('dl', {class: 'readings'});
  #numbers = make('dl', {class: 'readings'});
  #pictures = make('div', {class: 'instruments', hidden: true});
  #instruments = new Map();  // by module; null: it has none
  #panels = new Map();  // of groups of joints, by module
  #scans = new Map();   // of lidars, likewise
  #cameras = [];
  #large = new Set();   // modules with too many values for constant reading
  element = make('div', {}, this.#list, this.#pictures);

  /** `modules`: name and type of each. */
  constructor(connection, robot, modules) {
    this.#connection = connection;
    this.#robot = robot;
    const rank = ({type}) => (order.includes(type) ? order.indexOf(type) : order.length);
    this.#modules = [...modules].sort((a, b) => rank(a) - rank(b));
    for (const {name} of this.#modules.filter(({type}) => type === 'joints')) {
      const panel = new JointPanel(connection, `/${robot}/${name}`);
      this.#panels.set(name, panel);
      this.element.append(panel.element);
    }
    for (const {name, type} of this.#modules) {
      if (type === 'lidar') {
        const scan = new ScanPlot(connection, `/${robot}/${name}`);
        this.#scans.set(name, scan);
        this.element.append(scan.element);
      } else if (type === 'camera') {
        const tile = new CameraTile(connection, robot, name);
        this.#cameras.push(tile);
        this.element.append(tile.element);
      }
    }
    if (this.#modules.some(({type}) => !PLAIN.includes(type))) {
      this.element.append(make('details', {class: 'numbers'}, make('summary', {}, t('All numbers')), this.#numbers));
    }
    this.#poll();
  }

  /** Sets why the robot cannot be driven; empty if it can. */
  setOff(reason) {
    for (const panel of this.#panels.values()) panel.setOff(reason);
  }

  stop() {
    this.#stopped = true;
    clearTimeout(this.#timer);
    for (const tile of [...this.#cameras, ...this.#scans.values()]) tile.stop();
    this.#connection.send({type: 'close', module: this.#home, channel: 'readings'});
    for (const [name, panel] of this.#panels) {
      panel.stop();
      this.#connection.send({type: 'close', module: `/${this.#robot}/${name}`, channel: 'readings'});
    }
  }

  get #attachable() { return this.#modules.filter(({name}) => !this.#large.has(name)); }

  get #home() { return `/${this.#robot}/${this.#modules[0].name}`; }

  async #poll() {
    if (!document.hidden && this.#connection.isOpen && this.#modules.length > 0) await this.#read();
    if (!this.#stopped) this.#timer = setTimeout(() => this.#poll(), PERIOD_MS);
  }

  async #read() {
    const call = (request) =>
      this.#connection.call({module: this.#home, channel: 'readings', ...request});
    if (!this.#attached) {
      const reply = await call({command: 'attach', text: this.#attachable.map(({name}) => name).join(' ')});
      if (this.#stopped) return;  // another call would open the connection again
      if (reply.error !== 0) return this.#show([['', reply.text]]);
      this.#attached = true;
      const seer = this.#modules.find(({type}) => type === 'target');
      if (seer) {
        const module = `/${this.#robot}/${seer.name}`;
        const targets = await this.#connection.call({module, channel: 'readings', command: 'get_targets'});
        this.#connection.send({type: 'close', module, channel: 'readings'});
        if (this.#stopped) return;
        this.#colours = targets.error === 0 ? targets.text.split(/[ ,]+/).filter(Boolean) : [];
      }
    }
    const reply = await call({command: 'get_time'});
    if (this.#stopped) return;
    if (reply.error !== 0) {
      this.#attached = false;  // the connection may have been closed, e.g. by a load
      return;
    }
    const modules = this.#attachable;
    const lengths = reply.params.slice(-modules.length);
    let start = 0;
    const shown = [];
    const rows = modules.flatMap((module, i) => {
      const data = reply.data.slice(start, start + lengths[i]);
      start += lengths[i];
      const panel = this.#panels.get(module.name) ?? this.#scans.get(module.name);
      if (lengths[i] > MOST_VALUES) {
        this.#large.add(module.name);
        this.#attached = false;  // attach again without this module
        this.#scans.get(module.name)?.element.remove();
        return [[module.name, t('{count} values: too many to show here', {count: lengths[i]})]];
      }
      if (panel) shown.push([panel, data]);
      this.#draw(module, data);
      return describeReading(module, data, this.#colours).map((row) => [...row, module.type]);
    });
    this.#show(rows);
    for (const [panel, data] of shown) {
      if (!this.#stopped) await panel.show(data);
    }
  }

  /** Shows a module's reading as a picture, if there is one for its type. */
  async #draw({name, type}, data) {
    const kinds = {target: () => targetCompass(this.#colours), imu: () => attitude(name), wrench: () => forceArrow(name),
      compass: () => needle(name), battery: () => gauge(name), sonar: () => distanceFan(name, null), distance: async () => {
        const module = `/${this.#robot}/${name}`;
        const reply = await this.#connection.call({module, channel: 'geometry', command: 'get_geometry'});
        this.#connection.send({type: 'close', module, channel: 'geometry'});
        return distanceFan(name, reply.error === 0 ? reply.data : null);
      }};
    if (!Object.hasOwn(kinds, type)) return;
    if (!this.#instruments.has(name)) {
      this.#instruments.set(name, null);  // until its geometry is known
      const made = await kinds[type]();
      made.element.style.order = this.#modules.findIndex((module) => module.name === name);
      this.#instruments.set(name, made);
      this.#pictures.append(made.element);
      this.#pictures.hidden = false;
    }
    if (!this.#stopped && !document.hidden) this.#instruments.get(name)?.show(data);
  }

  #show(rows) {
    for (const [name, text, type = 'pose'] of rows) {
      let value = this.#rows.get(name);
      if (!value) {
        value = make('dd');
        this.#rows.set(name, value);
        (PLAIN.includes(type) ? this.#list : this.#numbers).append(make('dt', {}, name), value);
      }
      setText(value, text);
    }
  }
}
