// SPDX-License-Identifier: MIT
// The tab Speed: the time of a step by its parts, and what slows the run.
import {make, setText, showNumber} from './dom.js';
import {isShown, tab} from './layout.js';
import {waitingText} from './strip.js';
import {plural, t} from './words.js';

const PERIOD_MS = 500;
const LEAST_MS = 0.0005;  // shorter parts are not listed

/** The daemon's names for the parts of a step, in plain words: [name, explanation]. */
const PARTS = {
  physics: [t('physics'), t('motion, contacts and joints')],
  frames: [t('state'), t('publishing the new state to its readers')],
  sensors: [t('sensors'), t('readings for loaded controllers')],
  control: [t('control'), t('loaded controllers, the wait for their process included')],
  recorder: [t('recorder'), t('handing the step to the recorder, the wait for it included')],
  answers: [t('answers'), t('notifying clients and subscribers of the step')],
  rest: [t('rest'), t('everything else in a step')],
  pace: [t('spare'), t('idle time: the run keeps its pace')],
  clients: [t('clients'), t('the world waits for commands')],
};

/** The daemon's threads, in plain words. */
const THREADS = {
  render: t('pictures (render)'), web: t('viewers (page)'), recorder: t('writing the recording'), control: t('/simulation, /swarm, names'),
  physics: t('stepping'), log: t('log'),
};

/** "ana (2 robots)", "robot3's client". */
export const clientName = ({name, client, robots}) => (robots > 1 ? t('{client} ({count} robots)', {client: client ?? t('a client'), count: robots}) : t('{name}\'s client', {name}));

/** The rows of a table: {name, about, kind, ms}; `period`: last or all. Parts and clients, longest first. */
export function rowsOf(costs, period) {
  const of = (entry) => entry[`${period}_ms`];
  const clients = costs.clients.map((client) => {
    const alone = client[`alone_${period}_ms`];
    const who = client.client ? `${client.client}: ` : '';
    return {kind: 'client', name: clientName(client), ms: of(client), alone,
      about: who + t('the world waited {ms} ms per step for it, {alone} ms of that for it alone', {ms: showNumber(of(client), 2), alone: showNumber(alone, 2)})};
  });
  const parts = costs.parts.filter(({part}) => part !== 'clients' || clients.length === 0).map((entry) => {
    const [name, about] = PARTS[entry.part] ?? [entry.part, ''];
    return {kind: entry.part === 'pace' ? 'spare' : 'part', name, about, ms: of(entry)};
  });
  return [...parts, ...clients].filter(({ms}) => typeof ms === 'number' && ms >= LEAST_MS).sort((a, b) => b.ms - a.ms);
}

/** The total time of a step: the waits for clients overlap. */
export const lengthOf = (costs, period) =>
  costs.parts.reduce((sum, entry) => sum + (entry[`${period}_ms`] ?? 0), 0);

/** A sentence that says what slows the run. */
export function verdict(costs, period) {
  if (costs.playback) return t('A recording is played: nothing is computed.');
  const rows = rowsOf(costs, period), length = lengthOf(costs, period);
  if (rows.length === 0) return t('No step has run yet in this time.');
  const spare = rows.find(({kind}) => kind === 'spare')?.ms ?? 0;
  const first = rows.find(({kind}) => kind !== 'spare');
  const ms = showNumber(length, 2);
  if (spare > 0.2 * length) return t('A step takes {ms} ms, {spare} ms of it to spare: nothing in the run slows it.', {ms, spare: showNumber(spare, 2)});
  if (!first) return t('A step takes {ms} ms.', {ms});
  const part = {ms, most: showNumber(first.ms, 2), name: first.name, about: first.about};
  return first.kind === 'client' ? t('A step takes {ms} ms. {name}: the world waited {most} ms per step for it.', part)
    : t('A step takes {ms} ms. Most of it, {most} ms, is {name}: {about}.', part);
}

const SLOW = 0.8;  // of the wanted speed
const capital = (text) => text[0].toUpperCase() + text.slice(1);

/** What the strip shows, if that is why nothing, or less than wanted, happens; else empty. */
export function stateVerdict(status, spareIsLarge) {
  const {state = '', mode = '', speed = 0, rtf = 0} = status ?? {};
  if (state === 'paused') return t('The run is paused: Run lets it go on.');
  if (state === 'ended') return t('The run has ended: {reason}. Reset starts it again.', {reason: status.ended});
  const waits = status ? waitingText(status) : '';
  if (waits) return `${capital(waits)}.`;
  if (mode === 'realtime' && spareIsLarge && speed > 0 && rtf < SLOW * speed) {
    return t('The run keeps × {rtf} of × {speed}, though its steps are short: other programs of this computer use the processor.',
      {rtf: showNumber(rtf, 2), speed: showNumber(speed, 2)});
  }
  return '';
}

const number = (value, digits) => make('td', {class: 'number'}, showNumber(value, digits));

export class Costs {
  #panel = tab('cost', t('Speed'));
  #period = 'last';
  #sort = 'ms';
  #costs = null;
  #status = null;
  #timer = 0;
  #verdict = make('p', {id: 'cost-verdict', role: 'status'});
  #rows = make('tbody');
  #threads = make('tbody');
  #note = make('p', {class: 'quiet'});
  #buttons;

  constructor() {
    const button = (period, text, title) => {
      const made = make('button', {type: 'button', title, 'aria-pressed': String(period === this.#period)}, text);
      made.dataset.period = period;
      made.addEventListener('click', () => { this.#period = period; this.#show(); });
      return made;
    };
    this.#buttons = [button('last', t('last second'), t('On average over the last second')),
      button('all', t('since reset'), t('On average since the last reset or load'))];
    const head = (key, text) => {
      const sort = make('button', {type: 'button', class: 'small', title: t('Sort by {column}', {column: text})}, text);
      sort.dataset.sort = key;
      sort.addEventListener('click', () => { this.#sort = key; this.#show(); });
      return make('th', {scope: 'col'}, sort);
    };
    this.#panel.append(this.#verdict, make('div', {class: 'row'}, ...this.#buttons),
      make('table', {id: 'cost-table', class: 'costs'},
        make('thead', {}, make('tr', {}, head('name', t('part')), head('ms', t('ms per step')), make('th', {scope: 'col'}, t('share')))), this.#rows),
      this.#note, make('h2', {}, t('Beside the steps')),
      make('p', {class: 'quiet'}, t('Threads of the daemon that the world does not wait for. They slow it only if they use its core.')),
      make('table', {id: 'cost-threads', class: 'costs'}, make('thead', {}, make('tr', {}, make('th', {scope: 'col'}, t('thread')),
        make('th', {scope: 'col'}, t('ms per step')), make('th', {scope: 'col'}, t('% of a core')))), this.#threads));
    this.#panel.addEventListener('shown', () => this.#poll());
    this.#panel.addEventListener('hidden', () => clearTimeout(this.#timer));
  }

  update(status) { this.#status = status; }

  async #poll() {
    clearTimeout(this.#timer);
    if (!document.hidden) {
      try {
        const answer = await fetch('api/costs');
        if (answer.ok) this.#costs = await answer.json();
        else setText(this.#verdict, (await answer.text()).trim());
      } catch { /* the banner shows that the daemon is gone */ }
      this.#show();
    }
    clearTimeout(this.#timer);
    if (isShown('cost')) this.#timer = setTimeout(() => this.#poll(), PERIOD_MS);
  }

  #show() {
    for (const button of this.#buttons) button.setAttribute('aria-pressed', String(button.dataset.period === this.#period));
    const costs = this.#costs;
    if (!costs) return;
    const rows = rowsOf(costs, this.#period), length = lengthOf(costs, this.#period);
    const spare = rows.find(({kind}) => kind === 'spare')?.ms ?? 0;
    const stated = this.#period === 'last' && !costs.playback ? stateVerdict(this.#status, spare > 0.2 * length) : '';
    setText(this.#verdict, stated || verdict(costs, this.#period));
    if (this.#sort === 'name') rows.sort((a, b) => a.name.localeCompare(b.name, 'en', {numeric: true}));
    this.#rows.replaceChildren(...rows.map(({name, about, kind, ms}) => {
      const bar = make('span', {class: 'cost-bar'});
      bar.style.width = `${Math.min(100, 100 * ms / Math.max(length, 1e-9)).toFixed(1)}%`;
      const row = make('tr', {title: about}, make('th', {scope: 'row'}, name), number(ms, 3), make('td', {class: 'cost-share'}, bar));
      row.dataset.kind = kind;
      return row;
    }));
    const steps = this.#period === 'last' ? costs.steps_last : costs.steps;
    setText(this.#note, plural(steps ?? 0, '{count} step.', '{count} steps.')
      + (costs.clients.length > 1 ? ` ${t('Clients are waited for side by side: a step lasts as long as the slowest.')}` : ''));
    const threads = costs.threads.filter(({cores}) => cores >= 0.0005).sort((a, b) => b.cores - a.cores);
    this.#threads.replaceChildren(...threads.map(({name, count, last_ms: ms, cores}) =>
      make('tr', {}, make('th', {scope: 'row'}, (THREADS[name] ?? name) + (count > 1 ? ` × ${count}` : '')), number(ms, 3), number(100 * cores, 1))));
  }
}
