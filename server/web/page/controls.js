// SPDX-License-Identifier: MIT
// Run, pause, step, reset, …; mode, step size, speed; scenarios to choose and to upload.
import {byId, make, say, setOff, setText} from './dom.js';
import {textOf} from './dropped.js';
import {showTab} from './layout.js';
import {ask} from './seat.js';
import {t} from './words.js';

const MODULE = '/simulation';
const MAX_INT32 = 2 ** 31 - 1;
const BEFORE_LOAD = 'before_load';  // the saved state to which an undo of a load returns
const MIN_STEP_MS = 0.5;
const MAX_STEP_MS = 100;
const MIN_PLAY_SPEED = -4;
const MAX_PLAY_SPEED = 64;

export class Controls {
  #connection;
  #status = null;
  #scenario = '';  // the scenario that the list was last set to
  #noScenarios = false;
  #uploaded = null;  // lines of the last file sent
  #fromEditor = false;

  constructor(connection) {
    this.#connection = connection;
    const on = (id, event, handler) => byId(id).addEventListener(event, handler);
    on('run', 'click', () => this.#order('run'));
    on('pause', 'click', () => this.#order('pause'));
    on('step', 'click', () => this.#step(this.#stepCount()));
    on('step-back', 'click', () => this.#step(-Math.abs(this.#stepCount())));
    on('step-count', 'change', () => this.#stepCount());
    on('reset', 'click', () => this.#reset());
    on('reload', 'click', () => this.load({command: 'reload'}));
    on('stop-all', 'click', () => this.#order('stop_all'));
    on('set-mode', 'change', () => this.#order('set_mode', {line: `set_mode ${byId('set-mode').value}`}));
    on('set-step', 'change', () => this.#setStep());
    on('set-speed', 'change', () => this.#setSpeed());
    on('go-realtime', 'click', () => this.#order('set_mode', {line: 'set_mode realtime'}));
    on('no-limit', 'click', () => this.#order(t('speed'), {command: 'set_speed', data: [0]}));
    for (const id of ['seed', 'set-step', 'set-speed']) {
      on(id, 'input', () => byId(id).removeAttribute('aria-invalid'));
      on(id, 'blur', () => this.#forgetRefused(id));
    }
    on('load', 'click', () => this.load({command: 'load_scenario', text: byId('scenarios').value}));
    on('upload', 'change', () => this.#upload());
  }

  update(status) {
    this.#status = status;
    const paused = status?.state === 'paused';
    const playback = status?.playback;
    setOff('step', paused || playback ? '' : t('Only while paused'),
      playback ? t('Goes on by this number of recorded steps; below 0 goes back') : t('Runs this number of steps'));
    byId('run').setAttribute('aria-pressed', String(Boolean(status) && /running|waiting|playing/.test(status.state)));
    byId('pause').setAttribute('aria-pressed', String(paused));
    if (!status) return;
    for (const id of ['run', 'pause', 'reset', 'set-speed']) setOff(id, '');
    this.#offerWhatAPlaybackTakes(playback);
    const set = (id, value) => {
      const input = byId(id);
      const busy = document.activeElement === input || input.hasAttribute('aria-invalid');
      if (!busy && input.value !== value) input.value = value;
    };
    this.#followScenario();
    set('set-mode', status.mode);
    set('set-step', String(+(1000 * status.step_s).toPrecision(6)));
    const speed = playback ? playback.speed : status.speed;
    set('set-speed', playback || speed > 0 ? String(+speed.toPrecision(6)) : '');
  }

  #offerWhatAPlaybackTakes(playback) {
    const off = (does) => (playback ? t('A recording is being played: {does}', {does}) : '');
    setOff('seed', off(t('it has the seed that it was made with')));
    setOff('set-mode', off(t('it has the mode that it was made in')));
    setOff('set-step', off(t('it has the steps that it was made with')));
    setOff('no-limit', off(t('it has a speed from −4 to 64')), t('No limit: as fast as this computer can'));
    setOff('reload', off(t('its scenario cannot be changed')), t('Load the same scenario file again from disk'));
    for (const id of ['scenarios', 'upload']) setOff(id, off(t('its scenario cannot be changed')));
    setOff('load', this.#noScenarios ? t('There are no scenarios on the search path') : off(t('its scenario cannot be changed')));
    setOff('stop-all', off(t('nobody drives its robots')));
    const count = byId('step-count');
    count.min = playback ? '-1000000' : '1';
    byId('step-back').hidden = !playback;
    const speed = byId('set-speed');
    speed.min = playback ? '-4' : '0';
    speed.title = playback ? t('Below 0 the recording goes backwards') : '';
  }

  async refreshScenarios() {
    const names = await (await ask('api/scenarios')).json();
    const select = byId('scenarios');
    const chosen = select.value;
    select.replaceChildren(...names.map((name) => make('option', {value: name}, name)));
    if (names.includes(chosen)) select.value = chosen;
    if (!chosen) this.#scenario = '';
    this.#followScenario();
    this.#noScenarios = names.length === 0;
    this.#offerWhatAPlaybackTakes(this.#status?.playback);
  }

  /** Selects the running scenario in the list when it has changed, by anybody; else leaves the user's choice. */
  #followScenario() {
    const scenario = this.#status?.scenario ?? '';
    const select = byId('scenarios');
    if (scenario === this.#scenario || select.options.length === 0) return;
    this.#scenario = scenario;
    if ([...select.options].some((option) => option.value === scenario)) select.value = scenario;
  }

  /** Sends `command` without values, or `request`, and shows an error. */
  async #order(command, request = {command}) {
    const reply = await this.#connection.call({module: MODULE, ...request});
    if (reply.error !== 0) say(`${command}: ${reply.text}`, true);
    else say('');
    return reply;
  }

  /** Marks an invalid number in red, which is not sent, until it is edited or its field loses the focus. */
  #refuse(id, text) {
    byId(id).setAttribute('aria-invalid', 'true');
    say(text, true);
  }

  /** Restores the current value in a field that loses the focus with a refused number. */
  #forgetRefused(id) {
    const field = byId(id);
    if (!field.hasAttribute('aria-invalid')) return;
    field.removeAttribute('aria-invalid');
    field.value = '';
    this.update(this.#status);
  }

  /** Limits the field to at least 1; a playback also steps by negative counts. */
  #stepCount() {
    const field = byId('step-count');
    const wanted = Math.trunc(Number(field.value)) || 1;
    const count = this.#status?.playback ? wanted : Math.max(1, wanted);
    if (field.value !== String(count)) field.value = String(count);
    return count;
  }

  #step(count) {
    if (this.#status?.playback) return this.#order('step', {module: '/playback', command: 'step', params: [count]});
    // On its own connection: the reply comes after the steps, which may wait for some client's commands.
    return this.#order('step', {command: 'step', params: [count], channel: 'step'});
  }

  #reset() {
    const field = byId('seed');
    const seed = Number(field.value);
    if (field.validity.badInput || !Number.isInteger(seed) || seed < 0 || seed > MAX_INT32) {
      field.focus();  // losing the focus clears it
      return this.#refuse('seed', t('seed must be a whole number up to {most}', {most: MAX_INT32}));
    }
    this.#order('reset', {command: 'reset', params: field.value.trim() === '' || field.disabled ? [] : [seed]});
  }

  async #setStep() {
    const field = byId('set-step');
    const value = Number(field.value);
    if (field.validity.badInput) return this.#refuse('set-step', t('step size: write a number of ms, e.g. 10'));
    if (field.value.trim() !== '') {
      if (value < MIN_STEP_MS || value > MAX_STEP_MS) {
        return this.#refuse('set-step', t('step size: a step lasts {least} to {most} ms, not {value} ms', {least: MIN_STEP_MS, most: MAX_STEP_MS, value}));
      }
      const whole = Math.round(1000 * value) / 1000;
      if (Math.abs(value - whole) > 1e-9) {
        return this.#refuse('set-step', t('step size: a step lasts whole microseconds: write {whole} ms', {whole}));
      }
      await this.#order(t('step size'), {command: 'set_step', data: [Number((value / 1000).toPrecision(9))]});
    }
    field.blur();  // shows what holds
  }

  async #setSpeed() {
    const field = byId('set-speed');
    const value = Number(field.value);
    const playback = Boolean(this.#status?.playback);
    const [low, high] = playback ? [MIN_PLAY_SPEED, MAX_PLAY_SPEED] : [0, Infinity];
    if (field.validity.badInput || (field.value !== '' && (value === 0 || value < low || value > high))) {
      return this.#refuse('set-speed', playback ? t('speed: write a number from {low} to {high} other than 0, or press Pause', {low, high})
        : t('speed: write a number above 0, e.g. 2, or press "no limit"'));
    }
    if (field.value !== '') {
      await this.#order(t('speed'), {module: playback ? '/playback' : MODULE, command: 'set_speed', data: [value]});
    }
    field.blur();  // shows what holds
  }

  /** `name`: of the scenario. `lines`: of the file sent, if any. What ran before is kept for an undo. */
  async load(request, name = request.text ?? '', lines = null) {
    this.#uploaded = lines;
    this.#showDiagnostics('');
    say(t('loading …'));
    const before = this.#status?.scenario ?? t('the world before');
    const kept = await this.#connection.call({module: MODULE, command: 'save', text: BEFORE_LOAD});
    const reply = await this.#connection.call({module: MODULE, ...request});
    if (reply.error === 0) {
      say(t('loaded {name}', {name}).trim(), false, kept.error === 0 ? {text: t('Undo: back to {name}', {name: before}), act: () => this.#undoLoad(before)} : null);
      this.#showDiagnostics(reply.text);
    } else if (/:\d+: (error|warning): /.test(reply.text)) {
      say(t('the file has errors; nothing was changed'), true);
      this.#showDiagnostics(reply.text);
    } else {
      say(reply.text, true);
    }
  }

  async #undoLoad(before) {
    const reply = await this.#connection.call({module: MODULE, command: 'restore', text: BEFORE_LOAD});
    say(reply.error === 0 ? t('{name} is back, as it was before the load', {name: before}) : reply.text, reply.error !== 0);
  }

  async #upload() {
    const [file] = byId('upload').files;
    byId('upload').value = '';  // allows choosing the same file again
    if (!file) return;
    if (file.size > 12 * 2 ** 20) return say(t('the file is too large for a scenario'), true);
    await this.loadText(await textOf(file), file.name);
  }

  /** Loads the scenario in `text`; shows its errors with their lines. */
  async loadText(text, name, fromEditor = false) {
    this.#fromEditor = fromEditor;
    const lines = text.split(/\r?\n/);
    // The last line of a scenario text may give the file's name.
    await this.load({command: 'load_scenario', text: `${text}\n# file: ${name.replace(/\s/g, ' ')}\n`}, name, lines);
    this.#fromEditor = false;
  }

  /** Shows `diagnostics` from /api/check or /api/upload for a file with this text. */
  showErrors(diagnostics, text) {
    this.#uploaded = text.split(/\r?\n/);
    say(t('the file has errors; nothing was changed'), true);
    this.#showDiagnostics(diagnostics.map(({file, line, severity, text: what}) => `${file}:${line}: ${severity}: ${what}`).join('\n'));
  }

  /** Shows one entry for each `file:line: error: text`, with the line of the file sent. */
  #showDiagnostics(text) {
    const entries = text.split('\n').filter((line) => line.trim() !== '').map((line) => {
      const [, where, number, level, what] = /^(.*?):(\d+): (error|warning): (.*)$/.exec(line) ?? [];
      if (!what) return make('li', {}, line);
      const source = this.#uploaded?.[Number(number) - 1];
      const item = make('li', {class: level}, make('strong', {}, t('line {number}', {number})), `: ${what}`);
      if (!this.#uploaded) item.prepend(`${where}, `);
      if (source !== undefined) item.append(make('code', {}, source.trim()));
      return item;
    });
    byId('diagnostics').hidden = entries.length === 0;
    byId('diagnostics').replaceChildren(...entries);
    byId('diagnostics').scrollTop = 0;
    if (entries.length > 0 && this.#fromEditor) return;  // which marks them itself
    if (entries.length > 0) {
      showTab('robots');
      byId('diagnostics').scrollIntoView({block: 'nearest'});
    }
  }
}

/** Shows the version once. */
export function showVersion(version) {
  setText(byId('version'), `coopdyn ${version}`);
}
