// SPDX-License-Identifier: MIT
// A pale box where something that is dragged would stand; red where it cannot.
import * as THREE from 'three';

const COLOURS = {free: 0x2f7bf0, beside: 0xd0342c};

export class DragShadow {
  #view;
  #box = new THREE.Mesh(new THREE.BoxGeometry(1, 1, 1), new THREE.MeshBasicMaterial({transparent: true, opacity: 0.4, depthWrite: false}));

  constructor(view) { this.#view = view; }

  /** `size`: m; `x`, `y`: the place on the floor, m; `isFree`: it may stand there. */
  show(size, x, y, isFree) {
    this.#box.scale.set(...size);
    this.#box.position.set(Number(x), Number(y), size[2] / 2);
    this.#box.material.color.set(isFree ? COLOURS.free : COLOURS.beside);
    this.#view.add(this.#box);
  }

  hide() {
    this.#box.removeFromParent();
    this.#view.redraw();
  }

  /** For tests: {x, y, isFree}; null if nothing is shown. */
  get shown() {
    const {x, y} = this.#box.position;
    return this.#box.parent ? {x, y, isFree: this.#box.material.color.getHex() === COLOURS.free} : null;
  }
}
