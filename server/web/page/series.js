// SPDX-License-Identifier: MIT
// Values over simulated time: of a live run as they arrive, of a recording from its table. No drawing.

const MOST_POINTS = 20000;  // of a curve; beyond this, every other point is dropped
const PERIOD_MS = 50;
const MOST_VALUES = 64;     // of a module; larger ones are not plotted

const numberOf = (value) => (typeof value === 'number' ? value : null);

/** Points of one robot, or of the run: times, and a column for each value. Simulated time only grows; a step back clears all points. */
export class Points {
  times = [];
  columns = [];

  constructor(count) { this.columns = Array.from({length: count}, () => []); }

  add(time, values) {
    const last = this.times.at(-1);
    if (time === last) return this.#correct(values);
    if (time < last) {
      this.times.length = 0;
      for (const column of this.columns) column.length = 0;
    }
    this.times.push(time);
    this.columns.forEach((column, i) => column.push(numberOf(values[i])));
    if (this.times.length > MOST_POINTS) {
      const half = (list) => list.filter((_, i) => i % 2 === 0);
      this.times = half(this.times);
      this.columns = this.columns.map(half);
    }
    return true;
  }

  /** Overwrites the values of the newest time: a number may be logged after the step was read. */
  #correct(values) {
    let changed = false;
    this.columns.forEach((column, i) => {
      const value = numberOf(values[i]);
      changed ||= column.at(-1) !== value;
      column[column.length - 1] = value;
    });
    return changed;
  }
}

/** [{name, unit}] of the `count` values of a module's first reading, by its `describe`; expands repeated values. */
export function namesOf(commands, count) {
  const reading = commands.find(({id, name, reply_data: data}) => id >= 10 && name.startsWith('get_') && data.length > 0);
  const data = reading?.reply_data ?? [];
  const names = [];
  for (let i = 0; i < count; ++i) {
    const repeated = data.findIndex((value) => value.repeated);
    const value = repeated >= 0 && i >= repeated ? data[repeated + (i - repeated) % (data.length - repeated)] : data[i];
    const number = repeated >= 0 && i >= repeated ? ` ${1 + Math.floor((i - repeated) / (data.length - repeated))}` : '';
    names.push(value ? {name: value.name + number, unit: value.unit} : {name: String(i + 1), unit: ''});
  }
  return names;
}

/** "robot1.left_setpoint_rad_s" → {name: 'left_setpoint', unit: 'rad/s'}. */
export function columnOf(robot, text) {
  const plain = text.startsWith(`${robot}.`) ? text.slice(robot.length + 1) : text;
  for (const [ending, unit] of [['_rad_s', 'rad/s'], ['_m_s', 'm/s'], ['_m_s2', 'm/s²'], ['_rad', 'rad'], ['_nm', 'N m'], ['_n', 'N'], ['_m', 'm'], ['_s', 's'], ['_w', 'W']]) {
    if (plain.endsWith(ending)) return {name: plain.slice(0, -ending.length), unit};
  }
  return {name: plain, unit: ''};
}

/** {module, name} of a recorded value, as a live run calls it; `modules`: the last words of the robot's modules. */
export function liveName(name, modules) {
  const wheel = /^(left|right)$/.test(name);
  const [, ray] = /^d(\d+)$/.exec(name) ?? [];
  const [, target, what] = /^(.+)_(distance|bearing)$/.exec(name) ?? [];
  const module = modules.find((one) => name.startsWith(`${one}_`));
  if (/^(x|y|heading)$/.test(name)) return {module: 'pose', name};
  if (ray) return {module: 'distance', name: `range ${ray}`};
  if (/_(setpoint|mode)$/.test(name)) return {module: 'set-points', name: name.replace('_setpoint', '')};
  if (target) return {module: 'target', name: `${what} ${target}`};
  if (module) return {module, name: name.slice(module.length + 1)};
  return wheel ? {module: 'motors', name} : {module: 'joints', name};
}

/** The robot's value in a column of a recording's table; null if the column is not the robot's. */
export const robotValue = (robot, modules = []) => (column) => {
  if (!column.startsWith(`${robot}.`)) return null;
  const {name, unit} = columnOf(robot, column), live = liveName(name, modules);
  if (live.module === 'motors') live.name += unit === 'rad' ? '_angle' : '_speed';
  return {key: column, ...live, unit};
};

/** Reads the columns of a recording's table for which `valueOf` returns a value. */
export function readTable(text, valueOf) {
  const [head, ...lines] = text.trim().split('\n');
  const names = head.split(',').map((name) => name.replaceAll('"', ''));
  const time = names.findIndex((name) => /^time(_s)?$/.test(name));
  const chosen = names.map((name, i) => [valueOf(name), i]).filter(([value]) => value);
  const points = new Points(chosen.length);
  for (const line of lines) {
    const cells = line.split(',');
    points.times.push(Number(cells[time]));
    chosen.forEach(([, at], i) => {
      const value = Number(cells[at]);
      points.columns[i].push(cells[at] !== '' && Number.isFinite(value) ? value : null);
    });
  }
  return {values: chosen.map(([value]) => value), points};
}

/** Follows all modules of a robot in a live run while its plot is shown. Event: points. */
export class LiveSeries extends EventTarget {
  #connection;
  #robot;
  #home;
  #attached = false;
  #stopped = false;
  #modules;
  values = [];
  points = new Points(0);

  /** `modules`: full names. */
  constructor(connection, robot, modules) {
    super();
    this.#connection = connection;
    this.#robot = robot;
    this.#modules = modules.map((name) => name.slice(name.lastIndexOf('/') + 1));
    this.#home = modules[0];
    this.#run();
  }

  stop() {
    this.#stopped = true;
    this.#connection.send({type: 'close', module: this.#home, channel: 'plots'});
  }

  #call(request) { return this.#connection.call({module: this.#home, channel: 'plots', ...request}); }

  async #run() {
    while (!this.#stopped) {
      if (this.#connection.isOpen && !document.hidden) await this.#read();
      await new Promise((resolve) => setTimeout(resolve, PERIOD_MS));
    }
  }

  async #read() {
    if (!this.#attached && !await this.#learn()) return;
    const reply = await this.#call({command: 'get_time'});
    if (this.#stopped) return;
    if (reply.error !== 0 || reply.params.length !== this.#modules.length + 1) {
      this.#attached = false;
      return;
    }
    const time = reply.data.at(-2);
    if (this.points.add(time, reply.data.slice(0, -2))) this.dispatchEvent(new Event('points'));
  }

  /** Selects the modules that are not too large and asks for the names of their values. */
  async #learn() {
    const commands = new Map();
    for (const name of this.#modules) {
      const module = `/${this.#robot}/${name}`;
      const reply = await this.#connection.call({module, channel: 'describe', command: 'describe'});
      this.#connection.send({type: 'close', module, channel: 'describe'});
      if (this.#stopped || reply.error !== 0) return false;
      commands.set(name, JSON.parse(reply.text).commands);
    }
    for (;;) {
      if ((await this.#call({command: 'attach', text: this.#modules.join(' ')})).error !== 0 || this.#stopped) return false;
      const reply = await this.#call({command: 'get_time'});
      if (reply.error !== 0 || this.#stopped) return false;
      const lengths = reply.params.slice(1);
      const small = this.#modules.filter((_, i) => lengths[i] <= MOST_VALUES);
      if (small.length < this.#modules.length) {
        this.#modules = small;
        continue;
      }
      this.values = small.flatMap((module, i) =>
        namesOf(commands.get(module), lengths[i]).map(({name, unit}, k) => ({key: `${module}.${k}`, module, name, unit})));
      this.points = new Points(this.values.length);
      this.#attached = true;
      this.dispatchEvent(new Event('values'));
      return true;
    }
  }
}
