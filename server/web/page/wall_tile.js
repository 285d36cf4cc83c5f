// SPDX-License-Identifier: MIT
// A seat on the wall: its world from above, and what one must know of it at a glance.
import {hostText, idleText, languageText, ORDERS, stateOf} from './class_words.js';
import {make, setText, showNumber} from './dom.js';
import {unitText} from './scores.js';
import {SeatFeed} from './seat_feed.js';
import {TopView} from './top_view.js';
import {t} from './words.js';

const MOVES_MS = 2500;  // time that has gone on within this goes on
const TROUBLE_MS = 60000;  // what has happened to a daemon that runs again is said so long
const QUICK = ['freeze', 'message', 'lower_hand'];

/** "3", "12.5 m". */
export const scoreText = ({value, unit}) => (unit ? `${showNumber(value, 2)} ${unitText(unit)}` : showNumber(value, Number.isInteger(value) ? 0 : 2));

/** What drives, or would: "Python drives", "MATLAB, not driving". */
export function programText(seat) {
  if (seat.program?.runs) return seat.driven_by ? t('a program of the page drives') : t('a program of the page runs');
  const language = languageText(seat.language), drives = seat.driven_by ?? '';
  if (language && drives) return t('{name} drives', {name: language});
  if (seat.program?.error && !drives) return t('a program of the page ended with an error');
  if (drives) return drives.startsWith('page') ? t('the page drives') : t('{name} drives', {name: drives});
  return language ? t('{name}, not driving', {name: language}) : t('nobody drives');
}

/** How often a student has handed in. */
export const handedIn = ({handed_in: given = 0}) => given.length ?? given;

/** "ana · group 1"; without the seat if that is the name in other letters. */
function placeText({seat, name, group}) {
  const plain = name.normalize('NFD').replace(/[^a-zA-Z0-9]/g, '').toLowerCase();
  return [seat.replace(/[-_]/g, '') !== plain && seat, group && t('group {group}', {group})].filter(Boolean).join(' · ');
}

export class Tile {
  seat = {};
  feed;
  element = make('li', {class: 'tile'});
  #view;
  #canvas = make('canvas', {class: 'world', 'aria-hidden': 'true'});
  #name = make('button', {type: 'button', class: 'name'});
  #state = make('span', {class: 'state'});
  #place = make('span', {class: 'place'});
  #note = make('span', {class: 'note'});
  #why = make('p', {class: 'why'});
  #program = make('span', {class: 'program'});
  #idle = make('span', {class: 'idle', title: t('How long the student has done nothing')});
  #scores = make('span', {class: 'scores'});
  #given = make('span', {class: 'given', title: t('How often the student has handed in')});
  #quick;
  #time = 0;
  #movedAt = -Infinity;
  #dirty = false;
  #seen = false;
  #troubleAt = -Infinity;
  state = ['asleep', t('asleep')];
  why = '';   // the seat needs help, or did
  drawn = 0;  // pictures

  /** `act(tile, order)`: for a click on one of the quick orders, or 'open', or 'choose'. */
  constructor(name, act) {
    this.element.dataset.seat = name;
    this.feed = new SeatFeed(`s/${name}/`);
    this.feed.addEventListener('scene', () => {
      this.#view.show(this.feed.scene);
      this.element.classList.add('has-world');
    });
    this.feed.addEventListener('poses', () => { this.#dirty = true; });
    this.#view = new TopView(this.#canvas);
    const quick = (order, title, hint) => {
      const made = make('button', {type: 'button', tabIndex: -1, class: 'small', title: hint}, title);
      made.dataset.does = order;
      made.addEventListener('click', () => act(this, order));
      return made;
    };
    this.#quick = make('div', {class: 'quick'}, quick('open', t('Open'), t('The seat’s page, in a new tab')),
      ...QUICK.map((order) => quick(order, ORDERS[order].title, ORDERS[order].hint)));
    this.#name.addEventListener('click', () => act(this, 'choose'));
    this.element.append(
      make('div', {class: 'head'}, this.#name, this.#place, this.#state),
      this.#why,
      make('div', {class: 'stage'}, this.#canvas, make('span', {class: 'hand', 'aria-hidden': 'true'}), this.#scores, this.#quick,
        make('div', {class: 'foot'}, this.#program, this.#given, this.#note, this.#idle)));
    new ResizeObserver(() => this.#view.fit()).observe(this.#canvas);
  }

  /** `now`: ms. `ago_s`: since when `seat` was so. */
  update(seat, now, ago_s = 0) {
    if (seat.time_s !== undefined && seat.time_s !== this.#time) {
      this.#time = seat.time_s;
      this.#movedAt = now;
    }
    if (seat.trouble !== this.seat.trouble || seat.daemon !== 'running') this.#troubleAt = now;
    const trouble = now - this.#troubleAt < TROUBLE_MS ? seat.trouble : '';
    this.seat = seat;
    this.state = stateOf(seat, now - this.#movedAt < MOVES_MS);
    const [key, word] = this.state;
    setText(this.#name, seat.name);
    setText(this.#place, placeText(seat));
    setText(this.#state, word.replace(/:.*/, ''));
    this.#state.title = word;
    Object.assign(this.element.dataset, {state: key, hand: seat.hand, need: Math.min(seat.need, 5), taken: seat.taken && !seat.frozen});
    setText(this.#program, seat.taken && !seat.frozen ? t('you drive') : key === 'asleep' || !(seat.driven_by || seat.language || seat.program?.runs || seat.program?.error) ? '' : programText(seat));
    const idle = seat.idle_s + ago_s;
    setText(this.#idle, key === 'asleep' ? '' : idle < 10 ? t('active') : t('idle {time}', {time: idleText(idle)}));
    setText(this.#given, handedIn(seat) > 0 ? t('handed in {count}', {count: handedIn(seat)}) : '');
    this.why = hostText(seat.why) || trouble || seat.error;
    const why = this.why || (key === 'ended' ? seat.ended ?? '' : '');
    setText(this.#why, why);
    this.#why.title = why;
    const lives = key !== 'asleep' && seat.time_s !== undefined;
    setText(this.#note, lives ? `${showNumber(seat.time_s, 1)} s` : '');
    const scores = (seat.scores ?? []).slice(0, 2).map((score) => `${score.name} ${scoreText(score)}`);
    setText(this.#scores, lives ? scores.join(' · ') : '');
    this.#quick.querySelector('[data-does="lower_hand"]').hidden = !seat.hand;
    const freeze = this.#quick.querySelector('[data-does="freeze"]');
    setText(freeze, ORDERS[seat.frozen ? 'thaw' : 'freeze'].title);
    this.#listen();
  }

  /** Whether the tile is on the screen; without `seen` after the tab was hidden or shown. */
  setSeen(seen = this.#seen) {
    this.#seen = seen;
    this.#listen();
  }

  #listen() { this.feed.want(this.#seen && !document.hidden && this.seat.daemon === 'running'); }

  repaint() { this.#view.fit(); }

  /** Draws if something has moved. */
  draw() {
    if (!this.#dirty || !this.#seen) return;
    this.#dirty = false;
    this.#view.draw();
    ++this.drawn;
  }

  focus() { this.#name.focus(); }
}
