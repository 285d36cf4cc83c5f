// SPDX-License-Identifier: MIT
// Where the view's camera is: named views, smooth moves between them, and following a robot.
import * as THREE from 'three';
import {byId, make, setText} from './dom.js';
import {BACKWARD, Flight, frame} from './framing.js';
import {t} from './words.js';

const BEHIND = new THREE.Vector3(-1, 0, 0.55).normalize();  // from a robot to a camera behind it
const LEAST_ROBOT_M = 0.9;  // away from it
const TITLES = {front: [t('front'), t('Look from the front, against x (1)')], side: [t('side'), t('Look from the right side, along y (2)')],
  robot: [t('robot'), t('Behind the selected robot, and with it (3)')]};

const MOST_COVERED = 0.3;   // of the view's height, at one edge

const calm = () => matchMedia('(prefers-reduced-motion: reduce)').matches;
const yawOf = (q) => Math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));

export class Looks {
  #view;
  #camera;
  #controls;
  #flight = null;
  #framed = '';        // the named view that is shown, unless the camera was moved
  #follows = null;     // a thing
  #turns = false;      // with it, too
  #followed = null;    // its last {p, yaw}
  #button;

  constructor(view) {
    this.#view = view;
    this.#camera = view.camera;
    this.#controls = view.controls;
    this.#controls.addEventListener('start', () => { this.#flight = null; this.#framed = ''; });
    byId('whole').addEventListener('click', () => this.fit());
    view.addTool(t('top'), t('Look from above (T)'), () => this.fit('top'));
    const list = make('div', {id: 'looks-list', role: 'group', 'aria-label': t('Named views')});
    const menu = make('details', {id: 'looks', class: 'menu'}, make('summary', {title: t('From the front, from the side, behind a robot')}, t('Look')), list);
    for (const [name, [text, title]] of Object.entries(TITLES)) {
      const button = make('button', {type: 'button', title}, text);
      button.addEventListener('click', () => { menu.open = false; this.look(name); });
      list.append(button);
    }
    byId('view-tools').append(menu);
    this.#button = view.addTool(t('follow'), t('The camera follows the selected robot (F, or a double click on it)'), () => this.toggle());
    new ResizeObserver(() => this.resized()).observe(byId('news'));
    this.#show();
  }

  /** Keys of the view; false if this is none. */
  onKey(key) {
    const does = {Home: () => this.fit(), t: () => this.fit('top'), f: () => this.toggle(), 1: () => this.look('front'), 2: () => this.look('side'),
      3: () => this.look('robot')}[key];
    does?.();
    return Boolean(does);
  }

  get follows() { return this.#follows; }
  get flies() { return this.#flight !== null; }

  /** A named view: 'whole', 'top', 'front', 'side' or 'robot'. */
  look(name) {
    if (name !== 'robot') return this.fit(name);
    const robot = this.#view.selected?.kind === 'robot' ? this.#view.selected : this.#view.scene?.things.find(({kind}) => kind === 'robot');
    if (robot) this.follow(robot, true);
  }

  /** The first view of a scene: {from: a named view} or {eye, look: points}, as the scenario says. */
  start(view) {
    if (view.from) return this.fit(view.from, true);
    this.follow(null);
    this.#go({eye: new THREE.Vector3(...view.eye), target: new THREE.Vector3(...view.look)}, true);
  }

  /** Shows everything. `atOnce`: without a smooth move. */
  fit(from = 'whole', atOnce = false) {
    const {scene} = this.#view;
    if (!scene) return;
    this.#follows = null;
    this.#show();
    this.#go(frame(scene.outline(), BACKWARD[from], THREE.MathUtils.degToRad(this.#camera.fov), this.#camera.aspect, this.#covered()), atOnce);
    this.#framed = from;
  }

  /** Parts of the view's height that the news and the tools cover. */
  #covered() {
    const part = (id) => Math.min(MOST_COVERED, byId(id).offsetHeight / Math.max(1, byId('view-frame').clientHeight));
    return {top: part('news'), bottom: part('view-tools')};
  }

  /** The view has another size: what was all in it still is. */
  resized() { if (this.#framed) this.fit(this.#framed, true); }

  toggle() { this.follow(this.#follows ? null : this.#view.selected); }

  /** `turns`: the camera turns with it, and begins behind it. */
  follow(thing, turns = false) {
    this.#follows = thing ?? null;
    this.#turns = turns;
    this.#followed = null;
    this.#framed = '';
    this.#flight = null;
    this.#show();
    if (thing) {
      const [p, q] = this.#view.scene.pose(thing), yaw = yawOf(q), {radius = 0.5, height = 0.3} = thing.model ?? {};
      const target = p.clone().add(new THREE.Vector3(0, 0, 0.5 * height));
      const away = turns ? BEHIND.clone().applyAxisAngle(new THREE.Vector3(0, 0, 1), yaw) : this.#camera.position.clone().sub(this.#controls.target);
      this.#go({eye: away.setLength(Math.max(LEAST_ROBOT_M, 4.5 * Math.max(radius, 0.6 * height))).add(target), target});
      this.#followed = {p, yaw};
    }
    this.#view.redraw();
  }

  /** Keeps following the thing of that name in another scene. */
  keep(scene) {
    this.#follows = this.#follows ? scene.find(this.#follows.name) ?? null : null;
    this.#show();
  }

  zoom(factor) {
    this.#camera.position.sub(this.#controls.target).multiplyScalar(factor).add(this.#controls.target);
    this.#framed = '';
    this.#view.redraw();
  }

  /** Moves the camera for the picture of `now` (ms). True if it will move on by itself. */
  step(now) {
    const flew = this.#flight !== null;
    if (flew) {
      const {eye, target, ends} = this.#flight.at(now);
      this.#put(eye, target);
      if (ends) this.#flight = null;
    }
    const glides = !flew && this.#controls.enableDamping && this.#controls.update();
    if (this.#follows) this.#moveAlong();
    return flew || glides;
  }

  #moveAlong() {
    const [p, q] = this.#view.scene.pose(this.#follows), yaw = yawOf(q), before = this.#followed ?? {p, yaw};
    this.#followed = {p, yaw};
    if (this.#flight) return void this.#flight.shift(p.clone().sub(before.p));
    const way = p.clone().sub(before.p), away = this.#camera.position.clone().sub(this.#controls.target);
    if (this.#turns) away.applyAxisAngle(new THREE.Vector3(0, 0, 1), yaw - before.yaw);
    const target = this.#controls.target.clone().add(way);
    this.#put(away.add(target), target);
  }

  #go(to, atOnce = calm()) {
    const from = {eye: this.#camera.position.clone(), target: this.#controls.target.clone()};
    this.#flight = atOnce || calm() ? null : new Flight(from, to, performance.now());
    if (!this.#flight) this.#put(to.eye, to.target);
    this.#view.redraw();
  }

  #put(eye, target) {
    this.#camera.position.copy(eye);
    this.#controls.target.copy(target);
    this.#controls.update();
    this.#camera.updateMatrixWorld();
  }

  #show() {
    setText(this.#button, this.#follows ? t('following {name}', {name: this.#follows.name}) : t('follow'));
    this.#button.setAttribute('aria-pressed', String(Boolean(this.#follows)));
  }
}
