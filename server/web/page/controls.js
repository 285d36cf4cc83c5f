// SPDX-License-Identifier: MIT
// Run, pause, step, reset, …; mode, step size, speed; scenarios to choose and to upload.
import {byId, make, say, setText} from './dom.js';

const MODULE = '/simulation';

export class Controls {
  #connection;
  #status = null;
  #uploaded = null;  // lines of the file that was sent last

  constructor(connection) {
    this.#connection = connection;
    const on = (id, event, handler) => byId(id).addEventListener(event, handler);
    on('run', 'click', () => this.#order('run'));
    on('pause', 'click', () => this.#order('pause'));
    on('step', 'click', () => this.#step());
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
    set('set-mode', status.mode);
    set('set-step', String(+(1000 * status.step_s).toPrecision(6)));
    set('set-speed', status.speed > 0 ? String(+status.speed.toPrecision(6)) : '');
  }

  async refreshScenarios() {
    const names = await (await fetch('api/scenarios')).json();
    const select = byId('scenarios');
    const chosen = select.value || this.#status?.scenario;
    select.replaceChildren(...names.map((name) => make('option', {value: name}, name)));
    if (names.includes(chosen)) select.value = chosen;
    byId('load').disabled = names.length === 0;
  }

  /** Sends a command without values, or as `request` says, and shows an error. */
  async #order(command, request = {command}) {
    const reply = await this.#connection.call({module: MODULE, ...request});
    if (reply.error !== 0) say(`${command}: ${reply.text}`, true);
    else say('');
    return reply;
  }

  #step() {
    const count = Math.max(1, Math.floor(Number(byId('step-count').value) || 1));
    // Answered when the steps have run, which may need somebody's commands: on a connection of its own.
    this.#order('step', {command: 'step', params: [count], channel: 'step'});
  }

  #reset() {
    const seed = byId('seed').value.trim();
    this.#order('reset', {command: 'reset', params: seed === '' ? [] : [Math.floor(Number(seed))]});
  }

  async #setStep() {
    const value = Number(byId('set-step').value) / 1000;
    await this.#order('step size', {command: 'set_step', data: [Number(value.toPrecision(9))]});
    byId('set-step').blur();
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
  }
}

/** Shows the version once. */
export function showVersion(version) {
  setText(byId('version'), `coopdyn ${version}`);
}
