// SPDX-License-Identifier: MIT
// What a robot's camera sees, in a corner of the view: of the selected robot, or the first that has a camera.
import {make, setText} from './dom.js';
import {CameraTile} from './sensors.js';
import {t} from './words.js';

export class CornerCamera {
  #view;
  #connection;
  #on = false;
  #robots = [];  // in the last status
  #shown = '';   // the module of the picture
  #tile = null;
  #note = make('p', {class: 'quiet'});
  #element = make('div', {id: 'corner-camera', hidden: true}, this.#note);

  constructor(view, connection) {
    this.#view = view;
    this.#connection = connection;
    view.canvas.after(this.#element);
    connection.addEventListener('status', ({detail}) => {
      this.#robots = detail?.robots ?? [];
      if (this.#on) this.#choose();
    });
    view.addEventListener('select', () => { if (this.#on) this.#choose(); });
  }

  draw() {}

  begin(on) {
    this.#on = on;
    this.#element.hidden = !on;
    if (on) this.#choose();
    else this.#show(null);
  }

  #choose() {
    const camera = ({modules}) => modules.find(({type}) => type === 'camera');
    const selected = this.#robots.find(({name}) => name === this.#view.selected?.name);
    const robot = selected && camera(selected) ? selected : this.#robots.find(camera);
    this.#show(robot ? {robot: robot.name, module: camera(robot).name} : null);
  }

  #show(chosen) {
    setText(this.#note, chosen ? chosen.robot : t('No robot here has a camera'));
    const module = chosen?.module ?? '';
    if (module === this.#shown) return;
    this.#shown = module;
    this.#tile?.stop();
    this.#tile?.element.remove();
    this.#tile = chosen ? new CameraTile(this.#connection, chosen.robot, module.slice(module.lastIndexOf('/') + 1)) : null;
    if (this.#tile) this.#element.append(this.#tile.element);
  }
}
