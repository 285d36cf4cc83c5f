// SPDX-License-Identifier: MIT
// The tab Text: an editor for the scenario's text with completion, errors while typing, and buttons. Keeps a draft until the
// browser tab is closed.
import {byId, make, saveFile, say, setText} from './dom.js';
import {isShown, showTab, tab} from './layout.js';
import {plural, t} from './words.js';

const DRAFT = 'coopdyn-draft';
const CHECK_MS = 350;
const EMPTY = '[WORLD]\nfile      arena.world\n\n[ROBOT_1]\ntype      coopbot\nposition  0 0\n';

export class Editor {
  #connection;
  #controls;
  #status = null;
  #code = null;       // code_view.js; null until loaded
  #name = 'my.scenario';
  #running = null;    // the running text; null if unknown
  #runningOf = '';
  #checked = 0;
  #timer = 0;
  #report = null;
  #panel = tab('text', t('Text'));
  #host = make('div', {id: 'editor'});
  #state = make('p', {id: 'editor-state', role: 'status'});

  constructor(connection, controls) {
    this.#connection = connection;
    this.#controls = controls;
    const button = (id, text, title, act, kind = '') => {
      const made = make('button', {type: 'button', id, title, class: kind}, text);
      made.addEventListener('click', act);
      return made;
    };
    this.#panel.append(make('div', {class: 'row'},
      button('editor-load', t('Load'), t('Run this text (Ctrl+Enter)'), () => this.load(), 'primary'),
      button('editor-save', t('Save as file'), t('Keep it on this computer (Ctrl+S)'), () => this.#save()),
      button('editor-running', t('What runs'), t('The text that was loaded'), () => this.#take('api/text', `${this.#status?.scenario ?? 'my'}.scenario`)),
      button('editor-world', t('Current world'), t('The current world as text'), () => this.#takeWorld()),
      button('editor-new', t('New'), t('A small scenario to begin with; Ctrl+Z brings back what was here'), () => this.#replace(EMPTY, 'my.scenario'))),
    this.#host, this.#state);
    this.#panel.addEventListener('shown', () => this.#start());
    this.#panel.addEventListener('keydown', (event) => {
      const ctrl = event.ctrlKey || event.metaKey;
      if (ctrl && event.key === 'Enter') this.load();
      else if (ctrl && event.key.toLowerCase() === 's') this.#save();
      else return;
      event.preventDefault();
      event.stopPropagation();
    }, true);
  }

  /** For tests: the text, and its errors. */
  get text() { return this.#code?.text ?? ''; }
  get report() { return this.#report; }
  get code() { return this.#code; }

  update(status) {
    this.#status = status;
    const off = status.playback ? t('A recording is played: its scenario cannot be changed') : '';
    byId('editor-load').disabled = off !== '';
    byId('editor-load').title = off || t('Run this text (Ctrl+Enter)');
    if (status.scenario !== this.#runningOf && isShown('text')) this.#learnRunning();
  }

  /** Shows the text of a shipped file. */
  async open(kind, name) {
    showTab('text');
    await this.#start();
    await this.#take(`api/text/${kind}/${encodeURIComponent(name)}`, `${name}.${kind}`);
  }

  async load() {
    if (!this.#code) return;
    await this.#controls.loadText(this.text, this.#name, true);
    this.#runningOf = '';
    await this.#learnRunning();
  }

  #starting = null;
  #start() {
    if (!this.#starting) setText(this.#state, t('reading the text …'));
    this.#starting ??= this.#begin();
    return this.#starting;
  }

  async #begin() {
    const names = (kind) => fetch(`api/${kind}`).then((answer) => answer.json()).catch(() => []);
    const [{CodeView}, robots, worlds] = await Promise.all([import('./code_view.js'), names('robots'), names('worlds')]);
    const draft = this.#draft();
    await this.#learnRunning();
    if (draft) this.#name = draft.name;
    else if (this.#status) this.#name = `${this.#status.scenario}.scenario`;
    this.#code = new CodeView(this.#host, draft?.text ?? this.#running ?? EMPTY, {
      robots, worlds: worlds.map((name) => `${name}.world`)}, () => this.#changed());
    this.#check();
  }

  #draft() {
    try {
      return JSON.parse(sessionStorage.getItem(DRAFT));
    } catch {
      return null;
    }
  }

  #changed() {
    try {
      sessionStorage.setItem(DRAFT, JSON.stringify({name: this.#name, text: this.text}));
    } catch { /* a reload loses the draft */ }
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#check(), CHECK_MS);
  }

  async #learnRunning() {
    this.#runningOf = this.#status?.scenario ?? '';
    const answer = await fetch('api/text').catch(() => null);
    if (answer?.ok) this.#running = await answer.text();
    this.#showState();
  }

  #replace(text, name) {
    this.#name = name;
    this.#code?.replace(text);
  }

  async #take(address, name) {
    const answer = await fetch(address).catch(() => null);
    if (!answer?.ok) return say(answer ? (await answer.text()).trim() : t('the daemon does not answer'), true);
    this.#replace(await answer.text(), name);
  }

  async #takeWorld() {
    const reply = await this.#connection.call({module: '/world', command: 'save'});
    if (reply.error !== 0) return say(reply.text, true);
    this.#replace(reply.text, `${this.#status?.scenario ?? 'my'}.scenario`);
  }

  async #check() {
    const turn = ++this.#checked;
    const answer = await fetch('api/check', {method: 'POST', headers: {'Content-Type': 'application/json'},
      body: JSON.stringify({name: this.#name, text: this.text, token: this.#connection.token || undefined})}).catch(() => null);
    if (turn !== this.#checked || !answer) return;
    if (!answer.ok) return setText(this.#state, (await answer.text()).trim());
    this.#report = await answer.json();
    this.#code.mark(this.#report.diagnostics.filter(({file}) => file === this.#name || file === '(text)'));
    this.#showState();
  }

  #showState() {
    if (!this.#report) return;
    const {errors, warnings, summary, diagnostics} = this.#report;
    const counts = [errors > 0 && plural(errors, '{count} error', '{count} errors'), warnings > 0 && plural(warnings, '{count} warning', '{count} warnings')];
    const first = diagnostics[0] ? `; ${t('line {number}', {number: diagnostics[0].line})}: ${diagnostics[0].text}` : '';
    const same = this.#running !== null && this.text.trim() === this.#running.replace(/\n# file: .*\n?$/, '').trim();
    const runs = same ? t('This runs.') : t('Not what runs.');
    this.#state.classList.toggle('error', errors > 0);
    setText(this.#state, errors + warnings > 0 ? counts.filter(Boolean).join(', ') + first : `${runs} ${summary ?? ''}`);
  }

  #save() {
    const ending = this.text.includes('<rosiml') ? '.xml' : '.scenario';
    const name = this.#name.endsWith('.world') ? this.#name : this.#name.replace(/(\.\w+)?$/, ending);
    saveFile(name, new Blob([this.text], {type: 'text/plain'}));
  }
}
