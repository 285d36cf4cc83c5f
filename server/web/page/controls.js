// SPDX-License-Identifier: MIT
// Run, pause, step, reset, …; mode, step size, speed; scenarios to choose and to upload.
import {byId, make, say, setText} from './dom.js';

const MODULE = '/simulation';
const MAX_INT32 = 2 ** 31 - 1;
const MIN_STEP_MS = 0.5;
const MAX_STEP_MS = 100;

export class Controls {
  #connection;
  #status = null;
  #scenario = '';  // that the list was last set to
  #uploaded = null;  // lines of the file that was sent last

  constructor(connection) {
    this.#connection = connection;
    const on = (id, event, handler) => byId(id).addEventListener(event, handler);
    on('run', 'click', () => this.#order('run'));
    on('pause', 'click', () => this.#order('pause'));
    on('step', 'click', () => this.#step());
    on('step-count', 'change', () => this.#stepCount());
    on('reset', 'click', () => this.#reset());
    on('reload', 'click', () => this.#load({command: 'reload'}));
    on('stop-all', 'click', () => this.#order('stop_all'));
    on('set-mode', 'change', () => this.#order('set_mode', {line: `set_mode ${byId('set-mode').value}`}));
    on('set-step', 'change', () => this.#setStep());
    on('set-speed', 'change', () => this.#setSpeed(byId('set-speed').value));
    on('no-limit', 'click', () => this.#setSpeed(''));
    on('load', 'click', () => this.#load({command: 'load_scenario', text: byId('scenarios').value}));
    on('upload', 'change', () => this.#upload());
  }

  update(status) {
    this.#status = status;
    const paused = status?.state === 'paused';
    byId('step').disabled = !paused;
    byId('run').classList.toggle('primary', paused);
    byId('pause').classList.toggle('primary', !paused);
    if (!status) return;
    const set = (id, value) => {
      const input = byId(id);
      if (document.activeElement !== input && input.value !== value) input.value = value;
    };
    this.#followScenario();
    set('set-mode', status.mode);
    set('set-step', String(+(1000 * status.step_s).toPrecision(6)));
    set('set-speed', status.speed > 0 ? String(+status.speed.toPrecision(6)) : '');
  }

  async refreshScenarios() {
    const names = await (await fetch('api/scenarios')).json();
    const select = byId('scenarios');
    const chosen = select.value;
    select.replaceChildren(...names.map((name) => make('option', {value: name}, name)));
    if (names.includes(chosen)) select.value = chosen;
    if (!chosen) this.#scenario = '';
    this.#followScenario();
    byId('load').disabled = names.length === 0;
  }

  /** The list shows the scenario that runs when that has changed, also by somebody else; else what was chosen. */
  #followScenario() {
    const scenario = this.#status?.scenario ?? '';
    const select = byId('scenarios');
    if (scenario === this.#scenario || select.options.length === 0) return;
    this.#scenario = scenario;
    if ([...select.options].some((option) => option.value === scenario)) select.value = scenario;
  }

  /** Sends a command without values, or as `request` says, and shows an error. */
  async #order(command, request = {command}) {
    const reply = await this.#connection.call({module: MODULE, ...request});
    if (reply.error !== 0) say(`${command}: ${reply.text}`, true);
    else say('');
    return reply;
  }

  /** At least 1, and the field says so. */
  #stepCount() {
    const field = byId('step-count');
    const count = Math.max(1, Math.floor(Number(field.value) || 1));
    if (field.value !== String(count)) field.value = String(count);
    return count;
  }

  #step() {
    const count = this.#stepCount();
    // Answered when the steps have run, which may need somebody's commands: on a connection of its own.
    this.#order('step', {command: 'step', params: [count], channel: 'step'});
  }

  #reset() {
    const field = byId('seed');
    const seed = Number(field.value);
    if (field.validity.badInput || !Number.isInteger(seed) || seed < 0 || seed > MAX_INT32) {
      return say(`seed must be a whole number up to ${MAX_INT32}`, true);
    }
    this.#order('reset', {command: 'reset', params: field.value.trim() === '' ? [] : [seed]});
  }

  async #setStep() {
    const field = byId('set-step');
    const value = Number(field.value);
    if (field.value.trim() === '') {
      if (field.validity.badInput) say('step size: write a number of ms, e.g. 10', true);
    } else if (value < MIN_STEP_MS || value > MAX_STEP_MS) {
      say(`step size: a step lasts ${MIN_STEP_MS} to ${MAX_STEP_MS} ms, not ${value} ms`, true);
    } else if (Math.abs(1000 * value - Math.round(1000 * value)) > 1e-6) {
      say(`step size: a step lasts whole microseconds: write ${Math.round(1000 * value) / 1000} ms`, true);
    } else {
      await this.#order('step size', {command: 'set_step', data: [Number((value / 1000).toPrecision(9))]});
    }
    field.blur();  // shows what holds
  }

  async #setSpeed(text) {
    await this.#order('speed', {command: 'set_speed', data: [text.trim() === '' ? 0 : Number(text)]});
    byId('set-speed').blur();
  }

  async #load(request, lines = null) {
    this.#uploaded = lines;
    this.#showDiagnostics('');
    say('loading …');
    const reply = await this.#connection.call({module: MODULE, ...request});
    if (reply.error === 0) {
      say(`loaded${lines === null && request.text ? ` ${request.text}` : ''}`);
      this.#showDiagnostics(reply.text);
    } else if (/:\d+: (error|warning): /.test(reply.text)) {
      say('the file has errors; nothing was changed', true);
      this.#showDiagnostics(reply.text);
    } else {
      say(reply.text, true);
    }
  }

  async #upload() {
    const [file] = byId('upload').files;
    byId('upload').value = '';  // so that the same file can be chosen again
    if (!file) return;
    if (file.size > 12 * 2 ** 20) return say('the file is too large for a scenario', true);
    const bytes = await file.arrayBuffer();
    let text;
    try {
      text = new TextDecoder('utf-8', {fatal: true}).decode(bytes);
    } catch {
      text = new TextDecoder('windows-1252').decode(bytes);
    }
    if (!text.includes('\n')) text += '\n';  // else it would be taken for a name
    await this.#load({command: 'load_scenario', text}, text.split(/\r?\n/));
  }

  /** One entry for each `file:line: error: text`, with the line of the file that was sent. */
  #showDiagnostics(text) {
    const entries = text.split('\n').filter((line) => line.trim() !== '').map((line) => {
      const [, where, number, level, what] = /^(.*?):(\d+): (error|warning): (.*)$/.exec(line) ?? [];
      if (!what) return make('li', {}, line);
      const source = this.#uploaded?.[Number(number) - 1];
      const item = make('li', {class: level}, make('strong', {}, `line ${number}`), `: ${what}`);
      if (!this.#uploaded) item.prepend(`${where}, `);
      if (source !== undefined) item.append(make('code', {}, source.trim()));
      return item;
    });
    byId('diagnostics').hidden = entries.length === 0;
    byId('diagnostics').replaceChildren(...entries);
    if (entries.length > 0) byId('diagnostics').scrollIntoView({block: 'nearest'});
  }
}

/** Shows the version once. */
export function showVersion(version) {
  setText(byId('version'), `coopdyn ${version}`);
}
