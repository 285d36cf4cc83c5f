// SPDX-License-Identifier: MIT
// The bar below the view during a playback: a time slider with events, notes and keyframes as marks; speed, loop and step
// controls; and the way back to a live run.
import {byId, make, say, setText, showNumber} from './dom.js';
import {t} from './words.js';

const SPEEDS = [-4, -2, -1, -0.5, 0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];
const MAX_MARKS = 400;

export class Timeline {
  #connection;
  #status = null;     // of the playback
  #file = '';
  #wanted = null;     // the time requested by scrubbing
  #seeking = false;
  #element = make('section', {id: 'timeline', hidden: true, 'aria-label': t('Playback')});
  #track = make('input', {type: 'range', id: 'timeline-track', min: 0, max: 1, step: 'any', value: 0, 'aria-label': t('Time of the recording')});
  #marks = make('div', {id: 'timeline-marks'});
  #time = make('span', {id: 'timeline-time', class: 'number'});
  #speed = make('select', {id: 'timeline-speed', 'aria-label': t('Speed of the playback'), title: t('Below 0 it goes backwards')});
  #play = make('button', {type: 'button', id: 'timeline-play'});
  #loop = make('button', {type: 'button', id: 'timeline-loop', title: t('Restart at the end'), 'aria-pressed': 'false'}, `⟳ ${t('loop')}`);
  #back = make('button', {type: 'button', id: 'timeline-close', title: t('End the playback; the live run continues where it was left')}, t('Back to the live run'));

  constructor(connection) {
    this.#connection = connection;
    const button = (id, text, title, act) => {
      const made = make('button', {type: 'button', id, title, 'aria-label': title}, text);
      made.addEventListener('click', act);
      return made;
    };
    const order = (line) => this.#order(line);
    this.#play.addEventListener('click', () => order(this.#status?.playing ? 'pause' : 'play'));
    this.#loop.addEventListener('click', () => order(`set_loop ${this.#status?.loop ? 'off' : 'on'}`));
    this.#back.addEventListener('click', () => order('close'));
    this.#speed.append(...SPEEDS.map((speed) => make('option', {value: speed}, `× ${showNumber(speed, Math.abs(speed) < 1 ? 2 : 0)}`)));
    this.#speed.addEventListener('change', () => order(`set_speed ${this.#speed.value}`));
    this.#track.addEventListener('input', () => this.seek(Number(this.#track.value)));
    this.#element.append(
      make('div', {class: 'timeline-row'},
        button('timeline-first', '|◂', t('To the beginning'), () => this.seek(this.#status.begin_s)),
        button('timeline-step-back', '◂', t('One recorded step back'), () => order('step -1')),
        this.#play,
        button('timeline-step', '▸', t('One recorded step forward'), () => order('step 1')),
        button('timeline-last', '▸|', t('To the end'), () => this.seek(this.#status.end_s)),
        this.#loop, this.#speed, this.#time,
        button('timeline-branch', t('Go live from here'), t('End the playback: the simulation goes on from what is shown'), () => this.#branch()),
        this.#back),
      make('div', {class: 'timeline-bar'}, this.#marks, this.#track));
    byId('view-frame').after(this.#element);
    connection.addEventListener('open', () => { this.#file = ''; });
  }

  /** The playback of a status; null in a live run. */
  update(playback) {
    this.#status = playback;
    this.#element.hidden = !playback;
    if (!playback) {
      this.#file = '';
      return;
    }
    setText(this.#play, playback.playing ? '❚❚' : '▶');
    this.#play.title = playback.playing ? t('Pause') : t('Play');
    this.#play.setAttribute('aria-label', this.#play.title);
    this.#loop.setAttribute('aria-pressed', String(playback.loop));
    if (document.activeElement !== this.#speed) this.#showSpeed(playback.speed);
    Object.assign(this.#track, {min: playback.begin_s, max: playback.end_s});
    if (this.#wanted === null && !this.#seeking) this.#track.value = playback.time_s;
    setText(this.#time, `${showNumber(playback.time_s, 2)} / ${showNumber(playback.end_s, 2)} s, ${t('step {step}', {step: playback.step})}`);
    if (playback.file !== this.#file) this.#load(playback.file);
  }

  /** Seeks to this time; while a request is pending, only the newest time is kept. */
  async seek(time_s) {
    this.#wanted = time_s;
    this.#track.value = time_s;
    if (this.#seeking) return;
    this.#seeking = true;
    while (this.#wanted !== null) {
      const now = this.#wanted;
      this.#wanted = null;
      const reply = await this.#connection.call({module: '/playback', command: 'seek', data: [now], channel: 'seek'});
      if (reply.error !== 0) say(reply.text, true);
    }
    this.#seeking = false;
  }

  /** Marks the time where two runs part. */
  showParting(time_s, text) { this.#addMark({time_s, level: 'parting', text}); }

  hideParting() {
    for (const mark of this.#marks.querySelectorAll('.parting')) mark.remove();
  }

  #showSpeed(speed) {
    if (![...this.#speed.options].some((option) => Number(option.value) === speed)) {
      this.#speed.append(make('option', {value: speed}, `× ${showNumber(speed, 2)}`));
    }
    this.#speed.value = String(speed);
  }

  async #order(line) {
    const reply = await this.#connection.call({module: '/playback', line});
    if (reply.error !== 0) say(reply.text, true);
  }

  async #branch() {
    say(t('going live: the steps since the last keyframe are repeated …'));
    const reply = await this.#connection.call({module: '/playback', command: 'branch'});
    say(reply.error === 0 ? t('the run is live') : reply.text, reply.error !== 0);
  }

  async #load(file) {
    this.#file = file;
    this.#marks.replaceChildren();
    try {
      const answer = await fetch('api/playback/timeline');
      if (!answer.ok || this.#file !== file) return;  // replaced or damaged: show no marks
      const {keyframes, events} = await answer.json();
      const few = (list) => list.filter((_, i) => i % Math.ceil(list.length / MAX_MARKS) === 0);
      for (const time_s of few(keyframes)) this.#addMark({time_s, level: 'keyframe', text: t('keyframe')});
      for (const event of few(events)) this.#addMark(event);
    } catch { /* the banner shows that the daemon is gone */ }
  }

  #addMark({time_s, level, text}) {
    const {begin_s: begin, end_s: end} = this.#status;
    if (!(end > begin)) return;
    const mark = make('button', {type: 'button', class: `mark ${level}`, tabIndex: level === 'keyframe' ? -1 : 0, title: `${showNumber(time_s, 2)} s: ${text}`,
      'aria-label': `${showNumber(time_s, 2)} s: ${text}`});
    mark.style.left = `${100 * Math.min(1, Math.max(0, (time_s - begin) / (end - begin)))}%`;
    mark.addEventListener('click', () => this.seek(time_s));
    this.#marks.append(mark);
  }
}
