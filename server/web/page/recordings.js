// SPDX-License-Identifier: MIT
// Recordings: the button that makes them, and the list of those that the daemon keeps, to copy from it.
import {byId, make, say, setOff, setText, showNumber} from './dom.js';
import {tab} from './layout.js';

/** The button that begins and ends a recording, and the mark in the strip while one is made. */
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
    setOff('record', status.playback ? 'A recording is being played, there is no run to record' : '', 'Record the run to a file of the daemon');
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
  : seconds !== null ? 'its name cannot stand in a link' : 'cannot be read');

/** `lesson1.run 12.5 s .run .mat`, or why it cannot be copied. `url` is null for what cannot. */
function row({name, seconds, recording, url}) {
  const length = seconds === null ? '' : `${showNumber(seconds, 1)} s`;
  const copies = url === null ? [make('span', {class: 'quiet'}, whyNot(recording, seconds))]
    : [link(name), ' ', link(name.replace(/\.run$/, '.mat'))];
  return make('li', {}, make('span', {class: 'run-name'}, name), make('span', {class: 'number'}, length),
    make('span', {}, ...copies));
}

/** The list of the recordings. */
export class Runs {
  #recording;  // when the list was last asked for
  #asked = 0;
  #names = [];
  #tries = 0;  // left, to find the recording that has begun: its file is made a moment later

  constructor() {
    const panel = tab('runs', 'Runs');
    panel.append(make('h2', {id: 'runs-title'}, 'Recordings'),
      make('p', {class: 'quiet'}, 'Record keeps a run in a file of the daemon. Copy it as it is, or as .mat for MATLAB and Octave.'),
      make('ul', {id: 'runs-list'}));
    panel.addEventListener('shown', () => this.#refresh());
  }

  /** A recording that has begun or ended changes the list. */
  update(status) {
    const changed = status.recording !== this.#recording;
    if (changed) this.#tries = 10;
    const awaited = status.recording && !this.#names.includes(status.recording) && this.#tries-- > 0;
    this.#recording = status.recording;
    if (changed || awaited) this.#refresh();
  }

  async #refresh() {
    const asked = ++this.#asked;
    let runs;
    try {
      runs = await (await fetch('runs')).json();
    } catch { return; /* the daemon is gone: the banner says so */ }
    if (asked !== this.#asked) return;
    this.#names = runs.map(({name}) => name);
    setText(byId('runs-title'), runs.length > 0 ? `Recordings (${runs.length})` : 'Recordings');
    const rows = runs.length > 0 ? runs.map(row) : [make('li', {class: 'quiet'}, 'none yet')];
    byId('runs-list').replaceChildren(...rows);
  }
}
