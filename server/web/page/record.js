// SPDX-License-Identifier: MIT
// The button that begins and ends a recording, and the mark in the strip while one is made.
import {byId, say, setOff, setText} from './dom.js';

const MODULE = '/recorder';

export class Record {
  #connection;
  #recording = false;

  constructor(connection) {
    this.#connection = connection;
    byId('record').addEventListener('click', () => this.#toggle());
  }

  update(status) {
    this.#recording = Boolean(status.recording);
    setText(byId('recording'), this.#recording ? `● rec ${status.recording}` : '');
    byId('recording').title = status.recording ?? '';
    setText(byId('record'), this.#recording ? 'Stop recording' : 'Record');
    setOff('record', status.playback ? 'A recording is being played, there is no run to record' : '', 'Record the run to a file of the daemon');
  }

  async #toggle() {
    const command = this.#recording ? 'stop' : 'start';
    const reply = await this.#connection.call({module: MODULE, command});
    if (reply.error !== 0) return say(`${command}: ${reply.text}`, true);
    const [name] = reply.text.split(' ');
    say(command === 'start' ? `recording to ${name}` : `recorded ${name}`);
  }
}
