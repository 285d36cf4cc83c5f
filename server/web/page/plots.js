// SPDX-License-Identifier: MIT
// The tab Plots: values of robots, scores and logged numbers against simulated time, of the live run or the played recording;
// a strip of the real-time factor and the state hash.
import {byId, make, saveFile, say, setText, showNumber} from './dom.js';
import {isShown, tab} from './layout.js';
import {readRunTable, RunSeries} from './run_series.js';
import {LiveSeries, readTable, robotValue} from './series.js';
import {t} from './words.js';

const TABLE_POINTS = 4000;
const HEIGHT_PX = 170;
const COLORS = ['#2f7bf0', '#e0672c', '#1c9a5b', '#b23fb5', '#c79a00', '#0fa3b1', '#d0342c', '#7a6ff0'];
const STRIP_S = 60;
const RUN = '/run';  // chosen in place of a robot; no robot has this name

const LEGENDS = {scores: t('scores'), logged: t('logged numbers'), 'set-points': t('set-points')};
/** A module, or what the page itself names. */
const legendOf = (module) => LEGENDS[module] ?? module;

/** Names, units and numbers of the curves, as CSV. */
export function csvOf(robot, values, points) {
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const head = ['time_s', ...values.map(({module, name, unit}) => quoted(`${robot}${module ? `/${module}` : ''} ${name}${unit ? ` [${unit}]` : ''}`))];
  return [head.join(','), ...points.times.map((time, i) => [time, ...points.columns.map((column) => column[i] ?? '')].join(','))].join('\n') + '\n';
}

export class Plots {
  #connection;
  #timeline;
  #status = null;
  #robot = '';
  #source = null;      // {values, points, stop?}
  #sourceKey = '';
  #chosen = new Map([['live', new Set()], ['run', new Set()]]);  // keys of values
  #plots = [];         // {unit, chart, at: which columns, zoomed, held}
  #uPlot = null;
  #due = 0;
  #rates = [];         // {time, rtf}
  #panel = tab('plots', t('Plots'));
  #robots = make('select', {id: 'plot-robot', 'aria-label': t('Robot, or the run')});
  #span = make('select', {id: 'plot-span', 'aria-label': t('Time range shown')}, make('option', {value: 10}, t('last 10 s')),
    make('option', {value: 60}, t('last 60 s')), make('option', {value: 0, selected: true}, t('all the time')));
  #values = make('div', {id: 'plot-values', role: 'group', 'aria-label': t('Values')});
  #charts = make('div', {id: 'plot-charts'});
  #note = make('p', {id: 'plot-note', class: 'quiet'});
  #strip = make('canvas', {id: 'rate-strip', width: 600, height: 40, title: t('Real-time factor of the last minute')});
  #hash = make('p', {id: 'plot-hash', class: 'quiet number'});

  constructor(connection, timeline) {
    this.#connection = connection;
    this.#timeline = timeline;
    const button = (id, text, title, act) => {
      const made = make('button', {type: 'button', id, title}, text);
      made.addEventListener('click', act);
      return made;
    };
    this.#panel.append(this.#strip, this.#hash, make('div', {class: 'row'}, this.#robots, this.#span,
      button('plot-csv', 'CSV', t('Save the chosen curves as a table'), () => this.#saveCsv()),
      button('plot-png', 'PNG', t('Save the plots as a picture'), () => this.#savePng()),
      button('plot-clear', t('Clear'), t('Remove all curves'), () => { this.#marked.clear(); this.#showValues(); this.#build(); })),
    this.#values, this.#note, this.#charts);
    this.#robots.addEventListener('change', () => { this.#robot = this.#robots.value; this.#open(); });
    this.#span.addEventListener('change', () => this.#draw());
    this.#panel.addEventListener('shown', () => { this.#open(); this.#drawStrip(); });
    this.#panel.addEventListener('hidden', () => this.#close());
    document.addEventListener('theme', () => this.#build());
    new ResizeObserver(() => this.#resize()).observe(this.#panel);
    connection.addEventListener('open', () => this.#close());
  }

  /** For tests: the points drawn. */
  get points() { return this.#source?.points; }
  get values() { return this.#source?.values ?? []; }
  get charts() { return this.#plots.map(({chart}) => chart); }

  update(status) {
    this.#status = status;
    this.#rates.push({time: performance.now() / 1000, rtf: Number.isFinite(status.rtf) ? status.rtf : 0});
    while (this.#rates[0].time < this.#rates.at(-1).time - STRIP_S) this.#rates.shift();
    if (!isShown('plots')) return;
    const names = [RUN, ...status.robots.map(({name}) => name)];
    const listed = [...this.#robots.options].map(({value}) => value);
    if (JSON.stringify(names) !== JSON.stringify(listed)) {
      this.#robots.replaceChildren(...names.map((name) => make('option', {value: name}, name === RUN ? t('the run') : name)));
      if (!names.includes(this.#robot)) this.#robot = names[1] ?? RUN;
      this.#robots.value = this.#robot;
    }
    this.#open();
    this.#drawStrip();
    if (status.playback) for (const {chart} of this.#plots) chart.redraw(false);
  }

  get #kind() { return this.#status?.playback ? 'run' : 'live'; }
  get #marked() { return this.#chosen.get(this.#kind); }

  /** The name of the choice in files and headings. */
  get #title() { return this.#robot === RUN ? 'run' : this.#robot; }

  /** Follows the chosen robot, or the run, unless already followed. */
  async #open() {
    const ofRun = this.#robot === RUN;
    const robot = ofRun ? {name: RUN, modules: []} : this.#status?.robots.find(({name}) => name === this.#robot);
    if (!robot || !this.#status || !isShown('plots')) return;
    const {playback, scenario, scores} = this.#status;
    const key = JSON.stringify([this.#kind, playback?.file, scenario, robot.name, robot.modules.map(({name}) => name)]);
    if (key === this.#sourceKey) return;
    this.#close();
    this.#sourceKey = key;
    setText(this.#note, t('reading …'));
    if (this.#kind === 'live') {
      const live = ofRun ? new RunSeries(this.#connection)
        : new LiveSeries(this.#connection, robot.name, robot.modules.map(({name}) => name));
      live.addEventListener('values', () => { this.#showValues(); this.#build(); });
      live.addEventListener('points', () => this.#soon());
      this.#source = live;
    } else {
      const whose = ofRun ? '' : `robot=${encodeURIComponent(robot.name)}&`;
      const answer = await fetch(`api/playback/table?${whose}points=${TABLE_POINTS}`).catch(() => null);
      if (this.#sourceKey !== key) return;
      if (!answer?.ok) return setText(this.#note, answer ? (await answer.text()).trim() : t('the daemon does not answer'));
      const text = await answer.text();
      if (this.#sourceKey !== key) return;
      this.#source = ofRun ? readRunTable(text, scores) : readTable(text, robotValue(robot.name, robot.modules.map(({name}) => name.slice(name.lastIndexOf('/') + 1))));
      this.#showValues();
      this.#build();
    }
  }

  #close() {
    this.#source?.stop?.();
    this.#source = null;
    this.#sourceKey = '';
    for (const {chart} of this.#plots) chart.destroy();
    this.#plots = [];
  }

  #showValues() {
    const groups = new Map();
    for (const value of this.values) {
      if (!groups.has(value.module)) groups.set(value.module, []);
      groups.get(value.module).push(value);
    }
    this.#values.replaceChildren(...[...groups].map(([module, values]) => make('fieldset', {}, make('legend', {}, legendOf(module) || this.#title),
      ...values.map(({key, name, unit}) => {
        const box = make('input', {type: 'checkbox', checked: this.#marked.has(key)});
        box.dataset.key = key;
        box.addEventListener('change', () => {
          if (box.checked) this.#marked.add(key);
          else this.#marked.delete(key);
          this.#build();
        });
        return make('label', {title: unit}, box, ` ${name}`);
      }))));
    this.#sayWhatNext();
  }

  #sayWhatNext() {
    const none = this.values.every(({key}) => !this.#marked.has(key));
    const playing = this.#kind === 'run' ? ` ${t('A click on a plot goes to that time.')}` : '';
    if (this.#robot === RUN && this.values.length === 0) {
      return setText(this.#note, t('This run has no scores, and clients have logged no numbers: there is nothing to plot.'));
    }
    setText(this.#note, none ? t('Choose values: those of one unit share a plot.') : t('Drag to zoom, double click for all.') + playing);
  }

  /** Builds the charts, one for each unit among the curves. */
  async #build() {
    this.#uPlot ??= (await import('uplot')).default;
    for (const {chart} of this.#plots) chart.destroy();
    this.#plots = [];
    this.#charts.replaceChildren();
    if (!this.#source) return;
    const units = new Map();
    this.values.forEach((value, at) => {
      if (!this.#marked.has(value.key)) return;
      if (!units.has(value.unit)) units.set(value.unit, []);
      units.get(value.unit).push(at);
    });
    const style = getComputedStyle(this.#panel);
    const axis = {stroke: style.color, grid: {stroke: '#8883', width: 1}, ticks: {show: false}, font: '11px system-ui', size: 44};
    for (const [unit, at] of units) {
      const series = at.map((column, i) => ({label: `${this.values[column].module} ${this.values[column].name}`.trim(),
        ...(this.values[column].holds ? {paths: this.#uPlot.paths.stepped({align: 1})} : {}),
        stroke: COLORS[i % COLORS.length], width: 1.5, points: {show: false}, value: (_, value) => showNumber(value, 3)}));
      const chart = new this.#uPlot({width: this.#width, height: HEIGHT_PX, cursor: {sync: {key: 'coopdyn'}}, legend: {live: true},
        scales: {x: {time: false}}, series: [{label: 's', value: (_, value) => showNumber(value, 2)}, ...series],
        axes: [{...axis, size: 28}, {...axis, label: unit, labelSize: 18, labelFont: '11px system-ui'}],
        hooks: {draw: [(drawn) => this.#drawNow(drawn)], ready: [(made) => this.#listen(made)]}}, this.#dataOf(at), this.#charts);
      const plot = {unit, chart, at, zoomed: false, held: false};
      chart.over.addEventListener('mousedown', () => {
        plot.held = true;  // new points would clear the selection
        document.addEventListener('mouseup', () => { plot.held = false; }, {once: true});
      });
      chart.over.addEventListener('dblclick', () => { plot.zoomed = false; });
      chart.hooks.setSelect = [() => { plot.zoomed ||= chart.select.width > 2; }];
      this.#plots.push(plot);
    }
    this.#sayWhatNext();
  }

  get #width() { return Math.max(200, this.#charts.clientWidth); }

  #dataOf(at) { return [this.#source.points.times, ...at.map((column) => this.#source.points.columns[column])]; }

  #listen(chart) {
    chart.over.addEventListener('click', () => {
      const {left} = chart.cursor;
      if (this.#kind === 'run' && left >= 0 && chart.select.width < 2) this.#timeline.seek(chart.posToVal(left, 'x'));
    });
  }

  /** Marks the shown time in a playback. */
  #drawNow(chart) {
    const now = this.#status?.playback?.time_s;
    if (now === undefined) return;
    const x = chart.valToPos(now, 'x', true);
    const {ctx, bbox} = chart;
    if (x < bbox.left || x > bbox.left + bbox.width) return;
    ctx.save();
    ctx.strokeStyle = getComputedStyle(this.#panel).color;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }

  #soon() {
    if (this.#due) return;
    this.#due = requestAnimationFrame(() => {
      this.#due = 0;
      this.#draw();
    });
  }

  #draw() {
    if (!this.#source) return;
    const span = Number(this.#span.value), last = this.#source.points.times.at(-1);
    for (const {chart, at, zoomed} of this.#plots.filter(({held}) => !held)) {
      chart.setData(this.#dataOf(at), !zoomed);
      if (!zoomed && span > 0 && last !== undefined) chart.setScale('x', {min: last - span, max: last});
      if (zoomed) chart.redraw();
    }
  }

  #resize() {
    for (const {chart} of this.#plots) chart.setSize({width: this.#width, height: HEIGHT_PX});
  }

  #saveCsv() {
    if (!this.#source) return;
    const at = this.values.map((value, i) => (this.#marked.has(value.key) ? i : -1)).filter((i) => i >= 0);
    if (at.length === 0) return say(t('choose a value to plot first'), true);
    const {times, columns} = this.#source.points;
    const text = csvOf(this.#title, at.map((i) => this.values[i]), {times, columns: at.map((i) => columns[i])});
    saveFile(`${this.#title}.csv`, new Blob([text], {type: 'text/csv'}));
  }

  #savePng() {
    if (this.#plots.length === 0) return say(t('choose a value to plot first'), true);
    const charts = this.#plots.map(({chart}) => chart.ctx.canvas);
    const sheet = make('canvas', {width: charts[0].width, height: charts.reduce((sum, {height}) => sum + height, 0)});
    const draw = sheet.getContext('2d');
    draw.fillStyle = getComputedStyle(this.#panel.closest('aside')).backgroundColor;
    draw.fillRect(0, 0, sheet.width, sheet.height);
    let y = 0;
    for (const chart of charts) {
      draw.drawImage(chart, 0, y);
      y += chart.height;
    }
    sheet.toBlob((blob) => saveFile(`${this.#title}.png`, blob));
  }

  #drawStrip() {
    const {width, height} = this.#strip, draw = this.#strip.getContext('2d');
    const most = Math.max(1, ...this.#rates.map(({rtf}) => rtf)), end = this.#rates.at(-1)?.time ?? 0;
    draw.clearRect(0, 0, width, height);
    draw.strokeStyle = getComputedStyle(byId('tab-plots')).color;
    draw.lineWidth = 2;
    draw.beginPath();
    this.#rates.forEach(({time, rtf}, i) => draw[i ? 'lineTo' : 'moveTo'](width * (1 - (end - time) / STRIP_S), height - 3 - (height - 6) * rtf / most));
    draw.stroke();
    const {hash = '', step = 0, rtf = 0} = this.#status ?? {};
    setText(this.#hash, t('real-time factor {rtf} · step {step} · hash {hash}', {rtf: showNumber(rtf, rtf < 100 ? 2 : 0), step, hash}));
  }
}
