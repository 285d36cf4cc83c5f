// SPDX-License-Identifier: MIT
// What a program prints, as it comes. Lines of a traceback lead to the line of the program.
import {make} from './dom.js';
import {t} from './words.js';

const KEPT = 200000;  // characters on the page
const PLACE = /^(\s*File "\/program\/program\.py", )(line (\d+))(.*)$/;

export class ProgramOutput {
  #show;
  #box = make('pre', {id: 'program-output', role: 'log', 'aria-label': t('What the program printed'), 'data-empty': t('What it prints appears here.'), tabIndex: 0});
  #address;
  #run = -1;
  #to = 0;
  #asked = false;
  #again = false;
  #line = '';  // the last one, which has no end yet

  /** `address`: of the output, to which the first byte is appended. `show(number)`: a line of the program. */
  constructor(address, show) {
    this.#address = address;
    this.#show = show;
  }

  get element() { return this.#box; }

  /** `run`: its number; `printed`: the bytes so far. */
  async follow({run, printed}) {
    if (run !== this.#run) {
      this.#run = run;
      this.#to = 0;
      this.#line = '';
      this.#box.replaceChildren();
    }
    if (printed <= this.#to) return;
    if (this.#asked) { this.#again = true; return; }
    this.#asked = true;
    try {
      const answer = await fetch(this.#address + this.#to), said = await answer.json();
      if (run === this.#run) this.#take(said);
    } catch { /* the next event asks again */ }
    this.#asked = false;
    if (!this.#again) return;
    this.#again = false;
    await this.follow({run: this.#run, printed: Infinity});
  }

  #take({run, from, to, text}) {
    if (run !== this.#run) return;
    const atEnd = this.#box.scrollHeight - this.#box.scrollTop - this.#box.clientHeight < 30;
    if (from > this.#to) this.#add(`\n… ${t('{count} bytes left out', {count: from - this.#to})} …\n`);
    this.#to = to;
    this.#add(text);
    while (this.#box.textContent.length > KEPT && this.#box.firstChild !== this.#box.lastChild) this.#box.firstChild.remove();
    if (atEnd) this.#box.scrollTop = this.#box.scrollHeight;
  }

  #add(text) {
    const lines = (this.#line + text).split('\n');
    if (this.#line) this.#box.lastChild.remove();
    this.#line = lines.pop().slice(-KEPT);
    let plain = '';
    const flush = () => {
      if (plain) this.#box.append(make('span', {}, plain));
      plain = '';
    };
    for (const line of lines) {
      const place = PLACE.exec(line);
      if (!place) { plain += `${line}\n`; continue; }
      flush();
      const link = make('button', {type: 'button', class: 'place', title: t('Go to line {number}', {number: place[3]})}, place[2]);
      link.addEventListener('click', () => this.#show(Number(place[3])));
      this.#box.append(make('span', {}, place[1], link, `${place[4]}\n`));
    }
    flush();
    if (this.#line) this.#box.append(make('span', {}, this.#line));
  }
}
