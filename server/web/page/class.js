// SPDX-License-Identifier: MIT
// The bar of a class over the page of a seat: who sits here, the raised hand, what is handed in, what the teacher says; for the
// teacher, whose seat it is.
import {keptText, ORDERS, troubleText, whenText} from './class_words.js';
import {make, setText} from './dom.js';
import {follow, post} from './host_events.js';
import {Program} from './program.js';
import {hostAddress, SEAT, seatIn} from './seat.js';
import {t} from './words.js';

const button = (title, act, properties = {}) => {
  const made = make('button', {type: 'button', ...properties}, title);
  made.addEventListener('click', act);
  return made;
};

/** Puts the bar on the page. `connection`: to the daemon of the seat. */
export class ClassBar {
  #connection;
  #bar = make('section', {id: 'class-bar', 'aria-label': t('Class')});
  #who = make('span', {id: 'class-who'});
  #state = make('p', {id: 'class-state', role: 'status', hidden: true});
  #said = make('p', {id: 'class-said', role: 'status', hidden: true});
  #read = null;     // a trouble that was read
  #asleep = false;
  program = new Program();
  parts;

  constructor(connection) {
    this.#connection = connection;
    this.parts = SEAT.teaches ? new TeacherPart(this) : new StudentPart(this);
    this.#bar.append(this.#who, ...this.parts.elements);
    document.body.prepend(this.#bar, this.#state, this.#said);
    follow(hostAddress('events'), hostAddress(SEAT.teaches ? 'seats' : 'me'), {
      take: (said) => this.#update(seatIn(said)),
      refused: () => location.assign(SEAT.teaches ? '/wall/' : '/'),
    });
  }

  /** Says the answer to something that was done here. */
  say(text, isError = false) {
    this.#said.replaceChildren(text, ' ', button(t('OK'), () => { this.#said.hidden = true; }, {class: 'small'}));
    this.#said.classList.toggle('error', isError);
    this.#said.hidden = text === '';
  }

  #update(seat) {
    if (!seat.name) return;
    document.title = `${seat.name} – coopdyn`;
    this.#who.replaceChildren(...this.parts.who(seat));
    this.parts.update(seat);
    this.program.update(seat.program);
    this.#asleep = seat.daemon === 'asleep';
    document.body.classList.toggle('asleep', this.#asleep);
    this.#showState(seat);
  }

  /** What matters most now. */
  #showState(seat) {
    const trouble = seat.trouble && seat.trouble !== this.#read ? seat.trouble : '';
    if (!seat.trouble) this.#read = null;
    const [kind, text] = this.#asleep ? ['calm', SEAT.teaches ? t('This simulation was put aside.') : t('Your simulation was put aside. It goes on where it was.')]
      : seat.taken && !seat.frozen && !SEAT.teaches ? ['taken', t('The teacher drives now: you can watch.')]
      : seat.frozen && !SEAT.teaches ? ['frozen', t('Frozen by the teacher: look up. Your world goes on afterwards.')]
      : trouble ? ['trouble', `${SEAT.teaches ? trouble : troubleText(trouble)}.`] : ['', ''];
    this.#state.hidden = text === '';
    if (this.#state.dataset.text === text) return;
    this.#state.dataset.text = text;
    this.#state.dataset.kind = kind;
    this.#state.replaceChildren(text);
    if (this.#asleep) this.#state.append(' ', button(t('Go on'), () => this.#connection.open()));
    else if (kind === 'trouble') {
      this.#state.append(' ', button(t('OK'), () => {
        this.#read = trouble;
        this.#state.hidden = true;
      }, {class: 'small'}));
    }
  }
}

class StudentPart {
  #bar;
  #up = false;
  #notes = [];
  #hand = button(t('Raise hand'), () => this.#raise(), {id: 'class-hand', 'aria-pressed': 'false', title: t('The teacher sees it')});
  #handIn = button(t('Hand in'), () => this.#handsIn(), {id: 'class-hand-in', title: t('Keeps your run and your program as they are now, for the teacher')});
  #given = make('details', {id: 'class-given', hidden: true});
  #messages = make('details', {id: 'class-messages', hidden: true});
  #news = make('div', {id: 'class-news', role: 'alert', hidden: true});

  constructor(bar) { this.#bar = bar; }

  get elements() {
    document.body.prepend(this.#news);
    return [this.#hand, this.#handIn, this.#given, this.#messages];
  }

  who(seat) {
    const group = seat.group ? ` · ${t('group {group}', {group: seat.group})}` : '';
    return [make('strong', {}, seat.name), make('span', {class: 'quiet'}, ` ${t('seat {seat}', {seat: seat.seat})}${group}`)];
  }

  update(seat) {
    this.#up = seat.hand;
    this.#hand.setAttribute('aria-pressed', String(seat.hand));
    setText(this.#hand, seat.hand ? t('Hand is up') : t('Raise hand'));
    this.#hand.title = seat.hand ? t('Take it down again') : t('The teacher sees it');
    this.#showGiven(seat.handed_in);
    this.#notes = seat.notes;
    this.#showNotes();
  }

  async #raise() {
    const {error} = await post(hostAddress('hand'), {up: !this.#up});
    if (error) this.#bar.say(error, true);
  }

  async #handsIn() {
    this.#handIn.disabled = true;
    await this.#bar.program.save();
    const {error} = await post(hostAddress('hand-in'), {});
    this.#handIn.disabled = false;
    if (error) return this.#bar.say(error, true);
    const me = await fetch(hostAddress('me')).then((answer) => answer.json()).catch(() => null);
    const last = me?.handed_in.at(-1);
    this.#bar.say(last ? t('Handed in at {time}. Kept: {files}.', {time: whenText(last.when), files: keptText(last.files)}) : t('Handed in.'));
    if (me) this.update(me);
  }

  #showGiven(given) {
    this.#given.hidden = given.length === 0;
    const key = JSON.stringify(given);
    if (this.#given.dataset.key === key) return;
    this.#given.dataset.key = key;
    const results = given.filter(({result}) => result).length;
    this.#given.replaceChildren(
      make('summary', {}, `${t('Handed in: {count}', {count: given.length})}${results > 0 ? `, ${t('{count} with a result', {count: results})}` : ''}`),
      make('ul', {}, ...given.toReversed().map(({when, files, result}) =>
        make('li', {}, make('strong', {}, whenText(when)), ` ${keptText(files)}`, ...(result ? [make('pre', {}, result)] : [])))));
  }

  #key(note) { return `${note.time} ${note.text}`; }

  /** How many notes were read: up to the one that this browser remembers. */
  #readCount() {
    try {
      const last = localStorage.getItem(`coopdyn-read-${SEAT.name}`);
      return this.#notes.findLastIndex((note) => this.#key(note) === last) + 1;
    } catch {
      return 0;
    }
  }

  #showNotes() {
    const unread = this.#notes.slice(this.#readCount());
    this.#news.hidden = unread.length === 0;
    const key = JSON.stringify(unread);
    if (this.#news.dataset.key !== key) {
      this.#news.dataset.key = key;
      this.#news.replaceChildren(
        make('div', {class: 'notes'}, make('strong', {}, t('Your teacher')), ...unread.map(({time, text}) => make('p', {}, make('time', {}, time), ' ', text))),
        button(t('Got it'), () => this.#markRead(), {class: 'primary'}));
    }
    const old = this.#notes.slice(0, this.#notes.length - unread.length);
    this.#messages.hidden = old.length === 0;
    if (this.#messages.dataset.count === String(old.length)) return;
    this.#messages.dataset.count = old.length;
    this.#messages.replaceChildren(make('summary', {}, t('Messages: {count}', {count: old.length})),
      make('ul', {}, ...old.toReversed().map(({time, text}) => make('li', {}, make('time', {}, time), ' ', text))));
  }

  #markRead() {
    try { localStorage.setItem(`coopdyn-read-${SEAT.name}`, this.#key(this.#notes.at(-1))); } catch { /* they stand out again after a reload */ }
    this.#showNotes();
    this.#news.hidden = true;
  }
}

class TeacherPart {
  #bar;
  #take = button('', () => this.#order(this.#seat.taken ? 'give' : 'take'), {id: 'class-take'});
  #freeze = button('', () => this.#order(this.#seat.frozen ? 'thaw' : 'freeze'), {id: 'class-freeze'});
  #lower = button(ORDERS.lower_hand.title, () => this.#order('lower_hand'), {hidden: true, title: ORDERS.lower_hand.hint});
  #seat = {};

  constructor(bar) { this.#bar = bar; }

  get elements() { return [this.#take, this.#freeze, this.#lower, make('a', {href: '../../', id: 'class-wall'}, t('To the wall'))]; }

  who(seat) {
    const [before, after] = t('You are at the seat of {name} as the teacher').split('{name}');
    return [before, make('strong', {}, seat.name), after, make('span', {class: 'quiet'}, seat.taken ? t(': you drive, and the student watches') : '')];
  }

  update(seat) {
    this.#seat = seat;
    for (const [made, name] of [[this.#take, seat.taken ? 'give' : 'take'], [this.#freeze, seat.frozen ? 'thaw' : 'freeze']]) {
      setText(made, ORDERS[name].title);
      made.title = ORDERS[name].hint;
    }
    this.#take.classList.toggle('primary', seat.taken);
    this.#lower.hidden = !seat.hand;
  }

  async #order(name) {
    const {error} = await post(hostAddress('do'), {do: name, seats: [SEAT.name]});
    if (error) this.#bar.say(error, true);
  }
}
