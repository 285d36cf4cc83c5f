// SPDX-License-Identifier: MIT
// Pose messages (docs/protocol.md): reads them, keeps the last two, and interpolates between them.

const UNIT_M = 1e-4;
const UNIT_Q = 1 / (8192 * Math.SQRT2);
const LEAST = 1e-6;     // of a number's change that shows
const LATEST_MS = 400;  // a longer pause is not bridged

/** Applies pose messages to the poses of all bodies; pure. */
export class PoseReader {
  scene = 0;
  step = 0;
  time = 0;
  #units = new Float64Array(0);  // by body: x, y, z, three components, the index of the omitted one

  /** Reads a message; false if it changes a scene whose first message was missed. */
  take(buffer) {
    const view = new DataView(buffer), bytes = new Uint8Array(buffer);
    const anew = view.getUint8(1) === 1;
    const scene = view.getUint32(2, true);
    if (!anew && scene !== this.scene) return false;
    this.scene = scene;
    this.step = Number(view.getBigUint64(6, true));
    this.time = view.getFloat64(14, true);
    let at = 22;
    const varint = () => {
      let value = 0, scale = 1;
      for (;;) {
        const byte = bytes[at++];
        value += (byte & 127) * scale;
        if (byte < 128 || at >= bytes.length) return value;
        scale *= 128;
      }
    };
    const signed = () => {
      const value = varint();
      return value % 2 === 0 ? value / 2 : -(value + 1) / 2;
    };
    if (anew) this.#units = new Float64Array(0);
    for (let body = 0; at < bytes.length; ++body) {
      body += varint();
      const mask = bytes[at++];
      if (7 * (body + 1) > this.#units.length) {
        const more = new Float64Array(7 * Math.max(64, 2 * (body + 1)));
        more.set(this.#units);
        this.#units = more;
      }
      const first = 7 * body;
      if (mask & 64) this.#units[first + 6] = bytes[at++];
      for (let k = 0; k < 6; ++k) {
        if (!(mask >> k & 1)) continue;
        if ((mask & 64) && k >= 3) this.#units[first + k] = signed();
        else this.#units[first + k] += signed();
      }
    }
    return true;
  }

  /** Writes the poses: x y z and a quaternion x y z w for each body. */
  write(poses) {
    for (let at = 0; at + 7 <= poses.length; at += 7) {
      const u = this.#units;
      for (let i = 0; i < 3; ++i) poses[at + i] = (u[at + i] ?? 0) * UNIT_M;
      let sum = 0;
      const q = [0, 0, 0, 0];  // w x y z
      for (let i = 0, k = 3; i < 4; ++i) {
        if (i === (u[at + 6] ?? 0)) continue;
        q[i] = (u[at + k++] ?? 0) * UNIT_Q;
        sum += q[i] * q[i];
      }
      q[u[at + 6] ?? 0] = Math.sqrt(Math.max(0, 1 - sum));
      poses[at + 3] = q[1];
      poses[at + 4] = q[2];
      poses[at + 5] = q[3];
      poses[at + 6] = q[0];
    }
  }
}

/** Interpolates between the last two messages: the poses are late by one message period and move at the screen's rate. */
export class Interpolator {
  #from = new Float32Array(0);
  #to = new Float32Array(0);
  #at = 0;        // ms: when the newest came
  #period = 33;   // ms between messages
  #way = 0;       // the longest change of a number between the two

  reset(count) {
    this.#from = new Float32Array(7 * count);
    this.#to = new Float32Array(7 * count);
    this.#period = 0;
  }

  get newest() { return this.#to; }

  /** Takes the newest poses. False if nothing is to be moved. */
  push(reader, now) {
    const pause = now - this.#at;
    const first = this.#period === 0;
    // Start the motion to the new poses from the shown ones.
    if (!first) this.write(this.#from, now);
    reader.write(this.#to);
    if (first || pause > LATEST_MS) this.#from.set(this.#to);
    this.#period = first || pause > LATEST_MS ? 33 : 0.8 * this.#period + 0.2 * Math.min(pause, 200);
    this.#at = now;
    this.#way = first ? 1 : 0;
    for (let i = 0; i < this.#to.length; ++i) this.#way = Math.max(this.#way, Math.abs(this.#to[i] - this.#from[i]));
    return this.#way > LEAST;
  }

  /** Whether anything still moves. */
  moves(now) { return this.#way > LEAST && now < this.#at + this.#period + 50; }

  write(poses, now) {
    const share = this.#period > 0 ? Math.min(1, Math.max(0, (now - this.#at) / this.#period)) : 1;
    const a = this.#from, b = this.#to;
    for (let at = 0; at + 7 <= poses.length; at += 7) {
      const dx = b[at] - a[at], dy = b[at + 1] - a[at + 1], dz = b[at + 2] - a[at + 2];
      const jumps = dx * dx + dy * dy + dz * dz > 1;  // the body was moved: show no flight
      const s = jumps ? 1 : share;
      poses[at] = a[at] + s * dx;
      poses[at + 1] = a[at + 1] + s * dy;
      poses[at + 2] = a[at + 2] + s * dz;
      let dot = 0;
      for (let i = 3; i < 7; ++i) dot += a[at + i] * b[at + i];
      const sign = dot < 0 ? -1 : 1;
      let norm = 0;
      for (let i = 3; i < 7; ++i) {
        poses[at + i] = (1 - s) * sign * a[at + i] + s * b[at + i];
        norm += poses[at + i] * poses[at + i];
      }
      norm = Math.sqrt(norm) || 1;
      for (let i = 3; i < 7; ++i) poses[at + i] /= norm;
    }
  }
}
