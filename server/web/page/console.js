// SPDX-License-Identifier: MIT
// The console: sends command lines to any module, with completion; shows replies, and each command in the clients' languages.
import {aboutPlace, commonStart, explain, placeIn, wordsAt} from './console_complete.js';
import {headOf, inLanguages, programOf} from './console_copy.js';
import {byId, make, say, setText} from './dom.js';
import {t} from './words.js';

const MAX_ENTRIES = 200;
const LONG_TEXT = 200;  // longer reply texts are folded

/** Indents JSON; returns other text unchanged. */
function readable(text) {
  try {
    return JSON.stringify(JSON.parse(text), null, 1);
  } catch {
    return text;
  }
}

export class Console {
  #connection;
  #module = byId('console-module');
  #line = byId('console-line');
  #log = byId('console-log');
  #copy = make('select', {id: 'console-copy', title: t('Copy the commands of the log as a program'), 'aria-label': t('Copy the commands of the log as a program')},
    ...[t('Copy as …'), 'MATLAB', 'Python', 'C++', 'telnet'].map((name, i) => make('option', {value: i ? name : ''}, name)));
  #commands = new Map();  // by module: the commands in its `describe`
  #names = {ROBOT: [], MODULE: [], SCENARIO: []};
  #namePort = 0;
  #history = [];
  #place = 0;
  #cycle = null;  // {line, words, at}: the completions that Tab cycles through

  constructor(connection) {
    this.#connection = connection;
    byId('console').append(this.#copy);
    byId('console').addEventListener('submit', (event) => {
      event.preventDefault();
      this.#send();
    });
    this.#line.addEventListener('keydown', (event) => this.#key(event));
    this.#line.addEventListener('input', () => {
      this.#cycle = null;
      this.#hint();
    });
    this.#line.addEventListener('focus', () => this.#learn(this.#module.value));
    this.#module.addEventListener('change', () => this.#learn(this.#module.value));
    this.#copy.addEventListener('change', () => this.#copyAll());
    connection.addEventListener('push', ({detail}) => this.#pushed(detail));
    connection.addEventListener('open', () => this.#commands.clear());  // it may be another daemon
  }

  /** `first`: the module chosen initially. `namePort`: the port of the name server; 0: off. */
  setModules(modules, first, namePort = 0) {
    this.#namePort = namePort;
    const chosen = this.#module.value;
    const own = modules.filter((module) => !module.external);
    this.#module.replaceChildren(...own.map((module) => make('option', {value: module.name}, module.name)));
    const wanted = [chosen, first].find((name) => own.some((module) => module.name === name));
    if (wanted) this.#module.value = wanted;
    const parts = own.map(({name}) => name.split('/')).filter(({length}) => length === 3);
    this.#names.ROBOT = [...new Set(parts.map(([, robot]) => robot))];
    this.#names.MODULE = [...new Set(parts.map(([, , module]) => module))];
    this.#names.SCENARIO = [...byId('scenarios').options].map(({value}) => value);
    for (const known of [...this.#commands.keys()]) {  // a new robot of the same name may have other modules
      if (!own.some(({name}) => name === known)) this.#commands.delete(known);
    }
  }

  async #learn(module) {
    if (!module) return [];
    if (!this.#commands.has(module)) {
      const reply = await this.#connection.call({module, channel: 'describe', command: 'describe'});
      this.#connection.send({type: 'close', module, channel: 'describe'});
      if (reply.error !== 0) return [];
      // The module's own commands first; the ones common to all modules have ids below 10.
      const commands = JSON.parse(reply.text).commands;
      this.#commands.set(module, commands.sort((a, b) => (a.id < 10) - (b.id < 10)));
    }
    if (module === this.#module.value) this.#hint();
    return this.#commands.get(module);
  }

  get #known() { return this.#commands.get(this.#module.value) ?? []; }

  /** The place in the line, and its possible completions. */
  #look() {
    const place = placeIn(this.#line.value, this.#known);
    return {place, words: wordsAt(place, this.#known, this.#names)};
  }

  #hint() {
    const {place, words} = this.#look();
    let text = '';
    if (place.command) {
      text = [`${place.command.usage ?? place.command.name} – ${place.command.help ?? ''}`, aboutPlace(place)].filter(Boolean).join(' · ');
    } else if (place.word || words.length > 0) {
      text = words.join('  ');
    }
    if (place.word && !place.command && words.length === 0 && this.#known.length > 0) text = t('no such command here; help lists them');
    setText(byId('console-hint'), text);
  }

  /** Completes the line as far as it is unique, then cycles through the completions. Returns whether there was one. */
  #complete(back) {
    const before = this.#line.value;
    if (this.#cycle?.line === before) {
      const {words, start} = this.#cycle;
      this.#cycle.at = (this.#cycle.at + (back ? words.length - 1 : 1)) % words.length;
      this.#cycle.line = this.#line.value = before.slice(0, start) + words[this.#cycle.at];
      return true;
    }
    const {place, words} = this.#look();
    if (words.length === 0 || back) return false;
    const start = 'at' in place ? place.start : before.length - place.word.length;
    const token = before.slice(start), common = commonStart(words);
    const completed = before.slice(0, start) + (words.length === 1 ? `${words[0]} ` : common);
    if (completed.length > before.length && (words.length === 1 || common.length > token.length)) {
      this.#line.value = completed;
      return true;
    }
    if (words.length < 2) return false;
    this.#line.value = before.slice(0, start) + words[0];
    this.#cycle = {line: this.#line.value, words, start, at: 0};
    return true;
  }

  #key(event) {
    if (event.key === 'Tab' && this.#line.value.trim()) {
      if (!this.#complete(event.shiftKey)) return;
      event.preventDefault();
      this.#hint();
    } else if (event.key === 'ArrowUp' || event.key === 'ArrowDown') {
      event.preventDefault();
      const place = this.#place + (event.key === 'ArrowUp' ? -1 : 1);
      if (place < 0 || place > this.#history.length) return;
      this.#place = place;
      this.#line.value = this.#history[place] ?? '';
      this.#hint();
    }
  }

  async #send() {
    const module = this.#module.value;
    const line = this.#line.value.trim();
    if (!line || !module) return;
    if (this.#history.at(-1) !== line) this.#history.push(line);
    this.#place = this.#history.length;
    this.#line.value = '';
    this.#cycle = null;
    this.#hint();
    const entry = this.#write(`${module} > ${line}`, 'sent');
    const waiting = this.#write('…', 'quiet');
    const [reply, commands] = await Promise.all([this.#connection.call({module, line}), this.#learn(module)]);
    const command = commands.find(({id}) => id === reply.sent?.command);
    this.#offerCopies(entry, {module, line, name: command?.name ?? null, ...reply.sent});
    this.#showReply(waiting, reply, command);
    this.#log.scrollTop = this.#log.scrollHeight;
  }

  #showReply(entry, reply, command) {
    const whole = [reply.line, reply.note].filter(Boolean).join('\n') || reply.text;
    const explained = reply.note ? '' : explain(command, reply);
    const isLong = reply.error === 0 && reply.text.length > LONG_TEXT;
    entry.replaceChildren(isLong ? make('details', {}, make('summary', {}, `${reply.text.slice(0, 60)} …`), readable(reply.text)) : whole);
    if (explained) entry.append(make('div', {class: 'explained'}, explained));
    entry.className = reply.error === 0 ? 'reply' : 'reply error';
  }

  /** Buttons that copy a command in each language. */
  #offerCopies(entry, sent) {
    entry.copies = inLanguages(sent);
    const buttons = Object.entries(entry.copies).map(([language, text]) => {
      const head = headOf(language, location.hostname, this.#namePort, [text], this.#names.ROBOT);
      const button = make('button', {type: 'button', class: 'small', title: `${text}\n\n${t('after:')}\n${head}`}, language);
      button.dataset.copy = language;
      button.addEventListener('click', () => this.#toClipboard(text, language));
      return button;
    });
    entry.append(make('span', {class: 'copies', role: 'group', 'aria-label': t('Copy as')}, ...buttons));
  }

  async #copyAll() {
    const language = this.#copy.value;
    this.#copy.value = '';
    const lines = [...this.#log.children].map(({copies}) => copies?.[language]).filter(Boolean);
    if (lines.length === 0) return say(t('send a command first: then the log can be copied as a program'), true);
    await this.#toClipboard(programOf(language, location.hostname, this.#namePort, lines, this.#names.ROBOT), language);
  }

  async #toClipboard(text, language) {
    try {
      await navigator.clipboard.writeText(text);
      say(t('copied as {language}', {language}));
    } catch {  // without HTTPS, only pages of localhost may use the clipboard
      const entry = this.#write(text, 'copied');
      getSelection().selectAllChildren(entry);
      say(t('the browser does not let this page copy: press Ctrl+C'));
    }
  }

  #pushed(message) {
    if (message.channel) return;  // not the console's
    const data = message.data.map(String).join(' ');
    const text = message.command === -1 ? t('closed: {reason}', {reason: message.text}) : `${message.command} ${data} ${message.text}`;
    this.#write(`${message.module} < ${text}`, 'push');
  }

  #write(text, kind) {
    const entry = make('div', {class: kind}, text);
    this.#log.append(entry);
    while (this.#log.childElementCount > MAX_ENTRIES) this.#log.firstElementChild.remove();
    this.#log.scrollTop = this.#log.scrollHeight;
    return entry;
  }
}
