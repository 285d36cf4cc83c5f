// SPDX-License-Identifier: MIT
// A group of joints of one robot: position, target and limits of each, a slider that sends set_positions, and buttons.
// Moving a slider makes this page the robot's driver, until `Let go`.
import {make, say, setText, showNumber} from './dom.js';
import {t} from './words.js';

const DRIVE = 'joints';  // the channel for commands
const MODES = ['idle', 'position', 'direct', 'velocity', 'effort'];
const FREE_RANGE = Math.PI;  // to both sides of the position of a joint without limits

export class JointPanel {
  #connection;
  #module;
  #rows = [];  // by joint: name, slider, value
  #table = make('tbody');
  #asked = false;
  #next = null;  // the command to send after the reply to the last
  #busy = false;
  #buttons;
  #off = '';  // why joints cannot be moved; empty if they can
  element;

  constructor(connection, module) {
    this.#connection = connection;
    this.#module = module;
    const button = (text, title, act) => {
      const made = make('button', {type: 'button', title}, text);
      made.addEventListener('click', act);
      return made;
    };
    this.#buttons = [
      button(t('Hold'), t('Holds all joints where they are'), () => this.#send({command: 'hold'})),
      button(t('Idle'), t('Switches the motors of all joints off'), () => this.#send({command: 'set_modes', data: this.#rows.map(() => 0)})),
      button(t('Let go'), t('Releases the robot: this page stops driving its joints'), () => this.stop()),
    ];
    const group = module.slice(module.lastIndexOf('/') + 1);
    this.element = make('div', {class: 'joints'}, make('strong', {}, group), ' ', ...this.#buttons, make('table', {}, this.#table));
    this.element.dataset.group = group;
  }

  /** Disables moving joints for this reason; empty enables it. */
  setOff(reason) {
    this.#off = reason;
    for (const element of [...this.#buttons, ...this.#rows.map(({slider}) => slider)]) element.disabled = reason !== '';
  }

  /** Closes the connection that drives the joints, if any. */
  stop() {
    this.#next = null;
    this.#connection.send({type: 'close', module: this.#module, channel: DRIVE});
  }

  /** `data`: position, velocity and effort of each joint. */
  async show(data) {
    if (!this.#asked) await this.#learn();
    if (this.#rows.length === 0) return;
    const ask = (command) => this.#connection.call({module: this.#module, channel: 'readings', command});
    const [motion, modes] = await Promise.all([ask('get_motion'), ask('get_modes')]);
    for (const [i, row] of this.#rows.entries()) {
      const [position, velocity, effort] = data.slice(3 * i, 3 * i + 3);
      const target = motion?.error === 0 ? ` → ${showNumber(motion.data[i], 3)}` : '';
      setText(row.value, showNumber(position, 3) + target);
      const title = `${modes?.error === 0 ? `${MODES[modes.params[i]]}, ` : ''}` +
        t('velocity {velocity}, effort {effort}', {velocity: showNumber(velocity, 3), effort: showNumber(effort, 2)});
      if (row.value.title !== title) row.value.title = title;
      if (document.activeElement === row.slider || typeof position !== 'number') continue;
      this.#mark(row, position, motion?.error === 0 ? motion.data[i] : null);
      if (row.free) Object.assign(row.slider, {min: position - FREE_RANGE, max: position + FREE_RANGE});
      row.slider.value = position;
    }
  }

  /** The bar from the lower limit, or from the middle, to the position, and a mark at the target. */
  #mark({slider, free}, position, target) {
    const {min, max} = slider;
    const share = (value) => `${100 * Math.min(1, Math.max(0, (value - min) / (max - min)))}%`;
    if (!free && typeof position === 'number') slider.style.setProperty('--at', share(position));
    slider.style.setProperty('--zero', share(Math.min(max, Math.max(min, 0))));
    if (typeof target === 'number') slider.style.setProperty('--target', share(target));
  }

  /** Asks for the names and limits of the joints. */
  async #learn() {
    this.#asked = true;
    const reply = await this.#connection.call({module: this.#module, channel: 'readings', command: 'get_limits'});
    if (reply.error !== 0) {
      this.#asked = false;
      return;
    }
    const finite = (value, otherwise) => (typeof value === 'number' ? value : otherwise);
    this.#rows = reply.text.split(' ').map((name, i) => {
      const [lower, upper] = reply.data.slice(4 * i, 4 * i + 2);
      const slider = make('input', {type: 'range', step: 'any', min: finite(lower, -FREE_RANGE), max: finite(upper, FREE_RANGE),
        'aria-label': name, title: `${name}: ${t('{from} to {to}', {from: showNumber(lower, 2), to: showNumber(upper, 2)})}`});
      slider.addEventListener('input', () => this.#send({command: 'set_positions', params: [i + 1], data: [Number(slider.value)]}));
      slider.addEventListener('change', () => slider.blur());
      return {name, slider, free: typeof lower !== 'number' && typeof upper !== 'number', value: make('td', {class: 'number'}), lower: showNumber(lower, 2), upper: showNumber(upper, 2)};
    });
    this.setOff(this.#off);
    this.#table.replaceChildren(...this.#rows.map(({name, slider, value, lower, upper}) =>
      make('tr', {}, make('td', {class: 'joint'}, name), make('td', {class: 'limit'}, lower), make('td', {class: 'range'}, slider),
        make('td', {class: 'limit'}, upper), value)));
  }

  /** Sends the newest command after the reply to the previous one. */
  async #send(request) {
    this.#next = request;
    if (this.#busy) return;
    this.#busy = true;
    while (this.#next) {
      const now = this.#next;
      this.#next = null;
      const reply = await this.#connection.call({module: this.#module, channel: DRIVE, ...now});
      if (reply.error !== 0) say(reply.text, true);
    }
    this.#busy = false;
  }
}
