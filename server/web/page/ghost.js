// SPDX-License-Identifier: MIT
// A second run, drawn pale over the shown one at the same simulated time.
import {PoseReader} from './poses.js';
import {Scene3d} from './scene3d.js';

const OPACITY = 0.4;
const RATE_HZ = 30;

/** Reads a file of pose messages: the times, and the bodies at each. */
export function readMoments(buffer, bodies) {
  const view = new DataView(buffer), reader = new PoseReader(), times = [], poses = [];
  for (let at = 0; at + 4 <= buffer.byteLength;) {
    const length = view.getUint32(at, true);
    at += 4;
    if (length === 0) continue;
    reader.take(buffer.slice(at, at + length));
    at += length;
    const moment = new Float32Array(7 * bodies);
    reader.write(moment);
    times.push(reader.time);
    poses.push(moment);
  }
  return {times, poses};
}

/** The index of the newest of the increasing `times` at or before `time`; 0 if none. */
export function newestAt(times, time) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}

export class Ghost {
  #view;
  #scene = null;
  #moments = null;
  #shown = -1;
  name = '';

  constructor(view) {
    this.#view = view;
    view.addEventListener('drawn', () => this.#place());
  }

  /** Draws the recording `name`. Returns an error text, empty on success. */
  async show(name) {
    this.clear();
    this.name = name;
    const get = async (what) => {
      const answer = await fetch(`runs/${encodeURIComponent(name)}/${what}`);
      if (!answer.ok) throw new Error((await answer.text()).trim());
      return answer;
    };
    try {
      const [description, bytes] = await Promise.all([get('scene').then((answer) => answer.json()),
        get(`poses?rate=${RATE_HZ}`).then((answer) => answer.arrayBuffer())]);
      if (this.name !== name) return '';
      this.#moments = readMoments(bytes, description.bodies);
      const moving = {...description, targets: [], lights: [], things: description.things.filter(({body}) => body >= 0)};
      this.#scene = new Scene3d(moving, {makeMaterial: this.#view.materialsFor(moving), onLoaded: () => { this.#fade(); this.#shown = -1; this.#view.redraw(); }});
      this.#scene.root.userData.ghost = true;
      this.#fade();
      this.#view.add(this.#scene.root);
      this.#place();
      return '';
    } catch (error) {
      this.name = '';
      return error.message;
    }
  }

  clear() {
    this.#scene?.dispose();
    this.#scene = this.#moments = null;
    this.#shown = -1;
    this.name = '';
    this.#view.redraw();
  }

  #fade() {
    this.#scene.root.traverse((object) => {
      if (object === this.#scene.floor || object === this.#scene.contacts) object.visible = false;
      object.castShadow = object.receiveShadow = false;
      if (object.material) Object.assign(object.material, {transparent: true, opacity: OPACITY, depthWrite: false});
    });
  }

  #place() {
    if (!this.#scene || this.#moments.times.length === 0) return;
    const newest = newestAt(this.#moments.times, this.#view.time + 1e-9);
    if (newest === this.#shown) return;
    this.#shown = newest;
    this.#scene.bodies.set(this.#moments.poses[newest]);
    this.#scene.place();
    this.#view.redraw();
  }
}
