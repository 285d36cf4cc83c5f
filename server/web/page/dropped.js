// SPDX-License-Identifier: MIT
// Files dropped on the page: loads scenarios; uploads worlds and robot models, then uses them.
import {byId, say} from './dom.js';
import {t} from './words.js';

const MOST_BYTES = 12 * 2 ** 20;
const KINDS = /\.(scenario|xml|world|sdf|urdf|txt)$/i;

/** The text of a file: as UTF-8, else as Windows-1252. */
export async function textOf(file) {
  const bytes = await file.arrayBuffer();
  try {
    return new TextDecoder('utf-8', {fatal: true}).decode(bytes);
  } catch {
    return new TextDecoder('windows-1252').decode(bytes);
  }
}

export class Dropped {
  #connection;
  #controls;
  #gallery;
  #world = null;

  constructor(connection, controls, gallery) {
    this.#connection = connection;
    this.#controls = controls;
    this.#gallery = gallery;
    const hasFiles = (event) => event.dataTransfer?.types.includes('Files');
    document.addEventListener('dragover', (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      event.dataTransfer.dropEffect = 'copy';
      byId('view-frame').classList.add('drop');
    });
    for (const name of ['dragleave', 'drop', 'dragend']) document.addEventListener(name, () => byId('view-frame').classList.remove('drop'));
    document.addEventListener('drop', (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      this.take([...event.dataTransfer.files], event.clientX, event.clientY);
    });
  }

  setWorld(world) { this.#world = world; }

  async take(files, x, y) {
    const wrong = files.find((file) => !KINDS.test(file.name));
    if (wrong) return say(t('{name}: drop a .scenario, .xml, .world, .sdf or .urdf file', {name: wrong.name}), true);
    const large = files.find((file) => file.size > MOST_BYTES);
    if (large) return say(t('{name} is larger than 12 MB: put it into the daemon\'s folder instead', {name: large.name}), true);
    // Dependencies first: a scenario may name a world or a robot dropped with it.
    const rank = ({name}) => ['sdf', 'urdf', 'world', 'scenario', 'xml', 'txt'].indexOf(name.split('.').at(-1).toLowerCase());
    for (const file of files.sort((a, b) => rank(a) - rank(b))) await this.#takeOne(file, files.length === 1, x, y);
  }

  async #takeOne(file, alone, x, y) {
    const text = await textOf(file);
    if (/\.(scenario|xml|txt)$/i.test(file.name)) return this.#controls.loadText(text, file.name);
    const answer = await fetch('api/upload', {method: 'POST', headers: {'Content-Type': 'application/json'},
      body: JSON.stringify({name: file.name, text, token: this.#connection.token || undefined})}).catch(() => null);
    if (!answer) return say(t('the daemon does not answer'), true);
    if (!answer.ok) return say(`${file.name}: ${(await answer.text()).trim()}`, true);
    const report = await answer.json();
    if (!report.ok) return this.#controls.showErrors(report.diagnostics, text);
    this.#gallery.refresh();
    say(report.kind === 'robot' ? t('{file} is here as the robot {name}', {file: file.name, name: report.name})
      : t('{file} is here as the world {name}', {file: file.name, name: report.name}));
    if (!alone) return undefined;
    if (report.kind === 'robot' && this.#world) return this.#world.insertAt('robot', report.name, x, y);
    return this.#controls.load({command: 'load_scenario', text: report.load}, report.name);
  }
}
