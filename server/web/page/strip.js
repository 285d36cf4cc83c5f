// SPDX-License-Identifier: MIT
// The strip at the top, legible from the back of a classroom: state, mode, time, real-time factor, awaited robots.
import {byId, make, say, setText, showNumber} from './dom.js';
import {t} from './words.js';

const SHOWN_ROBOTS = 4;
const HINT = t('Drag turns the view, the wheel zooms. A click selects, a double click follows.');
const AGAIN_MS = 10000;
const MOST_TOLD = 50;
const DEED = / by \S/;
const SHORT_WAIT_S = 0.5;  // a lockstep world awaits its robots before every step; shorter waits are not shown

const STATES = {running: t('running'), paused: t('paused'), waiting: t('waiting'), playing: t('playing'), ended: t('ended'), 'no answer': t('no answer')};

/** Why a robot is awaited, in the daemon's words. */
const whyText = (why) => (why === 'no client' ? t('no client') : why.replace(/^no command from (.*)$/, (_, client) => t('no command from {client}', {client})));

/** Seconds that the longest-awaited robot has been awaited; 0 if none. */
const longestWait = (status) => Math.max(0, ...(status.awaiting ?? []).map((entry) => entry.seconds ?? 0));

/** The state to show: a world that steps steadily counts as running, although each step briefly awaits the robots. */
export function stateText(status) {
  const advancing = status.state === 'waiting' && (status.awaiting ?? []).length > 0 && longestWait(status) < SHORT_WAIT_S;
  return advancing ? 'running' : status.state;
}

/** "waiting for robot2 (no client), 1.2 s", "waiting for robot1, robot2 and 5 more (no client), 1.2 s"; empty if no robot
 *  has been awaited for long. */
export function waitingText(status) {
  const awaiting = status.awaiting ?? [];
  const seconds = longestWait(status);
  if (seconds < SHORT_WAIT_S) return '';
  const first = awaiting.slice(0, SHOWN_ROBOTS);
  const same = first.every(({why}) => why === first[0].why);
  const names = first.map(({robot, why}) => (same ? robot : `${robot} (${whyText(why)})`)).join(', ');
  const more = (status.awaiting_count ?? awaiting.length) - first.length;
  const all = more > 0 ? t('{names} and {count} more', {names, count: more}) : names;
  return t('waiting for {robots}, {seconds} s', {robots: same ? `${all} (${whyText(first[0].why)})` : all, seconds: showNumber(seconds, 1)});
}

/** How the world can continue without a robot that has no client; empty if all awaited robots have one. */
const cureText = (status) => (status.awaiting ?? []).find(({cure}) => cure)?.cure ?? '';

/** "of lesson1.run, 0.00 to 60.00 s, × −2"; empty in a live run. */
export function playbackText(playback) {
  if (!playback) return '';
  const speed = playback.speed === 1 ? '' : `, × ${showNumber(playback.speed, 2)}`;
  const of = t('of {file}, {begin} to {end} s', {file: playback.file, begin: showNumber(playback.begin_s, 2), end: showNumber(playback.end_s, 2)});
  return `${of}${playback.growing ? ` ${t('and growing')}` : ''}${speed}${playback.loop ? `, ${t('loop')}` : ''}`;
}

export class Strip {
  #lastEvents = null;
  #told = new Map();  // when each deed was seen last, ms
  #onDeed;

  /** `onDeed`: called with what somebody has just done, "reset by ana". */
  constructor(onDeed) { this.#onDeed = onDeed; }
  #played = null;  // the file

  /** A null `status` leaves the last one, pale, under "no answer". */
  update(status) {
    const state = status ? stateText(status) : 'no answer';
    setText(byId('state'), state === 'ended' && status.ended ? t('ended: {reason}', {reason: status.ended}) : STATES[state] ?? state);
    byId('state').title = byId('state').textContent;
    byId('state').dataset.state = state;
    byId('strip').classList.toggle('stale', !status);
    if (!status) return this.#showWaiting('', '');
    setText(byId('mode'), status.mode);
    setText(byId('time'), `${showNumber(status.time_s, 2)} s`);
    setText(byId('rtf'), `× ${showNumber(status.rtf, status.rtf < 100 ? 2 : 0)}`);
    byId('rtf').title = t('real-time factor: simulated seconds per second');
    this.#showName('scenario-name', status.scenario ?? '');
    this.#showName('playback', playbackText(status.playback));
    this.#followPlayback(status.playback?.file ?? null);
    const frozen = status.frozen ?? [];
    const waiting = waitingText(status);
    const lines = [waiting, frozen.length > 0 ? t('frozen: {robots}', {robots: frozen.join(', ')}) : ''];
    this.#showWaiting(lines.filter(Boolean).join(' · '), waiting && cureText(status));
    this.#showEvents(status.events ?? []);
  }

  /** Shows a text that is cut at the end of the line; its tooltip is complete. */
  #showName(id, text) {
    setText(byId(id), text);
    byId(id).title = text;
  }

  #showWaiting(text, cure) {
    setText(byId('waiting'), text);
    byId('waiting').title = text;
    setText(byId('cure'), cure);
    byId('go-on').hidden = byId('go-realtime').hidden = cure === '';
  }

  /** When a playback ends, by anybody, replaces messages about it such as "playing a recording". */
  #followPlayback(file) {
    if (this.#played !== null && file === null) say(t('{name} is no longer played: the run is live', {name: this.#played}));
    this.#played = file;
  }

  /** Tells of a deed, but not again and again of the same. */
  #tellDeed(text, isOld) {
    const now = performance.now(), last = this.#told.get(text) ?? -Infinity;
    this.#told.set(text, now);
    if (!isOld && now - last > AGAIN_MS) this.#onDeed(text);
    if (this.#told.size > MOST_TOLD) this.#told.delete(this.#told.keys().next().value);
  }

  #tell({time_s: time, text}) { return `${showNumber(time, 2)} s: ${text}`; }

  #showEvents(events) {
    const key = JSON.stringify(events);
    if (key === this.#lastEvents) return;
    const isFirst = this.#lastEvents === null, latest = events.at(-1);
    this.#lastEvents = key;
    if (latest && DEED.test(latest.text)) this.#tellDeed(latest.text, isFirst);
    setText(byId('latest'), latest ? this.#tell(latest) : HINT);
    byId('latest').title = byId('latest').textContent;  // a narrow window cuts it
    const items = events.toReversed().map((event) =>
      make('li', {class: event.level}, this.#tell(event)));
    byId('events').replaceChildren(...(items.length > 0 ? items : [make('li', {class: 'quiet'}, t('none yet'))]));
  }
}
