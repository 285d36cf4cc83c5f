// SPDX-License-Identifier: MIT
// The button that begins and ends a recording, and the mark in the strip while one is made.
import {byId, say, setText} from './dom.js';

const MODULE = '/recorder';

export class Record {
  #connection;
  #recording = false;

  constructor(connection) {
    this.#connection = connection;
    byId('record').addEventListener('click', () => this.#toggle());
  }

  update(status) {
    this.#recording = Boolean(status?.recording);
    setText(byId('recording'), this.#recording ? `● rec ${status.recording}` : '');
    setText(byId('record'), this.#recording ? 'Stop recording' : 'Record');
    byId('record').disabled = Boolean(status?.playback);
  }

  async #toggle() {
    const command = this.#recording ? 'stop' : 'start';
    const reply = await this.#connection.call({module: MODULE, command});
    if (reply.error !== 0) return say(`${command}: ${reply.text}`, true);
    const [name] = reply.text.split(' ');
    say(command === 'start' ? `recording to ${name}` : `recorded ${name}`);
  }
}
