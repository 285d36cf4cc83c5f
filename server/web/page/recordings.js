// SPDX-License-Identifier: MIT
// Recordings: the button that makes them, and the list of the daemon's recordings to play and download.
import {byId, confirmed, iconButton, make, say, setLabel, setOff, setText, showNumber} from './dom.js';
import {showTab, tab} from './layout.js';
import {columnOf} from './series.js';
import {ask} from './seat.js';
import {rememberedToken} from './token.js';
import {t} from './words.js';

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
    setText(byId('recording'), this.#recording ? `● ${t('rec {name}', {name: status.recording})}` : '');
    byId('recording').title = status.recording ?? '';
    setLabel('record', this.#recording ? t('Stop recording') : t('Record'));
    byId('record').setAttribute('aria-pressed', String(this.#recording));
    setOff('record', status.playback ? t('A recording is being played: there is no run to record') : '', t('Record the run to a file of the daemon'));
  }

  async #toggle() {
    const command = this.#recording ? 'stop' : 'start';
    const reply = await this.#connection.call({module: '/recorder', command});
    if (reply.error !== 0) return say(`${command}: ${reply.text}`, true);
    const name = reply.text.replace(/ http:\S+$/, '');
    if (command === 'start') return say(t('recording to {name}', {name}));
    say(t('recorded {name}', {name}), false, {text: t('Name it'), act: () => document.dispatchEvent(new CustomEvent('name-recording', {detail: name}))});
  }
}

const link = (name) => make('a', {href: `runs/${encodeURIComponent(name)}`, download: ''}, name.slice(name.lastIndexOf('.')));

const whyNot = (recording, seconds) => (recording ? t('being recorded')
  : seconds !== null ? t('its name does not fit in a link') : t('cannot be read'));

const short = (text) => (/^[-+\d.e]+$/.test(text) ? String(Number(Number(text).toPrecision(4))).replace('-', '−') : text);

/** Where two recordings part, in a sentence; `parting`: of the daemon (docs/protocol.md). */
export function partingText(parting, one, other) {
  if (parting.equal) return t('{one} and {other} are equal: {count} steps', {one, other, count: parting.steps});
  const {name, unit} = columnOf('', parting.field);
  const tail = unit && !/ /.test(parting.one) ? ` ${unit}` : '';
  const bare = (file) => file.replace(/\.run$/, '');
  return t('{one} and {other} part at step {step}, {time} s: {name} of {what} is {first} in the first and {second} in the second',
    {one: bare(one), other: bare(other), step: parting.step, time: showNumber(parting.time_s, 2), name: name.replaceAll('_', ' '), what: parting.what,
      first: short(parting.one) + tail, second: short(parting.other) + tail});
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
  #note = make('input', {id: 'note', type: 'text', 'aria-label': t('Note'), title: t('A note marks this moment in the recording'), maxLength: 200});
  #noting = make('form', {class: 'row', hidden: true}, this.#note, make('button', {}, t('Note')));
  #parting = make('p', {id: 'parting', role: 'status', hidden: true});

  constructor(connection, timeline) {
    this.#connection = connection;
    this.#timeline = timeline;
    const panel = tab('runs', t('Recordings'));
    panel.append(make('h2', {id: 'runs-title'}, t('Recordings')), this.#noting, this.#parting, make('ul', {id: 'runs-list'}, make('li', {class: 'loading'}, t('reading the list …'))));
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
    say(t('noted: {text}', {text}));
  }

  async #play(name) {
    say(t('opening {name} …', {name}));
    const reply = await this.#connection.call({module: '/playback', command: 'open', text: name});
    say(reply.error === 0 ? t('playing {name}', {name}) : reply.text, reply.error !== 0);
  }

  async #lay(name) {
    if (this.#ghost.name === name) {
      this.#clearGhost();
      return this.#refresh();
    }
    this.#hideParting();
    say(t('reading {name} …', {name}));
    const error = await this.#ghost.show(name);
    say(error || t('{name} is drawn pale over {other}', {name, other: this.#played || t('the live run')}), error !== '');
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
    if (!parting.equal) this.#timeline.showParting(parting.time_s, t('{one} and {other} part: {what}', {one, other, what: `${parting.what} ${parting.field}`}));
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
      : [button(t('Play'), t('Play {name}; the live run is put aside', {name}), name === this.#played, () => this.#play(name)), ' ',
        ...(this.#ghost ? [button(t('Ghost'), t('Draw {name} pale over the shown run', {name}), name === this.#ghost.name, () => this.#lay(name)), ' '] : []),
        link(name), ' ', link(name.replace(/\.run$/, '.mat'))];
    const still = recording || name === this.#played;
    const shown = this.#naming === name ? this.#nameField(name) : make('span', {class: 'run-name'}, name);
    return make('li', {}, shown, make('span', {class: 'number'}, length),
      make('span', {class: 'run-does'}, ...does, ...(still ? [] : [iconButton('edit', t('Rename {name}', {name}), () => this.#startNaming(name)),
        iconButton('bin', t('Delete {name}', {name}), () => this.#delete(name))])));
  }

  #startNaming(name) {
    this.#naming = name;
    this.#refresh();
  }

  /** A field with a recording's name: Enter renames, Escape leaves it. */
  #nameField(name) {
    const plain = name.replace(/\.run$/, '');
    const field = make('input', {class: 'run-name', value: plain, maxLength: 200, 'aria-label': t('New name of {name}', {name})});
    const end = async (keep) => {
      if (this.#naming !== name) return;
      this.#naming = '';
      const wanted = field.value.trim();
      field.blur();  // the list is not renewed while one writes
      if (keep && wanted && wanted !== plain) await this.#tell('rename', `${plain}/${wanted}`, t('{name} is {other} now', {name, other: `${wanted}.run`}));
      this.#refresh();
    };
    field.addEventListener('keydown', ({key}) => { if (key === 'Enter' || key === 'Escape') end(key === 'Enter'); });
    field.addEventListener('blur', () => end(true));
    queueMicrotask(() => field.select());
    return field;
  }

  async #delete(name) {
    if (!await confirmed(t('Delete the recording {name}? It cannot be brought back.', {name}), t('Delete'))) return;
    if (name === this.#ghost?.name) this.#clearGhost();
    await this.#tell('delete', name, t('{name} is deleted', {name}));
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
    setText(byId('runs-title'), runs.length > 0 ? `${t('Recordings')} (${runs.length})` : t('Recordings'));
    const rows = runs.length > 0 ? runs.map((run) => this.#row(run))
      : [make('li', {class: 'quiet'}, t('none yet: Record, above the view, makes one'))];
    byId('runs-list').replaceChildren(...rows);
  }
}
