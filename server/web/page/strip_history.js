// SPDX-License-Identifier: MIT
// A small line beside the real-time factor that shows its last minute. A click opens the plots.
import {byId, make, showNumber} from './dom.js';
import {showTab} from './layout.js';
import {t} from './words.js';

const SPAN_S = 60;
const WIDTH = 90;
const HEIGHT = 22;

/** The points of an SVG line of `rates` ({time, rtf}); the newest at the right. */
export function lineOf(rates) {
  const most = Math.max(1, ...rates.map(({rtf}) => rtf)), end = rates.at(-1)?.time ?? 0;
  return rates.map(({time, rtf}) =>
    `${(WIDTH * (1 - (end - time) / SPAN_S)).toFixed(1)},${(HEIGHT - 2 - (HEIGHT - 4) * rtf / most).toFixed(1)}`).join(' ');
}

const svg = (tag, attributes) => {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
};

export class StripHistory {
  #rates = [];
  #line = svg('polyline', {fill: 'none', stroke: 'currentColor', 'stroke-width': '1.5'});
  #button = make('button', {type: 'button', id: 'rtf-history'});

  constructor() {
    const drawing = svg('svg', {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, 'aria-hidden': 'true'});
    drawing.append(this.#line);
    this.#button.append(drawing);
    this.#button.addEventListener('click', () => showTab('plots'));
    byId('rtf').after(this.#button);
  }

  update(status) {
    const time = performance.now() / 1000;
    this.#rates.push({time, rtf: Number.isFinite(status.rtf) ? status.rtf : 0});
    while (this.#rates[0].time < time - SPAN_S) this.#rates.shift();
    this.#line.setAttribute('points', lineOf(this.#rates));
    const all = this.#rates.map(({rtf}) => rtf), two = (value) => showNumber(value, value < 100 ? 2 : 0);
    const lines = [t('real-time factor of the last minute: {least} to {most}', {least: two(Math.min(...all)), most: two(Math.max(...all))}),
      t('hash of the state after step {step}: {hash}', {step: status.step, hash: status.hash}), t('Click for plots')];
    this.#button.title = lines.join('\n');
    this.#button.setAttribute('aria-label', lines.join('. '));
  }
}
