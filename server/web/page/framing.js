// SPDX-License-Identifier: MIT
// Places the camera so that a box fills the picture.
import * as THREE from 'three';

const FILLED = 0.9;  // fraction of the picture that the box fills
const LEAST_SEEN_M = 3;  // shows some floor around a single small thing

/** Places `camera` so that it sees all of `box`: from above if `from` is 'top', else from the side. Sets the target of
 *  `controls`. */
export function frameBox(box, from, camera, controls) {
  const narrow = box.getSize(new THREE.Vector3());
  box.expandByVector(new THREE.Vector3(Math.max(0, LEAST_SEEN_M - narrow.x) / 2, Math.max(0, LEAST_SEEN_M - narrow.y) / 2, 0));
  const size = box.getSize(new THREE.Vector3()), middle = box.getCenter(new THREE.Vector3()), top = from === 'top';
  const half = top ? Math.max(size.y, size.x / camera.aspect) / 2 : Math.max(size.length() / 2, 0.5) / Math.min(1, camera.aspect);
  const away = 1.08 * Math.max(0.8, half) / Math.tan(THREE.MathUtils.degToRad(camera.fov) / 2);
  controls.target.set(middle.x, middle.y, top ? 0 : Math.min(middle.z, 0.3 * size.z));
  const direction = top ? new THREE.Vector3(0, -0.001, 1) : new THREE.Vector3(-0.62, -0.5, 0.6).normalize();
  camera.position.copy(controls.target).addScaledVector(direction, top ? away : 0.78 * away);
  controls.update();
  if (!top) fill(box, camera, controls);
}

/** Moves the camera, which already looks at the box, until the box fills the picture. */
function fill(box, camera, controls) {
  const {target} = controls, up = new THREE.Vector3(), right = new THREE.Vector3(), p = new THREE.Vector3();
  for (let round = 0; round < 4; ++round) {
    camera.updateMatrixWorld();
    const seen = new THREE.Box2();
    for (let corner = 0; corner < 8; ++corner) {
      p.set(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y, corner & 4 ? box.max.z : Math.min(0, box.min.z)).project(camera);
      seen.expandByPoint(p);
    }
    const middle = seen.getCenter(new THREE.Vector2()), size = seen.getSize(new THREE.Vector2());
    const away = camera.position.distanceTo(target), half = away * Math.tan(THREE.MathUtils.degToRad(camera.fov) / 2);
    camera.matrixWorld.extractBasis(right, up, new THREE.Vector3());
    const way = right.multiplyScalar(middle.x * half * camera.aspect).addScaledVector(up, middle.y * half);
    const factor = Math.max(size.x, size.y) / (2 * FILLED);
    target.add(way);
    camera.position.add(way).sub(target).multiplyScalar(factor).add(target);
    controls.update();
  }
}
