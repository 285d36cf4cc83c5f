// SPDX-License-Identifier: MIT
// The tab Gallery: scenarios, worlds and robots with their pictures. A click loads a scenario or a world; robots are dragged onto the floor.
import {make, say, setText} from './dom.js';
import {tab} from './layout.js';
import {t} from './words.js';
import {startDrag} from './world.js';

const KINDS = [['scenarios', 'scenario', t('Scenarios')], ['worlds', 'world', t('Worlds')], ['robots', 'robot', t('Robots')]];

const AT_ONCE = 3;  // of the browser's six connections; the rest stay free for clicks

/** Loads the pictures that scroll into view, a few at a time. */
class PictureLoader {
  #waiting = [];
  #loading = 0;
  #watch = new IntersectionObserver((seen) => {
    for (const {isIntersecting, target} of seen) {
      if (!isIntersecting) continue;
      this.#watch.unobserve(target);
      this.#waiting.push(target);
    }
    this.#next();
  });

  add(picture, address) {
    picture.dataset.from = address;
    this.#watch.observe(picture);
  }

  #next() {
    while (this.#loading < AT_ONCE && this.#waiting.length > 0) {
      const picture = this.#waiting.shift();
      if (!picture.isConnected) continue;
      ++this.#loading;
      const done = () => {
        --this.#loading;
        this.#next();
      };
      picture.addEventListener('load', done, {once: true});
      picture.addEventListener('error', done, {once: true});
      picture.src = picture.dataset.from;
    }
  }
}

export class Gallery {
  #controls;
  #edit;
  #world = null;
  #asked = false;
  #listed = {};
  #pictures = new PictureLoader();
  #panel = tab('arena', t('Gallery'));
  #find = make('input', {type: 'search', id: 'gallery-find', 'aria-label': t('Find a scenario, a world or a robot'), title: t('Find by name or title')});
  #groups = make('div', {id: 'gallery'}, make('p', {class: 'loading'}, t('reading the gallery …')));
  #status = null;

  /** `edit(kind, name)` opens a text in the editor. */
  constructor(controls, edit) {
    this.#controls = controls;
    this.#edit = edit;
    this.#find.addEventListener('input', () => this.#show());
    this.#panel.append(make('div', {class: 'row'}, make('label', {class: 'grow'}, `${t('Find')} `, this.#find)),
      make('p', {class: 'quiet'}, t('A .scenario, .xml (an experiment of YARS), .world, .sdf or .urdf file can be dropped anywhere on the page.')), this.#groups);
    this.#panel.addEventListener('shown', () => { if (!this.#asked) this.refresh(); });
  }

  /** Enables inserting robots. */
  setWorld(world) { this.#world = world; }

  update(status) {
    this.#status = status;
    for (const button of this.#groups.querySelectorAll('.thumb')) this.#mark(button);
  }

  /** Marks the running scenario; disables loading during a playback. */
  #mark(button) {
    const runs = button.dataset.kind === 'scenario' && button.dataset.name === this.#status?.scenario;
    button.setAttribute('aria-pressed', String(runs));
    button.disabled = Boolean(this.#status?.playback);
  }

  async refresh() {
    this.#asked = true;
    try {
      this.#listed = await (await fetch('api/gallery')).json();
    } catch {
      this.#asked = false;  // the banner shows that the daemon is gone
      return;
    }
    this.#show();
  }

  #show() {
    const wanted = this.#find.value.trim().toLowerCase();
    this.#groups.replaceChildren(...KINDS.flatMap(([key, kind, title]) => {
      const found = (this.#listed[key] ?? []).filter((entry) => `${entry.name} ${entry.title}`.toLowerCase().includes(wanted));
      return found.length === 0 ? [] : [make('h2', {}, `${title} `, make('span', {class: 'quiet'}, String(found.length))),
        make('div', {class: 'cards'}, ...found.map((entry) => this.#card(kind, entry)))];
    }));
    if (this.#asked && this.#groups.childElementCount === 0) this.#groups.append(make('p', {class: 'quiet'}, t('no match')));
  }

  #card(kind, {name, title, summary, thumb}) {
    const picture = make('img', {alt: '', width: 160, height: 100, draggable: false});
    picture.addEventListener('error', () => { picture.hidden = true; });
    if (thumb) this.#pictures.add(picture, thumb.replace(/^\//, ''));
    else picture.hidden = true;  // the daemon runs without pictures
    const does = kind === 'robot' ? t('drag it onto the floor, or click') : t('click to load');
    const button = make('button', {type: 'button', class: 'thumb', title: `${title || name}\n${summary}\n(${does})`},
      picture, make('strong', {}, name), make('span', {class: 'quiet'}, title || summary));
    button.dataset.name = name;
    button.dataset.kind = kind;
    this.#mark(button);
    button.addEventListener('click', () => this.#take(kind, name));
    if (kind === 'robot') {
      button.draggable = true;
      button.addEventListener('dragstart', (event) => {
        startDrag(event, 'robot', name);
      });
      return button;
    }
    const edit = make('button', {type: 'button', class: 'small', title: t('Show the text of {name}', {name})}, t('Text'));
    edit.addEventListener('click', () => this.#edit(kind, name));
    return make('div', {class: 'thumb-box'}, button, edit);
  }

  #take(kind, name) {
    if (kind === 'scenario') return this.#controls.load({command: 'load_scenario', text: name});
    if (kind === 'world') return this.#controls.load({command: 'load_scenario', text: `[WORLD]\nfile ${name}.world\n`}, name);
    if (!this.#world) return say(t('robots cannot be dropped on the view drawn by the daemon: insert them with /world'), true);
    return this.#world.insertNear('robot', name);
  }
}
