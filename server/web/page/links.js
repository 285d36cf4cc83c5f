// SPDX-License-Identifier: MIT
// What an address asks for: /?scenario=corridor&view=top&tab=plots&run=lesson1. Each once: then it goes from the address, so that
// the page can be opened again without loading anew.
import {say} from './dom.js';
import {showTab} from './layout.js';

export class Links {
  #connection;
  #controls;
  #asked = new URLSearchParams(location.search);

  constructor(connection, controls) {
    this.#connection = connection;
    this.#controls = controls;
    if (this.#asked.has('tab')) showTab(this.#asked.get('tab'));
  }

  /** At the first status after the daemon has said what this page may. */
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
      say(reply.error === 0 ? `playing ${run}` : reply.text, reply.error !== 0);
    } else if (scenario && scenario !== status.scenario) {
      await this.#controls.load({command: 'load_scenario', text: scenario});
    }
  }
}
