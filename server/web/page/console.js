// SPDX-License-Identifier: MIT
// The console: a line for any module, with completion of commands, and its reply.
import {byId, make, setText} from './dom.js';

const MAX_ENTRIES = 200;

/** The longest beginning that all `words` share. */
function commonStart(words) {
  let start = words[0] ?? '';
  for (const word of words) {
    while (!word.startsWith(start)) start = start.slice(0, -1);
  }
  return start;
}

export class Console {
  #connection;
  #module = byId('console-module');
  #line = byId('console-line');
  #log = byId('console-log');
  #commands = new Map();  // by module: list of {name, usage, help}
  #history = [];
  #place = 0;

  constructor(connection) {
    this.#connection = connection;
    byId('console').addEventListener('submit', (event) => {
      event.preventDefault();
      this.#send();
    });
    this.#line.addEventListener('keydown', (event) => this.#key(event));
    this.#line.addEventListener('input', () => this.#hint());
    this.#line.addEventListener('focus', () => this.#learn());
    this.#module.addEventListener('change', () => this.#learn());
    connection.addEventListener('push', ({detail}) => this.#pushed(detail));
  }

  /** `first`: the name of the one that is chosen to begin with. */
  setModules(modules, first) {
    const chosen = this.#module.value;
    const own = modules.filter((module) => !module.external);
    this.#module.replaceChildren(...own.map((module) => make('option', {value: module.name}, module.name)));
    const wanted = [chosen, first].find((name) => own.some((module) => module.name === name));
    if (wanted) this.#module.value = wanted;
  }

  async #learn() {
    const module = this.#module.value;
    if (!module) return;
    if (!this.#commands.has(module)) {
      const reply = await this.#connection.call({module, channel: 'describe', command: 'describe'});
      this.#connection.send({type: 'close', module, channel: 'describe'});
      if (reply.error !== 0) return;
      // The module's own commands first; those of every module have the ids below 10.
      const commands = JSON.parse(reply.text).commands;
      this.#commands.set(module, commands.sort((a, b) => (a.id < 10) - (b.id < 10)));
    }
    this.#hint();
  }

  #matches() {
    const word = this.#line.value.trimStart().split(/[\s(]/)[0];
    const commands = this.#commands.get(this.#module.value) ?? [];
    return {word, matches: commands.filter((command) => command.name.startsWith(word))};
  }

  #hint() {
    const {word, matches} = this.#matches();
    const exact = matches.find((command) => command.name === word);
    let text = '';
    if (exact) text = `${exact.usage ?? exact.name} – ${exact.help ?? ''}`;
    else if (word || matches.length > 0) text = matches.map((command) => command.name).join('  ');
    if (word && matches.length === 0 && this.#commands.has(this.#module.value)) text = 'no such command here; help lists them';
    setText(byId('console-hint'), text);
  }

  #key(event) {
    if (event.key === 'Tab' && !event.shiftKey && this.#line.value.trim() && !/\s/.test(this.#line.value.trim())) {
      const {word, matches} = this.#matches();
      const start = commonStart(matches.map((command) => command.name));
      const completed = matches.length === 1 ? `${start} ` : start;
      if (completed.length > word.length && completed !== this.#line.value) {
        event.preventDefault();
        this.#line.value = completed;
        this.#hint();
      }
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
    this.#hint();
    this.#write(`${module} > ${line}`, 'sent');
    const waiting = this.#write('…', 'quiet');
    const reply = await this.#connection.call({module, line});
    const text = [reply.line, reply.note].filter(Boolean).join('\n') || reply.text;
    waiting.textContent = text;
    waiting.className = reply.error === 0 ? 'reply' : 'reply error';
    this.#log.scrollTop = this.#log.scrollHeight;
  }

  #pushed(message) {
    if (message.channel) return;  // not the console's
    const data = message.data.map(String).join(' ');
    const text = message.command === -1 ? `closed: ${message.text}` : `${message.command} ${data} ${message.text}`;
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
