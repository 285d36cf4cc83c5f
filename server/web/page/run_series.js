// SPDX-License-Identifier: MIT
// The run's own values over simulated time, like a robot's in series.js: scores, and logged numbers, which hold until the
// next number of the same name. No drawing.
import {unitText} from './scores.js';
import {Points, readTable} from './series.js';

const MODULE = '/simulation';
const PERIOD_MS = 50;

const scoreValue = ({name, unit}) => ({key: `scores.${name}`, module: 'scores', name, unit: unitText(unit)});
const loggedValue = (name) => ({key: `logged.${name}`, module: 'logged', name, unit: '', holds: true});

/** Reads the run's table of a recording; `scores` as listed in its status. */
export function readRunTable(text, scores) {
  const known = new Map(scores.map((score) => [`score.${score.name}${score.unit && `_${score.unit.toLowerCase()}`}`, score]));
  return readTable(text, (column) => {
    if (column.startsWith('logged.')) return loggedValue(column.slice('logged.'.length));
    return known.has(column) ? scoreValue(known.get(column)) : null;
  });
}

/** Follows a live run while its plot is shown. Events: values, points. */
export class RunSeries extends EventTarget {
  #connection;
  #stopped = false;
  values = [];
  points = new Points(0);

  constructor(connection) {
    super();
    this.#connection = connection;
    this.#run();
  }

  stop() {
    this.#stopped = true;
    this.#connection.send({type: 'close', module: MODULE, channel: 'plots'});
  }

  async #run() {
    while (!this.#stopped) {
      if (this.#connection.isOpen && !document.hidden) await this.#read();
      await new Promise((resolve) => setTimeout(resolve, PERIOD_MS));
    }
  }

  async #read() {
    // Ask for one robot only: the other parts of the status suffice.
    const reply = await this.#connection.call({module: MODULE, channel: 'plots', command: 'get_status', params: [1, 1]});
    if (this.#stopped || reply.error !== 0) return;
    const {scores, logged, time_s: time} = JSON.parse(reply.text);
    this.#use([...scores.map(scoreValue), ...logged.map(({name}) => loggedValue(name))]);
    if (this.points.add(time, [...scores, ...logged].map(({value}) => value))) this.dispatchEvent(new Event('points'));
  }

  /** Replaces the values; those that remain keep their points. */
  #use(values) {
    const keys = (list) => JSON.stringify(list.map(({key}) => key));
    if (this.values.length > 0 && keys(values) === keys(this.values)) return;
    const before = new Map(this.values.map(({key}, i) => [key, this.points.columns[i]]));
    const {times} = this.points;
    this.values = values;
    this.points = new Points(values.length);
    this.points.times = times;
    this.points.columns = values.map(({key}) => before.get(key) ?? times.map(() => null));
    this.dispatchEvent(new Event('values'));
  }
}
