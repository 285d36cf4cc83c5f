// SPDX-License-Identifier: MIT
// What lights the view, and what that costs. A graphics card draws physically based materials in the light of a sky, soft shadows and
// smooth edges. Without one, a slow view first loses shadows and small parts, then a few pixels; once nothing moves, it is drawn finely.
import * as THREE from 'three';
import {PlainMaterial} from './plain.js';

/** Towards the sun: over the left shoulder of the first view. The same as in the daemon's pictures (server/render/draw_list.h). */
const SUN_W = new THREE.Vector3(-0.66, -0.56, 1);
const SUN = {light: 2.5, dark: 2.3}, SKY = {light: 1, dark: 0.78};  // intensities
const SHADOW_ROBOTS = {software: 10, hardware: 600};  // beyond this, shadows cost more than they show
const SLOW_MS = [60, 60, 120, 120];  // between two pictures, by level: then the next
const DETAIL = {fine: 3, usual: 1, coarse: 0.6};  // pixels that count as one, where robots are small
const RATIOS = [1, 0.85, 0.75];  // drawn pixels per screen pixel along a side; fewer would show
const FINE_MS = 300;  // without motion, until the view is drawn finely
const FINE_RATIO = 1.5, FINE_PIXELS = 2.5e6;

/** A sky without files: bright above, darker towards the floor, and a lamp that shines on edges. World frame, z up. */
function makeSky(renderer) {
  const sky = new THREE.Scene();
  const dome = new THREE.SphereGeometry(50, 24, 16), colors = [], place = new THREE.Vector3(), color = new THREE.Color();
  const above = new THREE.Color(0.62, 0.74, 0.92), horizon = new THREE.Color(0.86, 0.88, 0.90), below = new THREE.Color(0.36, 0.36, 0.37);
  for (let i = 0; i < dome.attributes.position.count; ++i) {
    const height = place.fromBufferAttribute(dome.attributes.position, i).normalize().z;
    color.copy(horizon).lerp(height > 0 ? above : below, Math.min(1, Math.abs(height) * (height > 0 ? 1.4 : 3)));
    colors.push(color.r, color.g, color.b);
  }
  dome.setAttribute('color', new THREE.Float32BufferAttribute(colors, 3));
  sky.add(new THREE.Mesh(dome, new THREE.MeshBasicMaterial({vertexColors: true, side: THREE.BackSide})));
  const lamp = new THREE.MeshBasicMaterial({color: new THREE.Color(6, 5.8, 5.4)});
  for (const [x, y, z] of [[-20, -12, 26], [24, 16, 18]]) {
    const panel = new THREE.Mesh(new THREE.SphereGeometry(4, 16, 8), lamp);
    panel.position.set(x, y, z);
    sky.add(panel);
  }
  const maker = new THREE.PMREMGenerator(renderer);
  const made = maker.fromScene(sky, 0.03).texture;
  maker.dispose();
  sky.traverse((object) => { object.geometry?.dispose(); object.material?.dispose(); });
  return made;
}

/** Behind everything: a colour, a little brighter above, darker below. Drawn last, where nothing else is, without textures and conversions:
 *  without a graphics card these would cost more than all else. */
function makeBackground() {
  const vertexShader = 'varying float up; void main() { up = uv.y; gl_Position = vec4(position.xy, 1.0, 1.0); }';
  const fragmentShader = 'uniform vec3 ground; varying float up; void main() { gl_FragColor = vec4(ground * (0.9 + 0.16 * up), 1.0); }';
  const material = new THREE.ShaderMaterial({vertexShader, fragmentShader, depthWrite: false, uniforms: {ground: {value: new THREE.Vector3()}}});
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
  mesh.frustumCulled = false;
  mesh.renderOrder = 100;
  return mesh;
}

export class Stage {
  renderer;
  #software;
  #root;
  #frame;
  #sun = new THREE.DirectionalLight(0xfff8f0, SUN.light);
  #sky = new THREE.HemisphereLight(0xdfeaff, 0x85878c, 1);
  #background = makeBackground();
  #shadows = true;   // wanted
  #many = false;     // too many robots for shadows
  #scene = null;
  #dark = false;
  #level = 0;        // of economy: 1 no shadows, 2 no small parts, then the ratios
  #interval = 33;    // average ms between two pictures
  #drawnAt = 0;
  #fine = false;     // the last picture was a fine one
  #ratio = 0;
  #detail = 'usual';

  /** `quality`: 'software' or 'hardware'. Draws into `canvas`, as large as `frame`. */
  constructor(canvas, frame, quality, root) {
    this.#software = quality === 'software';
    this.#frame = frame;
    this.#root = root;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: !this.#software, preserveDrawingBuffer: true});
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.autoUpdate = !this.#software;  // otherwise only after changes, also if the camera moves
    this.renderer.shadowMap.type = this.#software ? THREE.BasicShadowMap : THREE.PCFShadowMap;
    this.#sun.shadow.mapSize.setScalar(this.#software ? 1024 : 2048);
    Object.assign(this.#sun.shadow, {bias: -0.0003, normalBias: 0.015, radius: this.#software ? 1.5 : 2.5});
    root.add(this.#sun, this.#sun.target, this.#background);
    if (this.#software) root.add(this.#sky);
    else root.environment = makeSky(this.renderer);
    this.resize();
  }

  get software() { return this.#software; }
  get dark() { return this.#dark; }
  /** Whether a slow view has become coarser, and how far. */
  get level() { return this.#level; }

  /** A function (color, options) that makes materials in this light, and that of `lamps`. */
  materialsFor(lamps) {
    const Kind = lamps.length > 0 ? THREE.MeshLambertMaterial : PlainMaterial;
    return (color, {roughness = 0.5, metalness = 0, ...more} = {}) =>
      (this.#software ? new Kind({color, ...more}) : new THREE.MeshStandardMaterial({color, roughness, metalness, ...more}));
  }

  /** Suits the theme, whose ground the view's frame has. */
  paint() {
    const ground = new THREE.Color(getComputedStyle(this.#frame).backgroundColor);
    const {r, g, b} = ground.clone().convertLinearToSRGB();
    this.#dark = 0.3 * r + 0.6 * g + 0.1 * b < 0.5;
    this.#background.material.uniforms.ground.value.set(r, g, b);
    const theme = this.#dark ? 'dark' : 'light';
    this.#sun.intensity = (this.#software ? 1.12 : 1) * SUN[theme];
    this.#sky.intensity = 2.9 * SKY[theme];
    this.#root.environmentIntensity = 0.78 * SKY[theme];
    this.#scene?.paint(this.#dark);
  }

  /** Lights `scene`, which is new, where `box` is. */
  show(scene, box) {
    this.#scene = scene;
    this.#many = scene.description.robots.length > SHADOW_ROBOTS[this.#software ? 'software' : 'hardware'];
    scene.paint(this.#dark);
    const middle = box.getCenter(new THREE.Vector3()), radius = Math.max(1.5, box.getSize(new THREE.Vector3()).length() / 2);
    this.#sun.position.copy(middle).addScaledVector(SUN_W, 2 * radius);
    this.#sun.target.position.copy(middle);
    const {camera} = this.#sun.shadow;
    Object.assign(camera, {left: -radius, right: radius, top: radius, bottom: -radius, near: 0.1, far: 5 * radius});
    camera.updateProjectionMatrix();
    this.#useLevel(this.#level);
  }

  /** Shadows have changed. */
  changed() { this.renderer.shadowMap.needsUpdate = true; }

  /** Another scenario may be cheaper than the last. */
  startAnew() { this.#level = 0; }

  set shadows(wanted) {
    this.#shadows = wanted;
    this.#useLevel(this.#level);
  }

  resize() { this.#useLevel(this.#level, true); }

  #useLevel(level, anew = false) {
    this.#level = level;
    this.#fine = false;
    this.changed();
    this.#sun.castShadow = this.#shadows && !this.#many && level < 1;
    this.#detail = level < 2 ? 'usual' : 'coarse';
    this.#setRatio(this.#software ? RATIOS[Math.max(0, level - 2)] : Math.min(2, devicePixelRatio), anew);
  }

  #setRatio(ratio, anew) {
    const {clientWidth: width, clientHeight: height} = this.#frame;
    if (width === 0 || height === 0 || (ratio === this.#ratio && !anew)) return;
    this.#ratio = ratio;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  /** Draws, and notes how long pictures take. `moves`: the next picture follows at once. */
  draw(camera, now, moves) {
    if (this.#fine) this.#useLevel(this.#level);
    if (moves) this.changed();
    this.place(camera);
    this.render(camera);
    const pause = now - this.#drawnAt;
    this.#drawnAt = now;
    if (!this.#software || !moves || pause > 500) return;
    this.#interval += 0.15 * (pause - this.#interval);
    if (this.#level >= SLOW_MS.length || this.#interval < SLOW_MS[this.#level]) return;
    this.#interval = 33;
    this.#useLevel(this.#level + (this.#level === 0 && !this.#sun.castShadow ? 2 : 1));
  }

  /** Whether the view rests and is still to be drawn finely. */
  isFineDue(now) { return this.#software && !this.#fine && now - this.#drawnAt > FINE_MS; }

  /** Draws all there is, with smooth edges. */
  drawFine(camera) {
    const {clientWidth: width, clientHeight: height} = this.#frame;
    this.#sun.castShadow = this.#shadows;
    this.changed();
    this.#detail = 'fine';
    this.#setRatio(Math.min(FINE_RATIO, Math.sqrt(FINE_PIXELS / (width * height))));
    this.place(camera);
    this.render(camera);
    this.#fine = true;
  }

  /** Moves the scene's things to where they are, as detailed as the next picture needs. */
  place(camera) {
    if (this.#software) this.#scene.lookFrom(camera, DETAIL[this.#detail] * this.#frame.clientHeight);
    this.#scene.place();
  }

  render(camera) { this.renderer.render(this.#root, camera); }
}
