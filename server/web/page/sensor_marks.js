// SPDX-License-Identifier: MIT
// What sensors show in the view: rays, scans, cones, fields of view. The daemon sends them (docs/protocol.md) while they are wanted.
import * as THREE from 'three';

const RATE_HZ = 15;
const DOT_PX = 5;

/** The vertices of a message, {places, colors, counts: of triangles, lines, dots}; pure. */
export function readSensors(buffer) {
  const view = new DataView(buffer), counts = [4, 8, 12].map((at) => view.getUint32(at, true));
  const vertices = 3 * counts[0] + 2 * counts[1] + counts[2];
  return {counts, places: new Float32Array(buffer, 16, 3 * vertices), colors: new Uint8Array(buffer, 16 + 12 * vertices, 4 * vertices)};
}

/** Shows sRGB colours as given. */
function showAsGiven(shader) {
  shader.fragmentShader = shader.fragmentShader.replace('#include <colorspace_fragment>', '');
}

/** Cuts square points round, and lifts them from the surfaces that they lie on. */
function makeDots(shader) {
  showAsGiven(shader);
  shader.vertexShader = shader.vertexShader.replace('#include <project_vertex>', '#include <project_vertex>\ngl_Position.z -= 0.0002 * gl_Position.w;');
  shader.fragmentShader = shader.fragmentShader.replace('#include <clipping_planes_fragment>', 'if (length(gl_PointCoord - 0.5) > 0.5) discard;');
}

export class SensorMarks {
  #view;
  #connection;
  #on = false;
  #parts;  // the objects of triangles, lines and dots

  constructor(view, connection) {
    this.#view = view;
    this.#connection = connection;
    const look = {vertexColors: true, transparent: true, depthWrite: false, toneMapped: false, onBeforeCompile: showAsGiven};
    const dots = new THREE.PointsMaterial({...look, size: DOT_PX, sizeAttenuation: false, onBeforeCompile: makeDots});
    this.#parts = [new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({...look, side: THREE.DoubleSide})),
      new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial(look)), new THREE.Points(new THREE.BufferGeometry(), dots)];
    this.#parts.forEach((part, i) => {
      part.frustumCulled = false;
      part.renderOrder = 5 + i;
      view.add(part);
    });
    connection.addEventListener('sensors', ({detail}) => { if (this.#on) this.#show(detail); });
    connection.addEventListener('hello', () => this.#ask());
    document.addEventListener('visibilitychange', () => this.#ask());
  }

  /** How many triangles, lines and dots are shown. */
  get counts() { return this.#parts.map(({geometry}, i) => (geometry.getAttribute('position')?.count ?? 0) / (3 - i)); }
  draw() {}

  begin(on) {
    if (on === this.#on) return;
    this.#on = on;
    this.#ask();
    if (!on) this.#parts.forEach((part) => this.#set(part));
  }

  #ask() {
    const rate = this.#on && !document.hidden ? RATE_HZ : 0;
    if (rate > 0 || this.#asked) this.#connection.send({type: 'sensors', rate});
    this.#asked = rate > 0;
  }
  #asked = false;

  #show(buffer) {
    const {counts, places, colors} = readSensors(buffer);
    let at = 0;
    this.#parts.forEach((part, i) => {
      const end = at + (3 - i) * counts[i];
      this.#set(part, places.subarray(3 * at, 3 * end), colors.subarray(4 * at, 4 * end));
      at = end;
    });
  }

  #set(part, places = new Float32Array(), colors = new Uint8Array()) {
    part.geometry.dispose();
    part.geometry = new THREE.BufferGeometry();
    if (places.length > 0) {
      part.geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
      part.geometry.setAttribute('color', new THREE.BufferAttribute(colors, 4, true));
    }
    part.visible = places.length > 0;
    this.#view.redraw();
  }
}
