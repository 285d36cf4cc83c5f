// SPDX-License-Identifier: MIT
// The people viewing this daemon's page: their names, each can change their own, and their selections.
import {byId, make} from './dom.js';
import {t} from './words.js';

const KEPT = 'coopdyn-name';
const SHOWN = 6;
const MOST = 20;  // letters of a name
const nameOf = ({name, id}) => name || t('guest {id}', {id});
const initials = (name) => name.split(/\s+/).map((word) => word[0] ?? '').join('').slice(0, 2).toUpperCase();
const hueOf = (id) => Math.round(id * 137.5) % 360;

export class People {
  #connection;
  #own = 0;
  #name = '';
  #selected = '';
  #list = make('span', {id: 'people', role: 'list', 'aria-label': t('Who looks')});
  people = [];

  constructor(connection) {
    this.#connection = connection;
    try { this.#name = localStorage.getItem(KEPT) ?? ''; } catch { /* stay a guest */ }
    byId('strip-end').prepend(this.#list);
    connection.addEventListener('hello', ({detail}) => {
      this.#own = detail.person ?? 0;
      if (this.#name || this.#selected) this.#tell();
    });
    connection.addEventListener('people', ({detail}) => {
      this.people = detail.people;
      this.#show();
    });
  }

  /** Names the person at this page, unless they have named themselves. */
  call(name) {
    if (this.#name || !name) return;
    this.#name = name.slice(0, MOST);
    this.#tell();
  }

  /** Whether this person did what an event tells. */
  isOwn(text) { return this.#name !== '' && text.endsWith(` by ${this.#name}`); }

  /** Reports this page's selection. */
  select(name) {
    if (name === this.#selected) return;
    this.#selected = name;
    this.#tell();
  }

  #tell() { this.#connection.send({type: 'me', name: this.#name, selected: this.#selected}); }

  #show() {
    if (this.#list.querySelector('input')) return;  // a name is being typed
    const chips = this.people.slice(0, SHOWN).map((person) => {
      const own = person.id === this.#own, name = nameOf(person);
      const at = person.selected ? `, ${t('selected {thing}', {thing: person.selected})}` : '';
      const chip = make(own ? 'button' : 'span', {class: 'person', role: own ? 'button' : 'listitem',
        title: own ? t('You are {name}: click to change your name', {name}) : `${name}${at}`, 'aria-label': own ? t('You: {name}', {name}) : `${name}${at}`}, initials(name));
      chip.style.setProperty('--hue', hueOf(person.id));
      if (own) chip.addEventListener('click', () => this.#rename());
      return chip;
    });
    const more = this.people.length - chips.length;
    // A single person needs no name.
    this.#list.replaceChildren(...(this.people.length > 1 ? chips : []), ...(more > 0 ? [make('span', {class: 'quiet'}, `+${more}`)] : []));
  }

  #rename() {
    const field = make('input', {id: 'own-name', value: this.#name, maxLength: MOST, size: 10, 'aria-label': t('Your name')});
    let ended = false;  // removing the field blurs it
    const end = (keep) => {
      if (ended) return;
      ended = true;
      if (keep) this.#name = field.value.trim();
      field.remove();
      try { localStorage.setItem(KEPT, this.#name); } catch { /* kept until the page closes */ }
      this.#tell();
      this.#show();
    };
    field.addEventListener('keydown', ({key}) => { if (key === 'Enter' || key === 'Escape') end(key === 'Enter'); });
    field.addEventListener('blur', () => end(true));
    this.#list.replaceChildren(field);
    field.focus();
    field.select();
  }
}
