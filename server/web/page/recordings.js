// SPDX-License-Identifier: MIT
// Recordings: the button that makes them, and the list of the daemon's recordings to play and download.
import {byId, make, say, setOff, setText, showNumber} from './dom.js';
import {tab} from './layout.js';
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
    setText(byId('record'), this.#recording ? 'Stop recording' : 'Record');
    setOff('record', status.playback ? 'A recording is being played: there is no run to record' : '', 'Record the run to a file of the daemon');
  }

  async #toggle() {
    const command = this.#recording ? 'stop' : 'start';
    const reply = await this.#connection.call({module: '/recorder', command});
    if (reply.error !== 0) return say(`${command}: ${reply.text}`, true);
    const [name] = reply.text.split(' ');
    say(command === 'start' ? `recording to ${name}` : `recorded ${name}`);
  }
}

const link = (name) => make('a', {href: `runs/${encodeURIComponent(name)}`, download: ''}, name.slice(name.lastIndexOf('.')));

const whyNot = (recording, seconds) => (recording ? 'being recorded'
  : seconds !== null ? 'its name does not fit in a link' : 'cannot be read');

/** The list of recordings: to play, to download, and to show as a ghost over the played one. */
export class Runs {
  #connection;
  #timeline;
  #ghost = null;
  #recording;  // of the last status
  #played = '';  // name of the played recording
  #asked = 0;
  #names = [];
  #tries = 0;  // remaining, to find the new recording, whose file is created a moment later
  #note = make('input', {id: 'note', type: 'text', 'aria-label': 'Note', title: 'A note marks this moment in the recording', maxLength: 200});
  #noting = make('form', {class: 'row', hidden: true}, this.#note, make('button', {}, 'Note'));
  #parting = make('p', {id: 'parting', role: 'status', hidden: true});

  constructor(connection, timeline) {
    this.#connection = connection;
    this.#timeline = timeline;
    const panel = tab('runs', 'Runs');
    panel.append(make('h2', {id: 'runs-title'}, 'Recordings'), this.#noting, this.#parting, make('ul', {id: 'runs-list'}));
    panel.addEventListener('shown', () => this.#refresh());
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
    setText(this.#parting, parting.equal ? `${one} and ${other}: ${parting.text.trim()}` : parting.text.trim());
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
    return make('li', {}, make('span', {class: 'run-name'}, name), make('span', {class: 'number'}, length),
      make('span', {class: 'run-does'}, ...does));
  }

  async #refresh() {
    const asked = ++this.#asked;
    let runs;
    try {
      runs = await (await ask('runs')).json();
    } catch { return; /* the banner shows that the daemon is gone */ }
    if (asked !== this.#asked) return;
    this.#names = runs.map(({name}) => name);
    setText(byId('runs-title'), runs.length > 0 ? `Recordings (${runs.length})` : 'Recordings');
    const rows = runs.length > 0 ? runs.map((run) => this.#row(run))
      : [make('li', {class: 'quiet'}, 'none yet: Record, above the view, makes one')];
    byId('runs-list').replaceChildren(...rows);
  }
}
