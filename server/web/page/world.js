// SPDX-License-Identifier: MIT
// The panel World: a palette to drag onto the floor, the list of things, a form for the selected one, undo and redo. Every
// change is an edit of /world, so that other pages and recordings see it.
import {byId, icon, make, saveFile, say, setText, showNumber} from './dom.js';
import {isShown, showTab, tab} from './layout.js';
import {shownColor} from './palette.js';
import {t} from './words.js';

const MODULE = '/world';
const SNAP_M = 0.05;
const ROOM_M = 0.35;  // kept free around a new thing
export const DRAGGED = 'application/x-coopdyn-sections';
/** Sizes of what the palette has, m: for the picture while it is dragged. */
const SIZES = {box: [0.5, 0.5, 0.5], cylinder: [0.4, 0.4, 0.5], sphere: [0.4, 0.4, 0.4], wall: [2, 0.1, 0.5], robot: [0.4, 0.4, 0.25],
  target: [0.2, 0.2, 0.6], light: [0.1, 0.1, 2.5]};

let dragged = null;

/** Begins to drag a new `kind` to the view. */
export function startDrag(event, kind, choice) {
  dragged = {kind, choice};
  event.dataTransfer.setData(DRAGGED, JSON.stringify(dragged));
  event.dataTransfer.effectAllowed = 'copy';
}
const SHAPES = {
  box: 'type box\nsize 0.5 0.5 0.5\nmass 2\ncolor orange',
  cylinder: 'type cylinder\nsize 0.4 0.4 0.5\nmass 2\ncolor teal',
  sphere: 'type sphere\nsize 0.4\nmass 1\ncolor yellow',
  wall: 'type box\nsize 2 0.1 0.5\ncolor lightgray',
};
const COLORS = ['red', 'green', 'blue', 'yellow', 'magenta', 'cyan', 'orange', 'purple'];

const short = (x) => String(+Number(x).toFixed(4));
const snapped = (x) => short(Math.round(x / SNAP_M) * SNAP_M);
/** The yaw of a quaternion w x y z, in degrees. */
const yawOf = ([w, x, y, z]) => Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) * 180 / Math.PI;
const hex = (rgb) => `#${rgb.map((part) => Math.round(255 * part).toString(16).padStart(2, '0')).join('')}`;
const rgbOf = (text) => [1, 3, 5].map((at) => short(parseInt(text.slice(at, at + 2), 16) / 255)).join(' ');

/** The scenario sections that put a `kind` at a point on the floor. */
function sectionsFor(kind, x, y, choice) {
  const at = `position ${snapped(x)} ${snapped(y)}`;
  if (kind === 'robot') return `[ROBOT_*]\ntype ${choice}\n${at}`;
  if (kind === 'target') return `[TARGET]\n${choice} ${snapped(x)} ${snapped(y)} 0.3`;
  if (kind === 'light') return `[LIGHT_*]\nposition ${snapped(x)} ${snapped(y)} 2.5`;
  return `[${kind.toUpperCase()}_*]\n${SHAPES[kind]}\n${at}`;
}

export class World {
  #connection;
  #view;
  #world = null;      // the last reply to `list`
  #name = '';         // of the selected thing
  #shadow = null;
  #asked = 0;
  #key = '';          // of the shown list
  #element = make('div', {id: 'world'});
  #list = make('ul', {id: 'things', 'aria-label': t('What stands in the world')});
  #form = make('form', {id: 'thing', hidden: true});
  #undo = make('button', {type: 'button', title: t('Undo the last edit (Ctrl+Z)')}, icon('undo'), t('Undo'));
  #redo = make('button', {type: 'button', title: t('Redo the undone edit (Ctrl+Y)')}, icon('redo'), t('Redo'));
  #count = make('span', {class: 'quiet'});
  #robotType = make('select', {'aria-label': t('Type of robot')});
  #targetColor = make('select', {'aria-label': t('Colour of the target')}, ...COLORS.map((name) => make('option', {}, name)));
  #search = make('input', {type: 'search', placeholder: t('find'), 'aria-label': t('Find by name')});

  constructor(connection, view) {
    this.#connection = connection;
    this.#view = view;
    const save = make('button', {type: 'button', title: t('Save the current world as a scenario file')}, icon('save'), t('Save as file'));
    save.addEventListener('click', () => this.#save());
    this.#undo.addEventListener('click', () => this.#edit('undo'));
    this.#redo.addEventListener('click', () => this.#edit('redo'));
    this.#search.addEventListener('input', () => { this.#key = ''; this.#showList(); });
    this.#element.append(make('div', {class: 'row', id: 'palette', role: 'group', 'aria-label': t('Insert: click, or drag onto the floor')}, ...this.#palette()),
      make('div', {class: 'row'}, this.#undo, this.#redo, save, this.#search, this.#count), this.#list, this.#form);
    tab('world', t('World')).append(this.#element);
    this.#fillTypes();
    view.addEventListener?.('scene', () => this.#refresh());
    view.addEventListener?.('select', ({detail}) => this.select(detail?.name ?? '', true));
    connection.addEventListener('open', () => { this.#key = ''; this.#refresh(); });
    this.#listen();
    this.#refresh();
  }

  /** Shows the form of a thing. */
  select(name, fromView = false) {
    const anew = name !== this.#name;  // otherwise the user may be typing
    this.#name = name;
    if (name && anew && !(isShown('robots') && this.#isRobot(name)) && (!fromView || isShown('robots'))) showTab('world');
    if (!fromView) this.#view.select?.(name || null);
    this.#showList();
    this.#showForm(anew);
  }

  #palette() {
    const entry = (kind, text, title, choice) => {
      const button = make('button', {type: 'button', draggable: true, title: t('{thing}: click, or drag it onto the floor', {thing: title})}, icon(kind), text);
      button.dataset.kind = kind;
      button.addEventListener('click', () => this.insertNear(kind, choice?.value));
      button.addEventListener('dragstart', (event) => {
        startDrag(event, kind, choice?.value);
      });
      return choice ? make('span', {class: 'with-choice'}, button, choice) : button;
    };
    return [entry('box', t('Box'), t('A box')), entry('cylinder', t('Cylinder'), t('A cylinder')), entry('sphere', t('Ball'), t('A ball')),
      entry('wall', t('Wall'), t('A wall')), entry('light', t('Lamp'), t('A lamp')), entry('robot', t('Robot'), t('A robot'), this.#robotType),
      entry('target', t('Target'), t('A target'), this.#targetColor)];
  }

  async #fillTypes() {
    let names = ['coopbot'];
    this.#robotType.replaceChildren(make('option', {}, names[0]));
    try {
      names = await (await fetch('api/robots')).json();
    } catch { /* keep the default */ }
    this.#robotType.replaceChildren(...names.map((name) => make('option', {selected: name === 'coopbot'}, name)));
  }

  // --- edits
  async #edit(line, text) {
    const request = text === undefined ? {module: MODULE, line} : {module: MODULE, command: line, text};
    const reply = await this.#connection.call(request);
    if (reply.error !== 0) say(reply.text, true);
    else {
      say(`${line.split(' ')[0].replace('_', ' ')}: ${reply.text}`);
      this.#view.load?.();
    }
    this.#refresh();
    return reply;
  }

  async #insert(kind, x, y, choice) {
    const reply = await this.#edit('insert', sectionsFor(kind, x, y, choice));
    if (reply.error === 0) this.select(reply.text.split(/\s/)[0]);
    return reply.error === 0;
  }

  /** Inserts a thing at the middle of the view, or at the nearest free place. */
  async insertNear(kind, choice) {
    const box = this.#view.canvas?.getBoundingClientRect();
    const middle = box && this.#view.floorAt(box.left + box.width / 2, box.top + box.height / 2);
    const {x, y} = middle ?? {x: 0, y: 0};
    const places = Array.from({length: 24}, (_, ring) => {
      const angle = 2.4 * ring, away = 0.35 * Math.sqrt(ring);
      const at = [x + away * Math.cos(angle), y + away * Math.sin(angle)];
      return {at, taken: Boolean(this.#view.scene?.isTaken(...at, ROOM_M))};
    });
    // Try places that look free first; the daemon decides.
    for (const {at} of places.sort((a, b) => a.taken - b.taken)) {
      const reply = await this.#connection.call({module: MODULE, command: 'insert', text: sectionsFor(kind, ...at, choice)});
      if (reply.error === 5 && /would stand/.test(reply.text)) continue;
      if (reply.error !== 0) return say(reply.text, true);
      say(`insert: ${reply.text}`);
      this.#view.load?.();
      this.#refresh();
      return this.select(reply.text.split(/\s/)[0]);
    }
    say(t('There is no free place in the middle of the view: look elsewhere, or drag it to a free place'), true);
  }

  /** Inserts a thing under a point of the window, or in the middle of the view if there is no floor. */
  async insertAt(kind, choice, clientX, clientY) {
    const at = this.#view.floorAt?.(clientX, clientY);
    // Not :hover, which does not change during a drag.
    if (!at || !this.#isOnFloor(at) || document.elementFromPoint(clientX, clientY) !== this.#view.canvas) return this.insertNear(kind, choice);
    return this.#insert(kind, at.x, at.y, choice);
  }

  /** Shows where a dragged thing would stand. */
  setShadow(shadow) { this.#shadow = shadow; }

  #isOnFloor({x, y}) {
    const [length, width] = this.#view.scene?.description.floor.size ?? [Infinity, Infinity];
    return Math.abs(x) <= length / 2 && Math.abs(y) <= width / 2;
  }

  /** Moves a thing, as the handles in the view do. */
  async move(name, position, yaw_rad) {
    const z = this.#find(name)?.position[2] ?? 0;
    return this.#edit(`set_pose ${name} ${short(position[0])} ${short(position[1])} ${short(position[2] ?? z)}${yaw_rad === undefined ? '' : ` ${short(yaw_rad)}`}`);
  }

  async #save() {
    const reply = await this.#connection.call({module: MODULE, command: 'save'});
    if (reply.error !== 0) return say(reply.text, true);
    saveFile(`${this.#world?.scenario ?? 'world'}.scenario`, new Blob([reply.text], {type: 'text/plain'}));
  }

  async #duplicate(thing) {
    const radius = Math.max(0.3, ...(thing.size ?? [0.5]));
    const [x, y] = [thing.position[0], thing.position[1] + 1.05 * radius];
    if (thing.type && thing.size) {
      const size = thing.type === 'sphere' ? thing.size[0] : thing.size.join(' ');
      const mass = thing.mass > 0 ? `\nmass ${thing.mass}` : '';
      const stem = thing.name.replace(/_?\d+$/, '') || 'THING';
      const reply = await this.#edit('insert', `[${stem}_*]\ntype ${thing.type}\nsize ${size}\nposition ${short(x)} ${short(y)} ${short(thing.position[2])}\n`
        + `quaternion ${thing.quaternion.join(' ')}${mass}\ncolor ${thing.color.join(' ')}\nfriction ${thing.friction}\n`
        + `bounce ${thing.bounce}\nrolling_friction ${thing.rolling_friction}`);
      if (reply.error === 0) this.select(reply.text.split(/\s/)[0]);
    } else if (thing.type) {
      this.#insert('robot', x, y + 0.3, thing.type);
    } else if (thing.color_name) {
      this.#insert('target', x, y, thing.color_name);
    } else {
      this.#insert('light', x, y);
    }
  }

  // --- list and form
  async #refresh() {
    const turn = ++this.#asked;
    const reply = await this.#connection.call({module: MODULE, command: 'list'});
    if (turn !== this.#asked || reply.error !== 0) return;
    this.#world = JSON.parse(reply.text);
    const {undo, redo, things, robots, targets, lights} = this.#world;
    this.#undo.disabled = undo === 0;
    this.#redo.disabled = redo === 0;
    setText(this.#count, String(things.length + robots.length + targets.length + lights.length));
    if (this.#name && !this.#find(this.#name)) this.#name = '';
    this.#showList();
    this.#showForm(false);
  }

  #all() {
    const {things = [], robots = [], targets = [], lights = []} = this.#world ?? {};
    return [...robots, ...things, ...targets, ...lights];
  }

  #isRobot(name) { return Boolean(this.#world?.robots.some((robot) => robot.name === name)); }

  #find(name) { return this.#all().find((thing) => thing.name === name); }

  #showList() {
    const wanted = this.#search.value.trim().toLowerCase();
    const shown = this.#all().filter(({name}) => name.toLowerCase().includes(wanted));
    const key = JSON.stringify([shown.map(({name, color}) => [name, color]), this.#name]);
    if (key === this.#key) return;
    this.#key = key;
    this.#list.replaceChildren(...shown.map((thing) => {
      const swatch = make('span', {class: 'swatch'});
      swatch.style.background = hex(shownColor(thing.color));
      const button = make('button', {type: 'button', 'aria-pressed': String(thing.name === this.#name)}, swatch, thing.name);
      button.addEventListener('click', () => this.select(thing.name === this.#name ? '' : thing.name));
      return make('li', {}, button);
    }));
    this.#list.querySelector('[aria-pressed="true"]')?.scrollIntoView({block: 'nearest'});
  }

  #showForm(anew) {
    const thing = this.#find(this.#name);
    this.#form.hidden = !thing;
    if (!thing || (!anew && this.#form.contains(document.activeElement))) return;
    const {name} = thing;
    const quoted = (text) => text.trim();
    const field = (label, key, value, send, properties = {}) => {
      const input = make('input', {type: 'text', value, ...properties});
      input.name = key;
      const act = async () => {
        if (input.value === value) return;
        const reply = await send(quoted(input.value));
        if (reply?.error !== 0) input.value = value;
      };
      input.addEventListener('change', act);
      return make('label', {}, `${label} `, input);
    };
    const set = (key) => (value) => this.#edit(`set ${name} ${key} ${value}`);
    const place = (axis) => (value) => {
      const position = [...thing.position];
      position[axis] = Number(value);
      return this.#edit(`set_pose ${name} ${position.map(short).join(' ')}`);
    };
    const fields = [];
    if (!thing.color_name) {
      fields.push(field(t('name'), 'name', name, async (value) => {
        const reply = await this.#edit(`rename ${name} ${value}`);
        if (reply.error === 0) this.select(reply.text.split(/\s/)[0] || value);
        return reply;
      }));
    }
    ['x', 'y', 'z'].forEach((axis, i) => fields.push(field(`${axis} m`, `${axis} m`, short(thing.position[i]), place(i), {inputMode: 'decimal'})));
    if (thing.quaternion) {
      fields.push(field(t('turn °'), 'turn °', showNumber(yawOf(thing.quaternion), 1).replace('−', '-'), (value) => this.#edit(
        `set_pose ${name} ${thing.position.map(short).join(' ')} ${short(Number(value) * Math.PI / 180)}`), {inputMode: 'decimal'}));
    }
    if (thing.size) fields.push(field(t('size m'), 'size m', thing.size.map(short).join(' '), set('size')));
    if (thing.mass !== undefined) fields.push(field(t('mass kg'), 'mass kg', short(thing.mass), set('mass'), {title: t('0: it never moves')}));
    if (thing.power !== undefined) fields.push(field(t('power'), 'power', short(thing.power), set('power')));
    if (thing.controller !== undefined) fields.push(field(t('controller'), 'controller', thing.controller, set('controller'), {title: t('A loaded controller and its options, for example: diffuse speed=0.2')}));
    if (thing.color_name) {
      fields.push(field(t('color'), 'color', thing.color_name, set('color')));
    } else {
      const color = make('input', {type: 'color', value: hex(thing.color)});
      color.name = 'color';
      color.addEventListener('change', () => this.#edit(`set ${name} color ${rgbOf(color.value)}`));
      fields.push(make('label', {}, `${t('color')} `, color));
    }
    const button = (text, title, act) => {
      const made = make('button', {type: 'button', title}, text);
      made.addEventListener('click', act);
      return made;
    };
    this.#form.replaceChildren(make('strong', {}, name), make('div', {class: 'fields'}, ...fields), make('div', {class: 'row'},
      button(t('Duplicate'), t('Add a copy beside it (Ctrl+D)'), () => this.#duplicate(thing)),
      button(t('Remove'), t('Remove it from the world (Delete)'), () => this.#edit(`remove ${name}`))));
  }

  // --- mouse and keys
  #listen() {
    this.#form.addEventListener('submit', (event) => { event.preventDefault(); document.activeElement?.blur(); });
    const frame = byId('view-frame');
    frame.addEventListener('dragover', (event) => {
      if (!event.dataTransfer.types.includes(DRAGGED)) return;
      event.preventDefault();
      event.dataTransfer.dropEffect = 'copy';
      const at = this.#view.floorAt?.(event.clientX, event.clientY);
      if (dragged && at) this.#shadow?.show(SIZES[dragged.kind], snapped(at.x), snapped(at.y), this.#isOnFloor(at));
    });
    for (const end of ['dragleave', 'drop']) frame.addEventListener(end, () => this.#shadow?.hide());
    frame.addEventListener('drop', (event) => {
      const data = event.dataTransfer.getData(DRAGGED);
      if (!data) return;
      event.preventDefault();
      const at = this.#view.floorAt?.(event.clientX, event.clientY);
      if (!at || !this.#isOnFloor(at)) return say(t('There is no floor: drop it where the floor is'), true);
      const {kind, choice} = JSON.parse(data);
      this.#insert(kind, at.x, at.y, choice);
    });
    document.addEventListener('keydown', (event) => {
      if (event.target.closest('input, select, textarea, [contenteditable="true"]')) return;
      const key = event.key.toLowerCase(), ctrl = event.ctrlKey || event.metaKey;
      const thing = this.#find(this.#name);
      if (ctrl && key === 'z' && !event.shiftKey) this.#edit('undo');
      else if (ctrl && (key === 'y' || (key === 'z' && event.shiftKey))) this.#edit('redo');
      else if (ctrl && key === 'd' && thing) this.#duplicate(thing);
      else if ((key === 'delete' || key === 'backspace') && thing && !ctrl) this.#edit(`remove ${thing.name}`);
      else return;
      event.preventDefault();
    });
  }
}
