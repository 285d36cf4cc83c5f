// SPDX-License-Identifier: MIT
// Pictures (PNG) and films (WebM, in real time) of the view, made by the browser.
import {byId, make, saveFile, say, setText} from './dom.js';
import {t} from './words.js';

const RATE_HZ = 30;
const BITS_PER_S = 6e6;
const TYPES = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'];
const NO_FILM = t('this browser cannot make films: use Chrome, Edge or Firefox, or coopdyn export FILE.run --out film.mp4');

const clock = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, '0')}`;

export class Film {
  #view;
  #recorder = null;
  #began = 0;
  #timer = 0;
  #sheet = null;  // the canvas that is filmed
  #picture;
  #film;
  limit_s = 120;  // a film is held in memory until it is saved

  constructor(view) {
    this.#view = view;
    this.#picture = this.#addTool('picture', t('picture'), t('Save a picture of what is seen'), () => this.#savePicture());
    this.#film = this.#addTool('film', t('film'), this.#title, () => (this.#recorder ? this.#stop() : this.#start()));
    this.#film.setAttribute('aria-pressed', 'false');
  }

  get #title() { return t('Film what is seen, at most {time}', {time: clock(this.limit_s)}); }

  #addTool(name, text, title, act) {
    const button = make('button', {type: 'button', title, id: `tool-${name}`}, text);
    button.addEventListener('click', act);
    byId('view-tools').append(button);
    return button;
  }

  /** "classroom-12.34s.png" */
  #name(ending) {
    const plain = (id) => byId(id).textContent.replace(/[^\w.-]+/g, '');
    return `${plain('scenario-name') || 'coopdyn'}-${plain('time')}.${ending}`;
  }

  /** Draws the view and its overlays as on the screen. */
  #draw(sheet) {
    const draw = sheet.getContext('2d');
    const over = byId('sensors');
    draw.drawImage(byId('view'), 0, 0, sheet.width, sheet.height);
    if (over && !over.hidden && over.width > 0) draw.drawImage(over, 0, 0, sheet.width, sheet.height);
  }

  #newSheet() {
    const {width, height} = byId('view');
    return make('canvas', {width: width - width % 2, height: height - height % 2});
  }

  async #savePicture() {
    if (this.#view.snapshot) await this.#view.snapshot();  // draws the newest state
    const sheet = this.#newSheet();
    this.#draw(sheet);
    const blob = await new Promise((resolve) => sheet.toBlob(resolve, 'image/png'));
    if (!blob) return say(t('the picture cannot be made: the view is too small'), true);
    const name = this.#name('png');
    saveFile(name, blob);
    say(t('saved {name}', {name}));
  }

  #start() {
    const type = typeof MediaRecorder === 'function' ? TYPES.find((one) => MediaRecorder.isTypeSupported(one)) : undefined;
    if (!type || !HTMLCanvasElement.prototype.captureStream) return say(NO_FILM, true);
    this.#sheet = this.#newSheet();
    this.#draw(this.#sheet);
    const stream = this.#sheet.captureStream(RATE_HZ), pieces = [], name = this.#name('webm');
    try {
      this.#recorder = new MediaRecorder(stream, {mimeType: type, videoBitsPerSecond: BITS_PER_S});
    } catch (error) {
      return say(`${NO_FILM} (${error.message})`, true);
    }
    this.#recorder.addEventListener('dataavailable', ({data}) => { if (data.size > 0) pieces.push(data); });
    this.#recorder.addEventListener('error', ({error}) => say(t('the film has stopped: {reason}', {reason: error?.message ?? t('the browser cannot continue')}), true));
    this.#recorder.addEventListener('stop', () => {
      clearInterval(this.#timer);
      for (const track of stream.getTracks()) track.stop();
      this.#recorder = this.#sheet = null;
      this.#show();
      if (pieces.length === 0) return say(t('the film is empty: let it run for a second at least'), true);
      saveFile(name, new Blob(pieces, {type: 'video/webm'}));
      say(`${t('saved {name}', {name})}, ${clock((performance.now() - this.#began) / 1000)}`);
    });
    this.#began = performance.now();
    this.#recorder.start(1000);
    this.#timer = setInterval(() => {
      this.#draw(this.#sheet);
      this.#show();
      if (performance.now() - this.#began >= 1000 * this.limit_s) this.#stop();
    }, 1000 / RATE_HZ);
    this.#show();
  }

  #stop() {
    if (this.#recorder?.state === 'recording') this.#recorder.stop();
  }

  #show() {
    const runs = this.#recorder !== null;
    this.#film.setAttribute('aria-pressed', String(runs));
    this.#film.classList.toggle('filming', runs);
    setText(this.#film, runs ? `● ${t('{time} of {limit}', {time: clock((performance.now() - this.#began) / 1000), limit: clock(this.limit_s)})}` : t('film'));
    const title = runs ? t('Stop filming and save the film') : this.#title;
    if (this.#film.title !== title) this.#film.title = title;
  }
}
