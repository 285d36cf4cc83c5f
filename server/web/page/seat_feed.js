// SPDX-License-Identifier: MIT
// The world of a seat for the wall: its scene, and poses at a low rate while somebody wants them. Never starts a seat that sleeps.
import {socketAddress} from './connection.js';
import {PoseReader} from './poses.js';
import {TopScene} from './top_view.js';

const RATE_HZ = 8;
const RETRY_MS = 1500, LONGEST_RETRY_MS = 15000;  // longer than the host takes to say that a seat was put aside

/** Events: scene, poses. */
export class SeatFeed extends EventTarget {
  #base;
  #socket = null;
  #wanted = false;
  #reader = new PoseReader();
  #loading = false;
  #retry = 0;
  #pause = RETRY_MS;
  scene = null;      // a TopScene, null before the first
  received = 0;      // bytes of poses

  /** `base`: of the seat's addresses, "s/ana/". */
  constructor(base) {
    super();
    this.#base = base;
  }

  /** `on`: the seat runs, and its tile is seen. */
  want(on) {
    if (on === this.#wanted) return;
    this.#wanted = on;
    clearTimeout(this.#retry);
    if (on) this.#open();
    else this.#socket?.close();
  }

  #open() {
    if (!this.#wanted || this.#socket) return;
    const socket = new WebSocket(socketAddress(`${this.#base}ws?wake=no&only=poses`));
    this.#socket = socket;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => socket.send(JSON.stringify({type: 'poses', rate: RATE_HZ}));
    socket.onmessage = ({data}) => {
      this.#pause = RETRY_MS;
      if (typeof data !== 'string') this.#take(data);
    };
    socket.onclose = () => {
      this.#socket = null;
      this.#reader = new PoseReader();  // a new daemon counts its scenes from the beginning
      this.#retry = setTimeout(() => this.#open(), this.#pause);
      this.#pause = Math.min(2 * this.#pause, LONGEST_RETRY_MS);
      if (this.scene) this.scene.number = 0;
    };
  }

  #take(buffer) {
    this.received += buffer.byteLength;
    if (!this.#reader.take(buffer)) return;
    if (this.scene?.number !== this.#reader.scene) return this.#load();
    this.#reader.write(this.scene.bodies);
    this.scene.time_s = this.#reader.time;
    this.dispatchEvent(new Event('poses'));
  }

  async #load() {
    if (this.#loading) return;
    this.#loading = true;
    try {
      const description = await (await fetch(`${this.#base}api/scene?wake=no`)).json();
      this.scene = new TopScene(description);
      if (this.#reader.scene === description.scene) this.#reader.write(this.scene.bodies);
      this.scene.time_s = this.#reader.time;
      this.dispatchEvent(new Event('scene'));
    } catch { /* the next poses ask again */ }
    this.#loading = false;
  }
}
