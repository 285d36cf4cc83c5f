// SPDX-License-Identifier: MIT
// Handles in the view that move and turn the selected thing: arrows along the floor, a ring about the vertical. A move that the
// daemon refuses, because things would overlap, is shown in red.
import * as THREE from 'three';
import {TransformControls} from 'three/addons/controls/TransformControls.js';
import {t} from './words.js';

const SNAP_M = 0.05;
const SNAP_RAD = Math.PI / 36;
const RED_MS = 1500;

export class Handles {
  #view;
  #world;
  #proxy = new THREE.Object3D();
  #controls;
  #helper;
  #thing = null;
  #ghost = null;

  constructor(view, world, button) {
    this.#view = view;
    this.#world = world;
    this.#controls = new TransformControls(view.camera, view.canvas);
    this.#controls.setSize(0.7);
    this.#controls.translationSnap = SNAP_M;
    this.#controls.rotationSnap = SNAP_RAD;
    this.#helper = this.#controls.getHelper();
    view.add(this.#proxy);
    view.add(this.#helper);
    this.#mode('translate');
    this.#controls.addEventListener('dragging-changed', ({value}) => {
      view.controls.enabled = !value;
      view.busy = true;
      if (value) return this.#showGhost(0x2f7bf0);
      this.#drop();
      setTimeout(() => { view.busy = false; }, 0);  // this click selects nothing
    });
    this.#controls.addEventListener('change', () => { this.#moveGhost(); view.redraw(); });
    view.addEventListener('select', ({detail}) => this.#attach(detail));
    view.addEventListener('drawn', () => this.#follow());
    const buttons = ['translate', 'rotate'].map((mode) => button(mode === 'translate' ? t('move') : t('turn'),
      mode === 'translate' ? t('Handles that move the selected thing (M)') : t('A ring that turns the selected thing (R)'), () => this.#mode(mode)));
    view.canvas.addEventListener('keydown', ({key}) => {
      if (key === 'm') this.#mode('translate');
      if (key === 'r') this.#mode('rotate');
    });
    this.#buttons = buttons;
    this.#mode('translate');
  }
  #buttons = [];

  #mode(mode) {
    const turns = mode === 'rotate';
    this.#controls.setMode(mode);
    Object.assign(this.#controls, {showX: !turns, showY: !turns, showZ: true});
    this.#buttons.forEach((button, i) => button.setAttribute('aria-pressed', String((i === 1) === turns)));
    this.#view.redraw();
  }

  #attach(thing) {
    this.#thing = thing;
    if (!thing) return this.#controls.detach();
    this.#follow();
    this.#controls.attach(this.#proxy);
  }

  #follow() {
    if (!this.#thing || this.#controls.dragging || !this.#view.scene) return;
    const [p, q] = this.#view.scene.pose(this.#thing);
    this.#proxy.position.copy(p);
    this.#proxy.quaternion.setFromAxisAngle(new THREE.Vector3(0, 0, 1), this.#yaw(q));
  }

  #yaw(q) { return new THREE.Euler().setFromQuaternion(q, 'ZYX').z; }

  #showGhost(color) {
    const {size, type} = this.#thing.description;
    const radius = this.#thing.model?.radius;
    const extent = radius ? [2 * radius, 2 * radius, this.#thing.model.height]
      : type === 'box' ? size : type === 'cylinder' ? [2 * size[0], 2 * size[0], size[1]] : Array(3).fill(2 * (size?.[0] ?? 0.1));
    this.#hideGhost();
    this.#ghost = new THREE.Mesh(new THREE.BoxGeometry(...extent), new THREE.MeshBasicMaterial({color, transparent: true, opacity: 0.35, depthWrite: false}));
    this.#ghost.userData.lift = radius ? this.#thing.model.height / 2 : 0;
    this.#view.add(this.#ghost);
    this.#moveGhost();
  }

  #moveGhost() {
    if (!this.#ghost) return;
    this.#ghost.position.copy(this.#proxy.position);
    this.#ghost.position.z += this.#ghost.userData.lift;
    this.#ghost.quaternion.copy(this.#proxy.quaternion);
  }

  #hideGhost() {
    this.#ghost?.removeFromParent();
    this.#ghost?.geometry.dispose();
    this.#ghost = null;
    this.#view.redraw();
  }

  async #drop() {
    const thing = this.#thing, {x, y, z} = this.#proxy.position;
    const turns = this.#controls.mode === 'rotate' && ['thing', 'robot'].includes(thing.kind);
    const reply = await this.#world.move(thing.name, [x, y, z], turns ? this.#yaw(this.#proxy.quaternion) : undefined);
    if (reply.error === 0) return this.#hideGhost();
    this.#ghost?.material.color.set(0xd0342c);
    this.#view.redraw();
    setTimeout(() => this.#hideGhost(), RED_MS);
    this.#follow();
  }
}
