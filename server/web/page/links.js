// SPDX-License-Identifier: MIT
// Actions in the page's address: /?scenario=corridor&view=top&tab=plots&run=lesson1. Each runs once and is then removed from the
// address, so that a reload of the page does not repeat it.
import {say} from './dom.js';
import {showTab} from './layout.js';
import {t} from './words.js';

export class Links {
  #connection;
  #controls;
  #asked = new URLSearchParams(location.search);

  constructor(connection, controls) {
    this.#connection = connection;
    this.#controls = controls;
    if (this.#asked.has('tab')) showTab(this.#asked.get('tab'));
  }

  /** Called with the first status after this page's rights are known. */
  async follow(status) {
    const take = (name) => {
      const value = this.#asked.get(name);
      this.#asked.delete(name);
      return value;
    };
    const scenario = take('scenario'), run = take('run');
    if (scenario === null && run === null) return;
    const address = new URL(location.href);
    for (const name of ['scenario', 'run']) address.searchParams.delete(name);
    history.replaceState(null, '', address);
    if (run) {
      const reply = await this.#connection.call({module: '/playback', command: 'open', text: run});
      say(reply.error === 0 ? t('playing {name}', {name: run}) : reply.text, reply.error !== 0);
    } else if (scenario && scenario !== status.scenario) {
      await this.#controls.load({command: 'load_scenario', text: scenario});
    }
  }
}
