// SPDX-License-Identifier: MIT
// The live view from the daemon: requests pictures from the camera's pose and draws them. Left button turns, right button moves, wheel
// zooms; one finger turns, two move and zoom.
import {Camera} from './camera.js';
import {byId, setText} from './dom.js';

const MAX_WIDTH = 1280;
const COARSE = 0.6;  // fraction of the width while the camera moves
const TURN = 3.5;    // rad across the height of the picture

export class View {
  #connection;
  #canvas = byId('view');
  #context = this.#canvas.getContext('2d');
  #camera = new Camera();
  #pointers = new Map();
  #coarse = false;
  #settle = 0;
  #asked = '';
  #off = true;  // no picture yet, so the camera's pose is unknown

  constructor(connection) {
    this.#connection = connection;
    connection.addEventListener('hello', () => { this.#asked = ''; this.#ask(); });
    connection.addEventListener('picture', ({detail}) => this.#show(detail));
    new ResizeObserver(() => this.#ask()).observe(this.#canvas);
    document.addEventListener('visibilitychange', () => this.#ask());
    byId('rays').addEventListener('change', () => this.#ask());
    byId('whole').addEventListener('click', () => { this.#camera.free = true; this.#ask(); });
    this.#listen();
  }

  #ask() {
    if (document.hidden) {  // the page is not visible
      this.#asked = '';
      return this.#connection.send({type: 'view'});
    }
    const box = this.#canvas.getBoundingClientRect();
    const scale = (this.#coarse ? COARSE : 1) * Math.min(1, MAX_WIDTH / Math.max(1, box.width));
    const view = {
      type: 'view',
      width: Math.max(64, Math.round(box.width * scale)),
      height: Math.max(48, Math.min(1080, Math.round(box.height * scale))),
      rays: byId('rays').checked,
    };
    if (!this.#camera.free) {
      view.eye = this.#camera.eye;
      view.look = this.#camera.look;
    }
    const text = JSON.stringify(view);
    if (text === this.#asked || !this.#connection.isOpen) return;
    this.#asked = text;
    this.#connection.send(view);
  }

  async #show({about, jpeg}) {
    const note = byId('view-note');
    if (about.error) {
      setText(note, about.error);
      note.hidden = false;
      this.#off = true;
    } else {
      note.hidden = true;
      this.#off = false;
      try {
        const bitmap = await createImageBitmap(jpeg);
        if (this.#canvas.width !== bitmap.width || this.#canvas.height !== bitmap.height) {
          this.#canvas.width = bitmap.width;
          this.#canvas.height = bitmap.height;
        }
        this.#context.drawImage(bitmap, 0, 0);
        bitmap.close();
      } catch { /* skip an unreadable picture */ }
      this.#canvas.dataset.step = about.step;
      this.#canvas.dataset.shown = Number(this.#canvas.dataset.shown ?? 0) + 1;
      if (this.#camera.free) this.#camera.adopt(about.eye, about.look);
    }
    this.#connection.send({type: 'shown'});
  }

  /** Requests coarse pictures while the camera moves, a fine one when it rests. */
  #moved() {
    this.#coarse = true;
    this.#ask();
    clearTimeout(this.#settle);
    this.#settle = setTimeout(() => { this.#coarse = false; this.#ask(); }, 200);
  }

  #listen() {
    const canvas = this.#canvas;
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.#pointers.set(event.pointerId, {x: event.clientX, y: event.clientY, button: event.button});
      canvas.focus({preventScroll: true});
      event.preventDefault();
    });
    for (const name of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(name, (event) => this.#pointers.delete(event.pointerId));
    }
    canvas.addEventListener('pointermove', (event) => this.#drag(event));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      if (this.#off) return;
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : 1;
      this.#camera.zoom(Math.exp(0.0015 * lines * event.deltaY));
      this.#moved();
    }, {passive: false});
    canvas.addEventListener('keydown', (event) => this.#key(event));
  }

  #drag(event) {
    const pointer = this.#pointers.get(event.pointerId);
    if (!pointer || this.#off) return;
    const height = this.#canvas.clientHeight;
    const before = this.#spread();
    const dx = (event.clientX - pointer.x) / height;
    const dy = (event.clientY - pointer.y) / height;
    pointer.x = event.clientX;
    pointer.y = event.clientY;
    if (this.#pointers.size > 1) {
      const after = this.#spread();
      this.#camera.translate(-dx / 2, dy / 2);
      if (before > 0 && after > 0) this.#camera.zoom(before / after);
    } else if (pointer.button === 2 || pointer.button === 1 || event.shiftKey) {
      this.#camera.translate(-dx, dy);
    } else {
      this.#camera.rotate(-TURN * dx, TURN * dy);
    }
    this.#moved();
  }

  /** The distance between two fingers; 0 with one. */
  #spread() {
    const [a, b] = this.#pointers.values();
    return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  #key(event) {
    if (this.#off) return;
    const steps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
    if (steps && event.shiftKey) this.#camera.translate(0.05 * steps[0], 0.05 * steps[1]);
    else if (steps) this.#camera.rotate(0.1 * steps[0], 0.1 * steps[1]);
    else if (event.key === '+' || event.key === '=') this.#camera.zoom(0.9);
    else if (event.key === '-') this.#camera.zoom(1 / 0.9);
    else if (event.key === 'Home') this.#camera.free = true;
    else return;
    event.preventDefault();
    this.#moved();
  }
}
