// SPDX-License-Identifier: MIT
// Soft darkness on the floor under what stands on it: one draw call for all, for any number of things.
import * as THREE from 'three';

const STRENGTH = 0.42;
const LIFT_M = 0.0015;
const LEAST_PX = 8;  // half a side; smaller ones are not seen

const VERTEX = `
attribute vec4 outline;  // half sides, radius of the corners, width of the soft edge
attribute float strength;
varying vec4 vOutline;
varying vec2 at;
varying float vStrength;
void main() {
  vOutline = outline;
  vStrength = strength;
  at = position.xy * 2.0 * (outline.xy + outline.w);
  gl_Position = projectionMatrix * modelViewMatrix * instanceMatrix * vec4(at, 0.0, 1.0);
}
`;
const FRAGMENT = `
varying vec4 vOutline;
varying vec2 at;
varying float vStrength;
void main() {
  vec2 q = abs(at) - vOutline.xy + vOutline.z;
  float outside = length(max(q, 0.0)) + min(max(q.x, q.y), 0.0) - vOutline.z;
  float dark = 1.0 - smoothstep(-0.4 * vOutline.w, vOutline.w, outside);
  gl_FragColor = vec4(0.03, 0.04, 0.07, dark * dark * vStrength);
}
`;

/** `spots`: for each, {body, or a fixed pose X: [position, quaternion]; half: [x, y]; round: corner radius; low: height of the lowest point
 *  over the middle, negative; middle: place of the middle in the body}. */
export class ContactShadows {
  mesh;
  #spots;
  #strengths;

  constructor(spots) {
    this.#spots = spots;
    const plane = new THREE.PlaneGeometry(1, 1);
    const outline = new Float32Array(4 * spots.length);
    spots.forEach(({half, round}, i) => outline.set([...half, round, this.#softness(half)], 4 * i));
    plane.setAttribute('outline', new THREE.InstancedBufferAttribute(outline, 4));
    this.#strengths = new THREE.InstancedBufferAttribute(new Float32Array(spots.length), 1);
    plane.setAttribute('strength', this.#strengths);
    const material = new THREE.ShaderMaterial({vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, depthWrite: false,
      polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2, toneMapped: false});
    this.mesh = new THREE.InstancedMesh(plane, material, spots.length);
    this.mesh.frustumCulled = false;
    this.mesh.raycast = () => {};
  }

  #softness(half) { return Math.min(0.3, 0.15 + 0.25 * Math.min(...half)) * Math.min(1, 4 * Math.max(...half)); }

  /** Moves the spots to where their bodies are: x y z and a quaternion x y z w for each. `pixels`: of a metre at a point; null: very many. */
  place(bodies, pixels) {
    const X = new THREE.Matrix4(), p = new THREE.Vector3(), q = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1), none = new THREE.Vector3();
    const middle = new THREE.Vector3(), flat = new THREE.Quaternion();
    this.#spots.forEach((spot, i) => {
      if (spot.body >= 0) {
        p.fromArray(bodies, 7 * spot.body);
        q.fromArray(bodies, 7 * spot.body + 3);
      } else {
        p.copy(spot.X[0]);
        q.copy(spot.X[1]);
      }
      p.add(middle.fromArray(spot.middle).applyQuaternion(q));
      const height = Math.max(0, p.z + spot.low);
      const reach = Math.max(0.05, Math.max(...spot.half));
      this.#strengths.setX(i, p.z < 0 ? 0 : STRENGTH * Math.max(0, 1 - height / reach) ** 2);
      flat.set(0, 0, q.z, q.w).normalize();  // the yaw
      const seen = !pixels || reach * pixels(p) >= LEAST_PX;
      this.mesh.setMatrixAt(i, X.compose(p.setZ(LIFT_M), flat, seen ? one : none));
    });
    this.#strengths.needsUpdate = true;
    this.mesh.instanceMatrix.needsUpdate = true;
  }
}
