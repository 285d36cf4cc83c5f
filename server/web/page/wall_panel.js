// SPDX-License-Identifier: MIT
// The chosen seat of the wall, at the side: its world larger, all that is known of it, and all orders.
import {idleText, ORDERS} from './class_words.js';
import {byId, make, setText, showNumber} from './dom.js';
import {TopView} from './top_view.js';
import {order, scenariosOf} from './wall_orders.js';
import {handedIn, programText, scoreText} from './wall_tile.js';
import {t} from './words.js';

const ALWAYS = ['reset', 'restart', 'push', 'aside'];

export class Panel {
  #box = byId('panel');
  #tile = null;
  #view;
  #canvas = make('canvas', {class: 'world', 'aria-hidden': 'true'});
  #title = make('h2', {tabIndex: -1});
  #place = make('span', {class: 'quiet'});
  #state = make('span', {class: 'state'});
  #why = make('p', {class: 'why'});
  #facts = make('dl');
  #open = make('a', {class: 'button primary', target: '_blank', rel: 'noopener'}, t('Open the page'));
  #buttons = {};
  #text = make('textarea', {rows: 2, placeholder: t('Message to this student'), 'aria-label': t('Message to this student')});
  #redraw = () => { this.#view.draw(); };
  #reshow = () => { this.#view.show(this.#tile.feed.scene); };

  constructor() {
    this.#view = new TopView(this.#canvas);
    const close = make('button', {type: 'button', class: 'close', 'aria-label': t('Close'), title: t('Close (Esc)')}, '×');
    close.addEventListener('click', () => this.close());
    const orders = make('div', {class: 'orders'}, this.#open, this.#button('take'), this.#button('freeze'), this.#button('lower_hand'), ...ALWAYS.map((name) => this.#button(name)));
    const send = make('button', {}, t('Send'));
    const form = make('form', {class: 'send'}, this.#text, send);
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      const text = this.#text.value.trim();
      if (!text) return this.#text.focus();
      order('message', [this.#tile.seat], {text});
      this.#text.value = '';
    });
    this.#text.addEventListener('keydown', (event) => { if (event.key === 'Enter' && !event.shiftKey) { event.preventDefault(); form.requestSubmit(); } });
    this.#box.append(make('div', {class: 'panel-head'}, make('div', {}, this.#title, this.#place), this.#state, close),
      this.#canvas, this.#why, orders, form, this.#facts);
    this.#box.addEventListener('keydown', ({key}) => { if (key === 'Escape') this.close(); });
    new ResizeObserver(() => this.#view.fit()).observe(this.#canvas);
  }

  get tile() { return this.#tile; }

  #button(name) {
    const made = make('button', {type: 'button', title: ORDERS[name].hint}, ORDERS[name].title);
    made.addEventListener('click', async () => order(made.dataset.does, [this.#tile.seat], {scenarios: name === 'push' ? await scenariosOf([this.#tile.seat]) : []}));
    made.dataset.does = name;
    this.#buttons[name] = made;
    return made;
  }

  #set(button, name) {
    if (button.dataset.does === name) return;
    button.dataset.does = name;
    button.textContent = ORDERS[name].title;
    button.title = ORDERS[name].hint;
  }

  choose(tile) {
    this.#leave();
    this.#tile = tile;
    tile.element.classList.add('chosen');
    tile.feed.addEventListener('poses', this.#redraw);
    tile.feed.addEventListener('scene', this.#reshow);
    this.#box.hidden = false;
    this.#text.value = '';
    this.#open.href = `s/${tile.seat.seat}/`;
    this.#view.show(tile.feed.scene);
    this.update();
    this.#title.focus();
  }

  #leave() {
    this.#tile?.element.classList.remove('chosen');
    this.#tile?.feed.removeEventListener('poses', this.#redraw);
    this.#tile?.feed.removeEventListener('scene', this.#reshow);
  }

  close() {
    if (!this.#tile) return;
    this.#leave();
    this.#box.hidden = true;
    this.#tile.focus();
    this.#tile = null;
  }

  repaint() { this.#view.fit(); }

  update(ago_s = 0) {
    if (!this.#tile) return;
    const {seat, why, state: [key, word]} = this.#tile;
    Object.assign(this.#box.dataset, {state: key, hand: seat.hand, need: Math.min(seat.need, 5)});
    setText(this.#title, seat.name);
    setText(this.#place, [t('seat {seat}', {seat: seat.seat}), seat.group && t('group {group}', {group: seat.group})].filter(Boolean).join(' · '));
    setText(this.#state, word);
    setText(this.#why, why);
    this.#set(this.#buttons.take, seat.taken && !seat.frozen ? 'give' : 'take');
    this.#set(this.#buttons.freeze, seat.frozen ? 'thaw' : 'freeze');
    this.#buttons.lower_hand.hidden = !seat.hand;
    const facts = [
      [t('Scenario'), seat.scenario], [t('Time'), seat.time_s !== undefined && `${showNumber(seat.time_s, 1)} s · ${seat.mode} · × ${showNumber(seat.rtf, 2)}`],
      [t('Program'), programText(seat)], [t('Driven by'), seat.driven_by], [t('Connections'), seat.clients], [t('Idle for'), idleText(seat.idle_s + ago_s)],
      [t('Handed in'), handedIn(seat) > 0 && `${handedIn(seat)} ×`],
      ...(seat.scores ?? []).map((score) => [score.name, `${scoreText(score)}${score.met ? ' ✓' : ''}`]),
      [t('Last error'), seat.error], [t('Trouble'), seat.trouble]].filter(([, value]) => value || value === 0);
    const text = JSON.stringify(facts);
    if (this.#facts.dataset.text === text) return;
    this.#facts.dataset.text = text;
    this.#facts.replaceChildren(...facts.flatMap(([name, value]) => [make('dt', {}, name), make('dd', {}, String(value))]));
  }
}
