// SPDX-License-Identifier: MIT
// The tab Program of a seat: a program in Python that runs on the server. It is kept as one types; the teacher may read and stop it.
import {byId, make, saveFile, setOff, setText} from './dom.js';
import {post} from './host_events.js';
import {isShown, tab} from './layout.js';
import {ProgramOutput} from './program_output.js';
import {programAddress, SEAT} from './seat.js';
import {t} from './words.js';

const SAVE_MS = 700, RETRY_MS = 3000;
const MAX_BYTES = 256 << 10;
const NOTHING = {runs: false, run: -1, printed: 0, version: '', ran: '', sentence: '', error: false, line: 0};

export class Program {
  #state = NOTHING;  // as the host says
  #code = null;      // python_view.js; null until loaded
  #base = '';        // the version on the host from which the text was made
  #changed = false;  // it has not been kept yet
  #theirs = false;   // somebody else at the seat has changed it, too
  #trouble = '';     // why it is not kept, or does not run
  #marked = 0;       // line
  #stopped = -1;     // the run that was stopped, and ends at once
  #timer = 0;
  #saving = null;
  #starting = null;
  #panel = tab('program', t('Program'));
  #host = make('div', {id: 'program-code'});
  #says = make('p', {id: 'program-state', role: 'status'});
  #choice = make('p', {id: 'program-choice', role: 'alert', hidden: true});
  #output = new ProgramOutput(programAddress('output/'), (line) => this.#code?.show(line));

  constructor() {
    byId('tabs').firstElementChild.after(byId('tab-program'));
    const button = (id, text, title, act, kind = '') => {
      const made = make('button', {type: 'button', id, title, class: kind}, text);
      made.addEventListener('click', act);
      return made;
    };
    const row = make('div', {class: 'row'}, button('program-stop', t('Stop'), t('Ends the program'), () => this.#stop(), SEAT.teaches ? '' : 'danger'),
      button('program-save', t('Save as file'), t('Keep a copy on this computer (Ctrl+S)'), () => this.#saveFile()));
    if (!SEAT.teaches) {
      const input = make('input', {type: 'file', accept: '.py,text/x-python', hidden: true, id: 'program-file'});
      input.addEventListener('change', () => this.#openFile(input));
      row.prepend(button('program-run', t('Run'), t('Run this program on the server (Ctrl+Enter)'), () => this.run(), 'primary'));
      row.append(button('program-open', t('Open file'), t('Replaces this program; Ctrl+Z brings it back'), () => input.click()), input);
    }
    this.#choice.append(`${t('This program was changed meanwhile in another window of this seat.')} `,
      button('program-theirs', t('Take theirs'), t('Ctrl+Z brings yours back'), () => this.#takeTheirs()), ' ',
      button('program-mine', t('Keep mine'), t('Replaces the other one'), () => this.#keepMine()));
    this.#panel.append(row, this.#choice, this.#host, this.#says, this.#output.element);
    this.#panel.addEventListener('shown', () => this.#start());
    this.#panel.addEventListener('keydown', (event) => this.#onKey(event), true);
    addEventListener('pagehide', () => { if (this.#changed && !this.#theirs) this.#send('', true); });
    this.#show();
  }

  /** For tests. */
  get code() { return this.#code; }
  get state() { return this.#state; }

  /** `state`: of the program, in the host's events. */
  update(state) {
    if (!state) return;
    this.#state = state;
    if (isShown('program')) this.#follow();
    this.#show();
  }

  get #runs() { return this.#state.runs && this.#state.run !== this.#stopped; }

  #follow() {
    this.#output.follow(this.#state);
    if (this.#code && this.#state.version !== this.#base && !this.#saving) this.#onOtherVersion();
  }

  async #onOtherVersion() {
    if (this.#changed) {
      this.#theirs = true;
      return this.#show();
    }
    const there = await this.#fetch();
    if (there && !this.#changed && !this.#saving) this.#take(there);
  }

  async #fetch() {
    const answer = await fetch(programAddress()).catch(() => null);
    return answer?.ok ? answer.json() : null;
  }

  #take({text, version}) {
    this.#base = version;
    if (text !== this.#code.text) this.#code.replace(text);
  }

  #start() {
    this.#starting ??= this.#begin();
    return this.#starting;
  }

  async #begin() {
    const [{PythonView}, there] = await Promise.all([import('./python_view.js'), this.#fetch()]);
    if (!there) {
      this.#trouble = t('The host does not answer. Trying again …');
      this.#starting = null;
      setTimeout(() => { if (isShown('program')) this.#start(); }, RETRY_MS);
      return this.#show();
    }
    this.#trouble = '';
    this.#base = there.version;
    this.#code = new PythonView(this.#host, there.text, SEAT.teaches, () => this.#onChange());
    this.update(there);
  }

  #onChange() {
    this.#changed = true;
    this.#later(SAVE_MS);
    this.#show();
  }

  #later(wait_ms) {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.save(), wait_ms);
  }

  /** Keeps the text on the host, if that has not been done. */
  async save() {
    clearTimeout(this.#timer);
    await this.#saving;
    if (this.#changed && !this.#theirs) await this.#post('');
  }

  #send(what, keepalive = false) {
    return fetch(programAddress(what), {method: 'POST', keepalive, headers: {'Content-Type': 'application/json'},
      body: JSON.stringify({text: this.#code.text, base: this.#base})});
  }

  /** Sends the text. Whether the host has done it. */
  async #post(what) {
    const text = this.#code.text;
    let done = false;
    this.#saving = (async () => {
      try {
        const answer = await this.#send(what);
        const said = await answer.text();
        this.#trouble = answer.ok ? '' : sentence(said);
        if (answer.ok) {
          done = true;
          this.#state = JSON.parse(said);
          this.#base = this.#state.version;
          this.#changed = this.#code.text !== text;
        } else {
          const there = await this.#fetch();
          if (there?.text === text) {  // kept, but it does not run
            this.#base = there.version;
            this.#changed = this.#code.text !== text;
          } else if (there && there.version !== this.#base) {
            this.#theirs = true;
            this.#trouble = '';
          }
        }
      } catch {
        this.#trouble = t('Not kept: the host does not answer. Trying again …');
        this.#later(RETRY_MS);
      }
    })();
    await this.#saving;
    this.#saving = null;
    this.#show();
    return done;
  }

  async run() {
    await this.#start();
    if (!this.#code || this.#runs || this.#theirs) return;
    clearTimeout(this.#timer);
    await this.#saving;
    if (await this.#post('run')) this.#follow();
  }

  async #stop() {
    const {error} = await post(programAddress('stop'), {});
    this.#trouble = error;
    if (!error) this.#stopped = this.#state.run;
    this.#show();
  }

  async #takeTheirs() {
    const there = await this.#fetch();
    if (!there) return;
    this.#theirs = this.#changed = false;
    this.#take(there);
    this.#show();
  }

  async #keepMine() {
    const there = await this.#fetch();
    if (!there) return;
    this.#theirs = false;
    this.#base = there.version;
    await this.save();
  }

  #saveFile() {
    if (this.#code) saveFile('program.py', new Blob([this.#code.text], {type: 'text/x-python'}));
  }

  async #openFile(input) {
    const [file] = input.files;
    input.value = '';
    if (!file || !this.#code) return;
    if (file.size > MAX_BYTES) {
      this.#trouble = t('{name} is longer than 256 KiB: a program may have that much.', {name: file.name});
      return this.#show();
    }
    this.#code.replace(await file.text());
    this.#onChange();
  }

  #onKey(event) {
    const ctrl = event.ctrlKey || event.metaKey;
    if (ctrl && event.key === 'Enter' && !SEAT.teaches) this.run();
    else if (ctrl && event.key.toLowerCase() === 's') this.#saveFile();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  #show() {
    const {runs, sentence: how, error} = this.#state;
    if (byId('program-run')) setOff('program-run', this.#runs ? t('It runs already') : '', t('Run this program on the server (Ctrl+Enter)'));
    setOff('program-stop', this.#runs ? '' : t('It does not run'), t('Ends the program'));
    this.#choice.hidden = !this.#theirs;
    const text = this.#trouble || (runs ? t('It runs.') : how || t('It does not run.'));
    this.#says.classList.toggle('error', this.#trouble !== '' || (error && !runs));
    setText(this.#says, text);
    this.#panel.dataset.runs = String(runs);
    this.#mark();
  }

  /** Marks the line where the last run ended, while the text is the one that ran. */
  #mark() {
    if (!this.#code) return;
    const {runs, ran, version, sentence: how, line} = this.#state;
    const number = !runs && !this.#changed && ran === version && this.#base === version ? line : 0;
    if (number === this.#marked) return;
    this.#marked = number;
    this.#code.mark(number, how);
  }
}

/** An answer of the host as a sentence. */
function sentence(text) {
  const trimmed = text.trim();
  return `${trimmed[0]?.toUpperCase() ?? ''}${trimmed.slice(1)}.`.replace(/\.\.$/, '.');
}
