// SPDX-License-Identifier: MIT
// The teacher's wall: a tile for each seat, those that need help first.
import {hostText, ORDERS, sentenceOf} from './class_words.js';
import {byId, make, say, setText} from './dom.js';
import {follow, post} from './host_events.js';
import {listenToTheme} from './layout.js';
import {gridFor} from './wall_grid.js';
import {order, scenariosOf} from './wall_orders.js';
import {Panel} from './wall_panel.js';
import {Tile} from './wall_tile.js';
import {plural, t} from './words.js';

const KEPT = 'coopdyn-wall';
const HELD_MS = 6000;     // after the last touch of the pointer or a key among the tiles, their order stays so long
const TICK_MS = 1000;
const MOVE_MS = 450;
const FOR_ALL = ['freeze', 'thaw', 'message', 'lower_hand', 'reset', 'restart', 'push', 'take', 'give', 'aside'];
const SHOWN_FOR_ALL = 3;  // the others are in a menu
const COUNTED = {
  hand: (count) => plural(count, 'hand up', 'hands up'), crashed: (count) => t('crashed', {count}), waiting: (count) => t('waiting', {count}),
  running: (count) => t('running', {count}), paused: (count) => t('paused', {count}), frozen: (count) => t('frozen', {count}),
  ended: (count) => t('ended', {count}), starting: (count) => t('starting', {count}), asleep: (count) => t('asleep', {count}),
};

class Wall {
  tiles = new Map();  // by seat
  #list = byId('tiles');
  #panel = new Panel();
  #said = null;       // the last event
  #saidAt = 0;
  #order = [];        // seats as the host has sorted them
  #touched = -Infinity;
  #seen = new IntersectionObserver((entries) => {
    for (const {target, isIntersecting} of entries) this.tiles.get(target.dataset.seat)?.setSeen(isIntersecting);
  });
  #still = matchMedia('(prefers-reduced-motion: reduce)');

  constructor() {
    for (const event of ['pointermove', 'pointerdown', 'keydown']) this.#list.addEventListener(event, () => { this.#touched = performance.now(); });
    this.#list.addEventListener('pointerleave', () => { this.#touched = -Infinity; });
    this.#list.addEventListener('keydown', (event) => this.#walk(event));
    byId('group').addEventListener('change', () => this.#showGroup());
    document.addEventListener('keydown', ({key, target}) => { if (key === 'Escape' && !target.closest('dialog, textarea')) this.#panel.close(); });
    document.addEventListener('visibilitychange', () => { for (const tile of this.tiles.values()) tile.setSeen(); });
    document.addEventListener('theme', () => this.#repaint());
    new ResizeObserver(() => this.#fit()).observe(document.querySelector('main'));
    this.#makeOrders();
    setInterval(() => this.#tick(), TICK_MS);
    const draw = () => {
      for (const tile of this.tiles.values()) tile.draw();
      requestAnimationFrame(draw);
    };
    requestAnimationFrame(draw);
  }

  /** `said`: an event of the host. */
  update(said) {
    this.#said = said;
    this.#saidAt = performance.now();
    const present = new Set(said.seats.map(({seat}) => seat));
    for (const [name, tile] of this.tiles) {
      if (present.has(name)) continue;
      if (this.#panel.tile === tile) this.#panel.close();
      tile.feed.want(false);
      tile.element.remove();
      this.tiles.delete(name);
    }
    const fresh = said.seats.filter(({seat}) => !this.tiles.has(seat));
    for (const {seat} of fresh) {
      const tile = new Tile(seat, (one, does) => this.#act(one, does));
      this.tiles.set(seat, tile);
      this.#list.append(tile.element);
      this.#seen.observe(tile.element);
    }
    this.#order = said.seats.map(({seat}) => seat);
    this.#showGroups();
    this.#showLessons();
    this.#tick();
    if (fresh.length > 0) {
      this.#sort(true);
      this.#showGroup();
    }
  }

  /** Once a second, and with each event: what depends on time. */
  #tick() {
    if (!this.#said) return;
    const now = performance.now(), ago_s = (now - this.#saidAt) / 1000;
    for (const seat of this.#said.seats) this.tiles.get(seat.seat).update(seat, now, ago_s);
    this.#panel.update(ago_s);
    this.#count();
    if (now - this.#touched > HELD_MS) this.#sort();
  }

  // --- the order of the tiles
  /** Moves the tiles to the order of the host; a tile that moves is seen moving. */
  #sort(atOnce = false) {
    const now = [...this.#list.children].map((element) => element.dataset.seat);
    if (now.join() === this.#order.join()) return;
    const before = new Map([...this.#list.children].map((element) => [element, element.getBoundingClientRect()]));
    const focused = document.activeElement;
    this.#list.append(...this.#order.map((seat) => this.tiles.get(seat).element));
    if (this.#list.contains(focused)) focused.focus({preventScroll: true});
    if (atOnce || this.#still.matches) return;
    for (const [element, was] of before) {
      const is = element.getBoundingClientRect(), x = was.left - is.left, y = was.top - is.top;
      if (x !== 0 || y !== 0) element.animate([{transform: `translate(${x}px, ${y}px)`}, {transform: 'none'}], {duration: MOVE_MS, easing: 'cubic-bezier(0.2, 0.7, 0.2, 1)'});
    }
  }

  get #shown() { return this.#order.map((seat) => this.tiles.get(seat)).filter(({element}) => !element.hidden); }

  #fit() {
    const main = document.querySelector('main'), style = getComputedStyle(main), gap = parseFloat(getComputedStyle(this.#list).columnGap) || 0;
    const width = main.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
    const height = main.clientHeight - parseFloat(style.paddingTop) - parseFloat(style.paddingBottom);
    const {columns, rows, scrolls} = gridFor(Math.max(1, this.#shown.length), width, height, gap);
    this.#list.style.setProperty('--columns', columns);
    this.#list.style.setProperty('--row', scrolls ? '11rem' : `${Math.min((height - gap * (rows - 1)) / rows, 640)}px`);
  }

  #repaint() {
    for (const tile of this.tiles.values()) tile.repaint();
    this.#panel.repaint();
  }

  /** Arrow keys go from tile to tile. */
  #walk(event) {
    const shown = [...this.#list.children].filter(({hidden}) => !hidden);
    const at = shown.findIndex((element) => element.contains(document.activeElement));
    const columns = Number(this.#list.style.getPropertyValue('--columns'));
    const step = {ArrowRight: 1, ArrowLeft: -1, ArrowDown: columns, ArrowUp: -columns}[event.key];
    const next = shown[at + step];
    if (at < 0 || !step || !next) return;
    event.preventDefault();
    this.tiles.get(next.dataset.seat).focus();
  }

  // --- groups
  #showGroups() {
    const groups = [...new Set(this.#said.seats.map(({group}) => group).filter(Boolean))].toSorted((a, b) => a.localeCompare(b, undefined, {numeric: true}));
    const select = byId('group'), key = groups.join('\n');
    byId('group-box').hidden = groups.length === 0;
    if (select.dataset.key === key) return;
    select.dataset.key = key;
    const chosen = select.value;
    select.replaceChildren(make('option', {value: ''}, t('all')), ...groups.map((group) => make('option', {value: group}, group)));
    select.value = groups.includes(chosen) ? chosen : '';
  }

  #showGroup() {
    const group = byId('group').value;
    for (const tile of this.tiles.values()) tile.element.hidden = group !== '' && tile.seat.group !== group;
    byId('nobody').hidden = this.#shown.length > 0;
    this.#fit();
    this.#count();
  }

  // --- the header
  #count() {
    const shown = this.#shown, counts = new Map();
    for (const {state: [key], seat} of shown) {
      counts.set(key, (counts.get(key) ?? 0) + 1);
      if (seat.hand) counts.set('hand', (counts.get('hand') ?? 0) + 1);
    }
    const text = [`${shown.length}`, ...counts].join();
    const list = byId('counts');
    if (list.dataset.text === text) return;
    list.dataset.text = text;
    list.replaceChildren(make('li', {}, make('b', {}, String(shown.length)), ` ${plural(shown.length, 'seat', 'seats')}`),
      ...Object.entries(COUNTED).filter(([key]) => counts.has(key)).map(([key, text]) => {
        const item = make('li', {}, make('b', {}, String(counts.get(key))), ` ${text(counts.get(key))}`);
        item.dataset.state = key;
        return item;
      }));
    const hands = counts.get('hand') ?? 0;
    document.title = `${hands > 0 ? `(${hands}) ` : ''}${t('Class wall – coopdyn')}`;
  }

  #showLessons() {
    const {lessons, lesson} = this.#said, nav = byId('lessons');
    const key = JSON.stringify([lessons, lesson]);
    if (nav.dataset.key === key) return;
    nav.dataset.key = key;
    const short = (name) => name.replace(/^.*\//, '').replace(/\.scenario$/, '');
    const steps = lessons.map((name, i) => {
      const step = make('li', {title: name}, short(name));
      if (i === lesson) step.setAttribute('aria-current', 'step');
      return step;
    });
    nav.replaceChildren(make('ol', {}, ...steps));
    if (lesson + 1 >= lessons.length) return;
    const next = make('button', {type: 'button', id: 'next', title: ORDERS.next.hint}, t('Next'));
    // The lesson plan is everybody's, whatever group is shown.
    next.addEventListener('click', () => order('next', this.#said.seats, {all: true, about: `${t('Everybody loads {name}.', {name: short(lessons[lesson + 1])})} ${ORDERS.next.asks}`}));
    nav.append(next);
  }

  #makeOrders() {
    const made = FOR_ALL.map((name) => {
      const button = make('button', {type: 'button', title: ORDERS[name].hint}, ORDERS[name].title);
      button.dataset.does = name;
      button.addEventListener('click', async () => {
        more.open = false;
        const seats = this.#shown.map(({seat}) => seat).filter(({hand}) => name !== 'lower_hand' || hand);
        if (seats.length === 0) return say(name === 'lower_hand' ? t('no hand is up') : t('no seat is shown'));
        order(name, seats, {all: seats.length === this.#said.seats.length, scenarios: name === 'push' ? await scenariosOf(seats) : []});
      });
      return button;
    });
    const more = make('details', {class: 'menu'}, make('summary', {class: 'button'}, t('More')), make('div', {}, ...made.slice(SHOWN_FOR_ALL)));
    byId('all').append(make('span', {class: 'quiet'}, t('All')), ...made.slice(0, SHOWN_FOR_ALL), more);
    document.addEventListener('pointerdown', ({target}) => { if (!more.contains(target)) more.open = false; });
    more.addEventListener('keydown', ({key}) => { if (key === 'Escape') { more.open = false; more.firstElementChild.focus(); } });
  }

  #act(tile, does) {
    if (does === 'choose') return this.#panel.tile === tile ? this.#panel.close() : this.#panel.choose(tile);
    if (does === 'open') return window.open(`s/${tile.seat.seat}/`, '_blank', 'noopener');
    order(does === 'freeze' && tile.seat.frozen ? 'thaw' : does, [tile.seat]);
  }
}

/** Shows the wall to whom the host knows as the teacher. */
function open() {
  byId('unlock').hidden = true;
  byId('top').hidden = false;
  byId('room').hidden = false;
  const wall = new Wall();
  window.coopdyn = {wall};  // for tests, and for the curious
  follow('class/events', 'class/seats', {
    take(said) {
      byId('lost').hidden = true;
      wall.update(said);
    },
    lost: () => { byId('lost').hidden = false; },
    refused: () => location.reload(),
  });
}

async function unlock(token) {
  const {error} = await post('login', {token});
  setText(byId('unlock-answer'), sentenceOf(hostText(error)));
  if (error) return byId('token').select();
  try { localStorage.setItem(KEPT, 'yes'); } catch { /* the next visit asks the host */ }
  if (location.hash === '#to=sheet') return location.replace('class/sheet');  // its address leads here without the token
  open();
}

/** Whether this browser was let in once: else there is nothing to ask the host. */
function wasOpen() {
  try { return localStorage.getItem(KEPT) !== null; } catch { return true; }
}

/** The token in the address, which is taken out of it: projectors show the address. */
function tokenInAddress() {
  const token = new URLSearchParams(location.hash.slice(1)).get('token');
  if (token) history.replaceState(null, '', location.pathname);
  return token;
}

async function start() {
  listenToTheme();
  addEventListener('hashchange', () => {  // the address was entered in this tab
    const token = tokenInAddress();
    if (token && !byId('unlock').hidden) unlock(token);
  });
  byId('unlock').addEventListener('submit', (event) => {
    event.preventDefault();
    unlock(byId('token').value.trim());
  });
  const given = tokenInAddress();
  if (given) {
    await unlock(given);
    if (byId('unlock-answer').textContent === '') return;
  } else if (wasOpen() && (await fetch('class/seats').catch(() => null))?.ok) {
    return open();
  }
  byId('unlock').hidden = false;
  byId('token').focus();
}
start();
