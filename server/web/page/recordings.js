// SPDX-License-Identifier: MIT
// Recordings: the button that makes them, and the list of the daemon's recordings to play and download.
import {byId, confirmed, iconButton, make, say, setLabel, setOff, setText, showNumber} from './dom.js';
import {showTab, tab} from './layout.js';
import {columnOf} from './series.js';
import {ask} from './seat.js';
import {rememberedToken} from './token.js';

/** The button that starts and stops a recording, and the mark in the strip during one. */
export class Record {
  #connection;
  #recording = false;

  constructor(connection) {
    this.#connection = connection;
    byId('record').addEventListener('click', () => this.#toggle());
  }

  update(status) {
    this.#recording = Boolean(status.recording);
    setText(byId('recording'), this.#recording ? `● rec ${status.recording}` : '');
    byId('recording').title = status.recording ?? '';
    setLabel('record', this.#recording ? 'Stop recording' : 'Record');
    byId('record').setAttribute('aria-pressed', String(this.#recording));
    setOff('record', status.playback ? 'A recording is being played: there is no run to record' : '', 'Record the run to a file of the daemon');
  }

  async #toggle() {
    const command = this.#recording ? 'stop' : 'start';
    const reply = await this.#connection.call({module: '/recorder', command});
    if (reply.error !== 0) return say(`${command}: ${reply.text}`, true);
    const name = reply.text.replace(/ http:\S+$/, '');
    if (command === 'start') return say(`recording to ${name}`);
    say(`recorded ${name}`, false, {text: 'Name it', act: () => document.dispatchEvent(new CustomEvent('name-recording', {detail: name}))});
  }
}

const link = (name) => make('a', {href: `runs/${encodeURIComponent(name)}`, download: ''}, name.slice(name.lastIndexOf('.')));

const whyNot = (recording, seconds) => (recording ? 'being recorded'
  : seconds !== null ? 'its name does not fit in a link' : 'cannot be read');

const short = (text) => (/^[-+\d.e]+$/.test(text) ? String(Number(Number(text).toPrecision(4))).replace('-', '−') : text);

/** Where two recordings part, in a sentence; `parting`: of the daemon (docs/protocol.md). */
export function partingText(parting, one, other) {
  if (parting.equal) return `${one} and ${other} are equal: ${parting.steps} steps`;
  const {name, unit} = columnOf('', parting.field);
  const tail = unit && !/ /.test(parting.one) ? ` ${unit}` : '';
  const bare = (file) => file.replace(/\.run$/, '');
  return `${bare(one)} and ${bare(other)} part at step ${parting.step}, ${showNumber(parting.time_s, 2)} s: ${name.replaceAll('_', ' ')} of ${parting.what} is ` +
    `${short(parting.one)}${tail} in the first and ${short(parting.other)}${tail} in the second`;
}

/** The list of recordings: to play, to download, and to show as a ghost over the played one. */
export class Runs {
  #connection;
  #timeline;
  #ghost = null;
  #recording;  // of the last status
  #played = '';  // name of the played recording
  #asked = 0;
  #names = [];
  #naming = '';  // name of the recording that is being renamed
  #tries = 0;  // remaining, to find the new recording, whose file is created a moment later
  #note = make('input', {id: 'note', type: 'text', 'aria-label': 'Note', title: 'A note marks this moment in the recording', maxLength: 200});
  #noting = make('form', {class: 'row', hidden: true}, this.#note, make('button', {}, 'Note'));
  #parting = make('p', {id: 'parting', role: 'status', hidden: true});

  constructor(connection, timeline) {
    this.#connection = connection;
    this.#timeline = timeline;
    const panel = tab('runs', 'Recordings');
    panel.append(make('h2', {id: 'runs-title'}, 'Recordings'), this.#noting, this.#parting, make('ul', {id: 'runs-list'}, make('li', {class: 'loading'}, 'reading the list …')));
    panel.addEventListener('shown', () => this.#refresh());
    document.addEventListener('name-recording', ({detail: name}) => {
      showTab('runs');
      this.#startNaming(name);
    });
    this.#noting.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#writeNote();
    });
  }

  /** Enables ghosts. */
  setGhost(ghost) {
    this.#ghost = ghost;
    this.#refresh();
  }

  /** Updates the list when a recording or a playback starts or ends. */
  update(status) {
    const played = status.playback?.file.split('/').at(-1) ?? '';
    if (played !== this.#played) {
      this.#played = played;
      this.#clearGhost();
      this.#refresh();
    }
    this.#noting.hidden = !status.recording;
    const changed = status.recording !== this.#recording;
    if (changed) this.#tries = 10;
    const awaited = status.recording && !this.#names.includes(status.recording) && this.#tries-- > 0;
    this.#recording = status.recording;
    if (changed || awaited) this.#refresh();
  }

  async #writeNote() {
    const text = this.#note.value.trim();
    if (!text) return;
    const reply = await this.#connection.call({module: '/recorder', command: 'note', text});
    if (reply.error !== 0) return say(reply.text, true);
    this.#note.value = '';
    say(`noted: ${text}`);
  }

  async #play(name) {
    say(`opening ${name} …`);
    const reply = await this.#connection.call({module: '/playback', command: 'open', text: name});
    say(reply.error === 0 ? `playing ${name}` : reply.text, reply.error !== 0);
  }

  async #lay(name) {
    if (this.#ghost.name === name) {
      this.#clearGhost();
      return this.#refresh();
    }
    this.#hideParting();
    say(`reading ${name} …`);
    const error = await this.#ghost.show(name);
    say(error || `${name} is drawn pale over ${this.#played || 'the live run'}`, error !== '');
    this.#refresh();
    if (!error && this.#played && this.#played !== name) this.#findParting(this.#played, name);
  }

  #clearGhost() {
    this.#ghost?.clear();
    this.#hideParting();
  }

  #hideParting() {
    this.#timeline.hideParting();
    this.#parting.hidden = true;
  }

  async #findParting(one, other) {
    const answer = await fetch(`api/playback/parting?with=${encodeURIComponent(other)}`,
      {headers: {Authorization: `Bearer ${rememberedToken()}`}});
    if (this.#ghost.name !== other) return;
    this.#parting.hidden = false;
    if (!answer.ok) return setText(this.#parting, (await answer.text()).trim());
    const parting = await answer.json();
    setText(this.#parting, partingText(parting, one, other));
    this.#parting.title = parting.text.trim();
    if (!parting.equal) this.#timeline.showParting(parting.time_s, `${one} and ${other} part: ${parting.what} ${parting.field}`);
  }

  /** `lesson1.run 12.5 s Play Ghost .run .mat`, or why it cannot be downloaded; `url` is then null. */
  #row({name, seconds, recording, url}) {
    const length = seconds === null ? '' : `${showNumber(seconds, 1)} s`;
    const button = (text, title, pressed, act) => {
      const made = make('button', {type: 'button', class: 'small', title, 'aria-pressed': String(pressed)}, text);
      made.addEventListener('click', act);
      return made;
    };
    const does = url === null ? [make('span', {class: 'quiet'}, whyNot(recording, seconds))]
      : [button('Play', `Play ${name}; the live run is put aside`, name === this.#played, () => this.#play(name)), ' ',
        ...(this.#ghost ? [button('Ghost', `Draw ${name} pale over the shown run`, name === this.#ghost.name, () => this.#lay(name)), ' '] : []),
        link(name), ' ', link(name.replace(/\.run$/, '.mat'))];
    const still = recording || name === this.#played;
    const shown = this.#naming === name ? this.#nameField(name) : make('span', {class: 'run-name'}, name);
    return make('li', {}, shown, make('span', {class: 'number'}, length),
      make('span', {class: 'run-does'}, ...does, ...(still ? [] : [iconButton('edit', `Rename ${name}`, () => this.#startNaming(name)),
        iconButton('bin', `Delete ${name}`, () => this.#delete(name))])));
  }

  #startNaming(name) {
    this.#naming = name;
    this.#refresh();
  }

  /** A field with a recording's name: Enter renames, Escape leaves it. */
  #nameField(name) {
    const plain = name.replace(/\.run$/, '');
    const field = make('input', {class: 'run-name', value: plain, maxLength: 200, 'aria-label': `New name of ${name}`});
    const end = async (keep) => {
      if (this.#naming !== name) return;
      this.#naming = '';
      const wanted = field.value.trim();
      field.blur();  // the list is not renewed while one writes
      if (keep && wanted && wanted !== plain) await this.#tell('rename', `${plain}/${wanted}`, `${name} is ${wanted}.run now`);
      this.#refresh();
    };
    field.addEventListener('keydown', ({key}) => { if (key === 'Enter' || key === 'Escape') end(key === 'Enter'); });
    field.addEventListener('blur', () => end(true));
    queueMicrotask(() => field.select());
    return field;
  }

  async #delete(name) {
    if (!await confirmed(`Delete the recording ${name}? It cannot be brought back.`, 'Delete')) return;
    if (name === this.#ghost?.name) this.#clearGhost();
    await this.#tell('delete', name, `${name} is deleted`);
    this.#refresh();
  }

  async #tell(command, text, done) {
    const reply = await this.#connection.call({module: '/recorder', command, text});
    say(reply.error === 0 ? done : reply.text, reply.error !== 0);
  }

  async #refresh() {
    const asked = ++this.#asked;
    let runs;
    try {
      runs = await (await ask('runs')).json();
    } catch { return; /* the banner shows that the daemon is gone */ }
    if (asked !== this.#asked || byId('runs-list').contains(document.activeElement?.closest('input'))) return;
    this.#names = runs.map(({name}) => name);
    setText(byId('runs-title'), runs.length > 0 ? `Recordings (${runs.length})` : 'Recordings');
    const rows = runs.length > 0 ? runs.map((run) => this.#row(run))
      : [make('li', {class: 'quiet'}, 'none yet: Record, above the view, makes one')];
    byId('runs-list').replaceChildren(...rows);
  }
}
