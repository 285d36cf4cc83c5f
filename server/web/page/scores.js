// SPDX-License-Identifier: MIT
// The run's scores and the newest logged numbers; under Run, live and in a playback.
import {byId, make, setText, showNumber} from './dom.js';
import {t} from './words.js';

/** The daemon's "m2" as people write it. */
export const unitText = (unit) => (unit === 'm2' ? 'm²' : unit);

/** A number of any size: whole ones unchanged, others with three decimals or, if those say little, four digits. */
export function anyNumber(value) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return showNumber(value, 0);
  const size = Math.abs(value);
  if (size >= 1e7 || (size > 0 && size < 0.01)) return value.toPrecision(4).replace('-', '−');
  return showNumber(value, Number.isInteger(value) ? 0 : 3);
}

/** Measured values have a fixed number of decimals, so that nothing moves; counts have none. */
const scoreText = ({value, unit}) => (unit ? `${showNumber(value, 3)} ${unitText(unit)}` : anyNumber(value));

/** "until >= 3 · limit 60 s"; empty if the score does not end the run. */
const endText = ({until, limit_s: limit}) =>
  [until && t('until {condition}', {condition: until}), limit && t('limit {limit} s', {limit})].filter(Boolean).join(' · ');

export class Scores {
  #box = byId('scores-box');
  #rows = byId('scores');
  #key = '';

  update({scores = [], logged = []}) {
    this.#box.hidden = scores.length + logged.length === 0;
    if (this.#box.hidden) return;
    const key = JSON.stringify([scores, logged].map((list) => list.map(({name}) => name)));
    if (key !== this.#key) {
      this.#key = key;
      setText(byId('scores-title'), [scores.length > 0 && t('Scores'), logged.length > 0 && t('Logged numbers')].filter(Boolean).join(' · '));
      this.#rows.replaceChildren(...[...scores, ...logged].map(({name}) =>
        make('tr', {}, make('th', {scope: 'row'}, name), make('td', {class: 'number'}), make('td', {class: 'quiet'}))));
    }
    scores.forEach((score, i) => {
      this.#show(i, scoreText(score), score.met ? t('✓ met') : endText(score));
      this.#rows.rows[i].classList.toggle('met', score.met === true);
      this.#rows.rows[i].title = endText(score);
    });
    logged.forEach(({value, time_s: time}, i) =>
      this.#show(scores.length + i, anyNumber(value), t('at {time} s', {time: showNumber(time, 2)})));
  }

  #show(row, value, note) {
    const [, number, said] = this.#rows.rows[row].cells;
    setText(number, value);
    setText(said, note);
  }
}
