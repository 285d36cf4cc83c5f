// SPDX-License-Identifier: MIT
// Where a camera stands to see all of some points, and how it gets there. World frame, z up; metres and radians. No DOM.
import * as THREE from 'three';

const MARGIN = 0.08;  // part of the picture's half that stays free at each side
const LEAST_AWAY_M = 0.3;
const FLIGHT_MS = 450;
const Z = new THREE.Vector3(0, 0, 1);

/** From what is seen towards the camera, by the name of the view. `whole` is the first: from the right of a robot that faces x, and a
 *  little behind it, as in the daemon's pictures. */
export const BACKWARD = {
  whole: new THREE.Vector3(-0.207, -0.722, 0.66).normalize(),
  top: new THREE.Vector3(0, -0.001, 1).normalize(),
  front: new THREE.Vector3(1, 0, 0.22).normalize(),
  side: new THREE.Vector3(0, -1, 0.22).normalize(),
};

/** {eye, target} of a camera that looks against `backward` and sees all `points` inside the margins, as large as possible.
 *  `aspect`: width per height; `fov_rad`: across the height; `covered`: parts of the height that texts and tools cover. */
export function frame(points, backward, fov_rad, aspect, covered = {top: 0, bottom: 0}) {
  const right = new THREE.Vector3().crossVectors(Z, backward).normalize(), up = new THREE.Vector3().crossVectors(backward, right);
  const tan = Math.tan(fov_rad / 2);
  // Along each axis of the picture, the points are in a wedge whose tip is the eye: `high` and `low` are its sides.
  const fit = (axis, above, below) => {
    let high = -Infinity, low = -Infinity;
    for (const point of points) {
      const across = point.dot(axis), depth = point.dot(backward);
      high = Math.max(high, across + above * depth);
      low = Math.max(low, below * depth - across);
    }
    return {high, low, above, below, away: (high + low) / (above + below)};
  };
  const wide = fit(right, tan * aspect * (1 - MARGIN), tan * aspect * (1 - MARGIN));
  const tall = fit(up, tan * (1 - MARGIN - 2 * covered.top), tan * (1 - MARGIN - 2 * covered.bottom));
  let near = -Infinity, far = Infinity;
  for (const point of points) {
    near = Math.max(near, point.dot(backward));
    far = Math.min(far, point.dot(backward));
  }
  const away = Math.max(wide.away, tall.away, near + LEAST_AWAY_M);
  // Where there is room to spare, in its middle.
  const across = ({high, low, above, below}) => ((high - above * away) + (below * away - low)) / 2;
  const eye = right.multiplyScalar(across(wide)).addScaledVector(up, across(tall)).addScaledVector(backward, away);
  return {eye, target: eye.clone().addScaledVector(backward, (near + far) / 2 - away)};
}

/** The camera's way from one place to another: around what it looks at, not through it. */
export class Flight {
  #from;
  #to;
  #begin;

  /** `from`, `to`: {eye, target}; `now` in ms. */
  constructor(from, to, now) {
    const parts = ({eye, target}) => ({target: target.clone(), around: new THREE.Spherical().setFromVector3(Flight.#yUp(eye.clone().sub(target)))});
    this.#from = parts(from);
    this.#to = parts(to);
    this.#begin = now;
    const turn = this.#to.around.theta - this.#from.around.theta;
    this.#from.around.theta += 2 * Math.PI * Math.round(turn / (2 * Math.PI));  // the short way round
  }

  /** What is flown to has moved by `way`. */
  shift(way) {
    this.#from.target.add(way);
    this.#to.target.add(way);
  }

  static #yUp(v) { return v.set(v.x, v.z, -v.y); }

  /** {eye, target} at `now`; `ends`: this is the last. */
  at(now) {
    const share = Math.min(1, Math.max(0, (now - this.#begin) / FLIGHT_MS)), s = share * share * (3 - 2 * share);
    const [a, b] = [this.#from.around, this.#to.around], mix = (x, y) => x + s * (y - x);
    const target = this.#from.target.clone().lerp(this.#to.target, s);
    const radius = Math.exp(mix(Math.log(Math.max(1e-3, a.radius)), Math.log(Math.max(1e-3, b.radius))));
    const away = new THREE.Vector3().setFromSphericalCoords(radius, mix(a.phi, b.phi), mix(a.theta, b.theta));
    return {eye: away.set(away.x, -away.z, away.y).add(target), target, ends: share >= 1};
  }
}
