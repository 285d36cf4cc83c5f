// SPDX-License-Identifier: MIT
// Sensors that numbers show poorly: a lidar's scan from above, a camera's picture.
import {make, setText, showNumber} from './dom.js';
import {t} from './words.js';

const PLOT_PX = 220;
const VIEWS = [[t('picture'), ''], [t('depth'), 'depth'], [t('segments'), 'segmentation']];

/** The most level row of a lidar, seen from above: the lidar in the middle, its front up. */
export class ScanPlot {
  #connection;
  #module;
  #geometry = null;
  #asked = false;
  #canvas = make('canvas', {class: 'scan', width: PLOT_PX, height: PLOT_PX});
  #note = make('figcaption');
  element;

  constructor(connection, module) {
    this.#connection = connection;
    this.#module = module;
    this.element = make('figure', {class: 'sensor'}, this.#canvas, this.#note);
    this.element.dataset.module = module;
  }

  stop() {
    this.#connection.send({type: 'close', module: this.#module, channel: 'readings'});
  }

  async show(ranges) {
    if (!this.#asked) {
      this.#asked = true;
      const reply = await this.#connection.call({module: this.#module, channel: 'readings', command: 'get_scan_geometry'});
      if (reply.error === 0) this.#geometry = reply.data;
      else this.#asked = false;
    }
    if (this.#geometry) this.#draw(ranges);
  }

  #draw(ranges) {
    const [first, increment, , maximum, rows, columns, low, step] = this.#geometry;
    const row = step > 0 ? Math.min(rows - 1, Math.max(0, Math.round(-low / step))) : 0;
    const flat = ranges.slice(row * columns, (row + 1) * columns);
    const hits = flat.filter((range) => typeof range === 'number' && range > 0);
    // The scale changes in steps, so that it does not flicker with each scan.
    const furthest = hits.length > 0 ? Math.max(...hits) : maximum;
    const reach = Math.min(maximum, 2 ** Math.ceil(Math.log2(Math.max(furthest, 0.1))));
    const draw = this.#canvas.getContext('2d');
    const style = getComputedStyle(this.#canvas);
    const middle = PLOT_PX / 2;
    const scale = (middle - 4) / reach;
    draw.clearRect(0, 0, PLOT_PX, PLOT_PX);
    draw.strokeStyle = style.borderColor;
    for (const part of [0.5, 1]) {
      draw.beginPath();
      draw.arc(middle, middle, part * reach * scale, 0, 2 * Math.PI);
      draw.stroke();
    }
    draw.fillStyle = style.color;
    for (const [i, range] of flat.entries()) {
      if (typeof range !== 'number' || range <= 0 || range > reach) continue;
      const angle = first + i * increment;
      const x = middle - Math.sin(angle) * range * scale, y = middle - Math.cos(angle) * range * scale;
      draw.fillRect(x - 1, y - 1, 2, 2);
    }
    draw.beginPath();
    draw.moveTo(middle, middle - 7);
    draw.lineTo(middle - 4, middle + 4);
    draw.lineTo(middle + 4, middle + 4);
    draw.fill();
    const name = this.#module.slice(this.#module.lastIndexOf('/') + 1);
    const nearest = hits.length > 0 ? t('nearest {distance} m', {distance: showNumber(Math.min(...hits), 2)}) : t('nothing in range');
    setText(this.#note, `${name}: ${nearest}, ${t('rim {distance} m', {distance: showNumber(reach, 1)})}`);
  }
}

/** A camera's pictures as a stream, which runs only while shown; a note if the daemon draws none. */
export class CameraTile {
  #image;
  #url;
  element;

  constructor({draws}, robot, name) {
    if (!draws) {
      this.element = make('figure', {class: 'sensor'}, make('figcaption', {}, `${name}: ${t('no picture, because the daemon runs with --no-render')}`));
      this.element.dataset.camera = name;
      return;
    }
    this.#url = `/camera.mjpg?robot=${encodeURIComponent(robot)}&camera=${encodeURIComponent(name)}`;
    this.#image = make('img', {alt: t('what {name} sees', {name})});
    const choice = make('select', {title: t('View of the camera')},
                        ...VIEWS.map(([text, value]) => make('option', {value}, text)));
    choice.addEventListener('change', () => this.#show(choice.value));
    this.element = make('figure', {class: 'sensor'}, this.#image, make('figcaption', {}, `${name} `, choice));
    this.element.dataset.camera = name;
    this.#show('');
  }

  #show(view) {
    this.#image.src = this.#url + (view ? `&view=${view}` : '');
  }

  stop() {
    this.#image?.removeAttribute('src');  // ends the stream
  }
}
