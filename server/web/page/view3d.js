// SPDX-License-Identifier: MIT
// The live view drawn by the browser: the scene from /api/scene, moved by pose messages. Left button turns, right button moves, wheel
// zooms to the pointer; one finger turns, two move and zoom. A click selects, a double click follows.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {byId, make, setText} from './dom.js';
import {frameBox} from './framing.js';
import {Interpolator, PoseReader} from './poses.js';
import {Scene3d} from './scene3d.js';

const RATE_HZ = 30;
const FOV_DEG = THREE.MathUtils.radToDeg(0.8);  // as in the daemon's pictures
const MAX_WIDTH = 1280;  // of the daemon's pictures
const SLOW_MS = 60, LEAST_RATIO = 0.45;
const SHADOW_ROBOTS = {software: 10, hardware: 300};  // beyond this, shadows cost more than they show

/** This browser's WebGL: 'none', 'software' or 'hardware'. */
export function webGl() {
  try {
    const gl = document.createElement('canvas').getContext('webgl2');
    if (!gl) return 'none';
    const about = gl.getExtension('WEBGL_debug_renderer_info');
    const name = about ? gl.getParameter(about.UNMASKED_RENDERER_WEBGL) : '';
    gl.getExtension('WEBGL_lose_context')?.loseContext();
    return /swiftshader|llvmpipe|software|basic render/i.test(name) ? 'software' : 'hardware';
  } catch {
    return 'none';
  }
}

/** Events: select (detail: the thing, or null), scene (a new one is shown), drawing (poses are set), drawn. A thing is {kind, name, id, description}. */
export class View3d extends EventTarget {
  #connection;
  #frame = byId('view-frame');
  #canvas;
  #renderer;
  #root = new THREE.Scene();
  #camera = new THREE.PerspectiveCamera(FOV_DEG, 1, 0.02, 2000);
  #controls;
  #sun = new THREE.DirectionalLight(0xffffff, 2.1);
  #sky = new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.5);
  #scene = null;
  #reader = new PoseReader();
  #between = new Interpolator();
  #loading = false;   // a request for the scene is pending
  #stale = false;     // after reconnecting, the same number may mean another scene
  #drop = null;       // frees the last scene
  #dirty = true;
  #framed = '';       // the scenario that the camera was set up for
  #selected = null;
  #follows = null;
  #followed = null;   // last position of #follows
  #outline = new THREE.Group();
  #shadows = true;
  #drawn = 0;
  #drawnAt = 0;
  #interval = 33;  // average ms between two pictures
  #ratio = 1;      // drawn pixels per screen pixel, along a side
  #pause = 0;

  /** `quality`: 'software' omits effects that need a graphics card. */
  constructor(connection, quality) {
    super();
    this.#connection = connection;
    this.#software = quality === 'software';
    // A canvas keeps its kind of context for life.
    this.#canvas = make('canvas', {id: 'view', tabIndex: 0, 'aria-label': byId('view').getAttribute('aria-label')});
    byId('view').replaceWith(this.#canvas);
    this.#renderer = new THREE.WebGLRenderer({canvas: this.#canvas, antialias: !this.#software, preserveDrawingBuffer: true});
    this.#renderer.shadowMap.enabled = true;
    this.#renderer.shadowMap.type = THREE.PCFShadowMap;
    this.#ratio = this.#software ? 1 : Math.min(2, devicePixelRatio);
    this.#renderer.setPixelRatio(this.#ratio);
    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, this.#canvas);
    this.#controls.zoomToCursor = true;
    this.#controls.maxPolarAngle = Math.PI * 0.495;
    this.#controls.listenToKeyEvents(this.#canvas);
    this.#controls.addEventListener('change', () => { this.#dirty = true; });
    this.#controls.addEventListener('start', () => { this.#canvas.focus({preventScroll: true}); });
    this.#sun.castShadow = true;
    this.#sun.shadow.mapSize.setScalar(this.#software ? 1024 : 2048);
    this.#sun.shadow.bias = -0.0004;
    this.#sun.shadow.normalBias = 0.02;
    this.#root.add(this.#sun, this.#sun.target, this.#sky, this.#outline);
    this.#sensors = make('canvas', {id: 'sensors', hidden: true, 'aria-hidden': 'true'});
    this.#canvas.after(this.#sensors);
    byId('rays').addEventListener('change', () => { this.#askSensors(); this.#dirty = true; });
    // A new daemon restarts the numbers of scenes.
    connection.addEventListener('open', () => { this.#stale = true; });
    connection.addEventListener('hello', () => this.#ask());
    connection.addEventListener('poses', ({detail}) => this.#onPoses(detail));
    connection.addEventListener('picture', ({detail}) => this.#onPicture(detail));
    document.addEventListener('visibilitychange', () => this.#ask());
    document.addEventListener('theme', () => this.#paint());
    new ResizeObserver(() => this.#fitCanvas()).observe(this.#frame);
    this.#listen();
    this.#paint();
    this.#fitCanvas();
    requestAnimationFrame((now) => this.#draw(now));
    byId('view-note').hidden = true;
    this.#ask();
  }
  #sensors;
  #wanted = '';  // name of a thing to select once it appears
  #askedSensors = '';
  #software;

  // --- for other parts of the page
  get scene() { return this.#scene; }
  get canvas() { return this.#canvas; }
  get camera() { return this.#camera; }
  get controls() { return this.#controls; }
  get selected() { return this.#selected; }
  get step() { return this.#reader.step; }
  get time() { return this.#reader.time; }
  get framesDrawn() { return this.#drawn; }
  redraw() { this.#dirty = true; }
  /** A button among the view's tools. */
  addTool(text, title, act) {
    const made = make('button', {type: 'button', title}, text);
    made.addEventListener('click', act);
    byId('view-tools').append(made);
    return made;
  }
  /** Draws `object` too, until it is removed from its parent. */
  add(object) { this.#root.add(object); this.#dirty = true; }

  select(thing) {
    this.#wanted = '';
    if (typeof thing === 'string') {
      const found = this.#scene?.find(thing);
      if (!found) {  // not in the scene yet
        this.#wanted = thing;
        return;
      }
      thing = found;
    }
    this.#selected = thing;
    this.#dirty = true;
    this.#outlineSelected();
    this.dispatchEvent(new CustomEvent('select', {detail: thing}));
  }

  /** The point on the floor under a point of the window; null beyond the horizon. */
  floorAt(clientX, clientY) {
    const caster = this.#casterAt(clientX, clientY);
    return caster.ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), 0), new THREE.Vector3());
  }

  /** {thing, point} under a point of the window; null if none. */
  pick(clientX, clientY) {
    if (!this.#scene) return null;
    const hit = this.#casterAt(clientX, clientY).intersectObjects(this.#scene.pickable, false)[0];
    if (!hit) return null;
    return {thing: hit.object.userData.things[hit.instanceId ?? 0], point: hit.point};
  }

  /** Looks at everything: 'top' from above, else from the side. */
  fit(from = 'side') {
    if (!this.#scene) return;
    this.#follows = null;
    frameBox(this.#scene.box(), from, this.#camera, this.#controls);
    this.#showFollow();
    this.#dirty = true;
  }

  follow(thing) {
    this.#follows = thing ?? null;
    this.#followed = null;
    this.#showFollow();
    this.#dirty = true;
  }

  /** A PNG of the view. */
  snapshot() {
    this.#render();
    return new Promise((resolve) => this.#canvas.toBlob(resolve, 'image/png'));
  }

  // --- the wire
  #ask() {
    this.#askedSensors = '';
    this.#askSensors();
    this.#connection.send({type: 'poses', rate: document.hidden ? 0 : RATE_HZ});
  }

  #onPoses(buffer) {
    if (!this.#reader.take(buffer)) return;
    if (this.#stale || this.#scene?.number !== this.#reader.scene) return this.load();
    this.#between.push(this.#reader, performance.now());
    this.#dirty = true;
  }

  /** Requests the scene. Call it after an edit to see the change before the next poses. */
  async load() {
    if (this.#loading) return;
    this.#loading = true;
    try {
      const description = await (await fetch('api/scene')).json();
      if (this.#stale || description.scene !== this.#scene?.number) this.#show(description);
    } catch {
      await new Promise((later) => { setTimeout(later, 500); });  // the banner shows that the daemon is gone
    }
    this.#loading = false;
  }

  #show(description) {
    this.#stale = false;
    const wanted = this.#wanted, selected = this.#selected?.name, followed = this.#follows?.name;
    this.#drop?.();
    // The next scene reuses its shaders: dispose of it after drawing that one.
    const last = this.#scene;
    last?.root.removeFromParent();
    this.#drop = () => { last?.dispose(); this.#drop = null; };
    this.#scene = new Scene3d(description, {onLoaded: () => { this.#dirty = true; }, plain: this.#software});
    this.#root.add(this.#scene.root);
    this.#between.reset(description.bodies);
    if (this.#reader.scene === description.scene) this.#between.push(this.#reader, performance.now());
    this.#between.write(this.#scene.bodies, performance.now());
    this.#scene.place();
    const many = description.robots.length > SHADOW_ROBOTS[this.#software ? 'software' : 'hardware'];
    this.#sun.castShadow = this.#shadows && !many;
    this.#aimSun();
    if (this.#framed !== description.scenario) {
      this.#framed = description.scenario;
      if (this.#software) this.#setRatio(1);
      const wanted = new URLSearchParams(location.search).get('view');
      this.fit(wanted === 'top' ? 'top' : 'side');
    }
    this.select(this.#scene.find(wanted) ?? this.#scene.find(selected) ?? null);
    if (this.#selected?.name !== wanted) this.#wanted = wanted;  // still not in the scene
    this.#follows = followed ? this.#scene.find(followed) ?? null : null;
    this.#showFollow();
    this.#dirty = true;
    this.dispatchEvent(new Event('scene'));
  }

  // --- sensors' rays: the daemon draws them, from the same camera, over the view
  #askSensors() {
    const shown = byId('rays').checked && !document.hidden;
    this.#sensors.hidden = !shown;
    if (!shown) {
      if (this.#askedSensors) this.#connection.send({type: 'view'});
      this.#askedSensors = '';
      return;
    }
    const scale = Math.min(1, MAX_WIDTH / this.#frame.clientWidth);
    const view = {type: 'view', rays: true, width: Math.max(64, Math.round(scale * this.#frame.clientWidth)),
      height: Math.max(48, Math.min(1080, Math.round(scale * this.#frame.clientHeight))),
      eye: this.#camera.position.toArray(), look: this.#controls.target.toArray()};
    const text = JSON.stringify(view);
    if (text === this.#askedSensors) return;
    this.#askedSensors = text;
    this.#connection.send(view);
  }

  async #onPicture({about, jpeg}) {
    if (!about.error && !this.#sensors.hidden) {
      try {
        const bitmap = await createImageBitmap(jpeg);
        Object.assign(this.#sensors, {width: bitmap.width, height: bitmap.height});
        this.#sensors.getContext('2d').drawImage(bitmap, 0, 0);
        bitmap.close();
      } catch { /* skip an unreadable picture */ }
    } else if (about.error) {
      setText(byId('view-note'), about.error);
      byId('view-note').hidden = this.#sensors.hidden;
    }
    this.#connection.send({type: 'shown'});
  }

  // --- drawing
  #paint() {
    this.#root.background = new THREE.Color(getComputedStyle(this.#frame).backgroundColor);
    this.#dirty = true;
  }

  #aimSun() {
    const box = this.#scene.box(), middle = box.getCenter(new THREE.Vector3());
    const radius = Math.max(2, box.getSize(new THREE.Vector3()).length() / 2);
    this.#sun.position.copy(middle).add(new THREE.Vector3(0.45, -0.35, 1).multiplyScalar(2 * radius));
    this.#sun.target.position.copy(middle);
    const {camera} = this.#sun.shadow;
    Object.assign(camera, {left: -radius, right: radius, top: radius, bottom: -radius, near: 0.1, far: 5 * radius});
    camera.updateProjectionMatrix();
  }

  #fitCanvas() {
    const {clientWidth: width, clientHeight: height} = this.#frame;
    if (width === 0 || height === 0) return;
    this.#renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#dirty = true;
  }

  #draw(now) {
    requestAnimationFrame((next) => this.#draw(next));
    if (document.hidden || !this.#scene) return;
    const moves = this.#between.moves(now);
    if ((!moves && !this.#dirty) || now < this.#pause) return;
    this.#between.write(this.#scene.bodies, now);
    this.#scene.place();
    this.#moveCamera();
    this.dispatchEvent(new Event('drawing'));
    this.#placeOutline();
    this.#dirty = moves;  // draw once more at rest
    this.#render();
    this.#drop?.();
    this.#askSensors();
    this.#keepPace(now);
    // After a slow drawing, leave time for the rest of the page.
    const took = Math.max(performance.now() - now, 0);
    this.#pause = took > 40 ? performance.now() + 0.5 * took : 0;
    this.#canvas.dataset.step = this.#reader.step;
    this.#canvas.dataset.shown = ++this.#drawn;
    this.dispatchEvent(new Event('drawn'));
  }

  /** Without a graphics card, draws a slow view with fewer pixels until the next scene. */
  #keepPace(now) {
    const pause = now - this.#drawnAt;
    this.#drawnAt = now;
    if (!this.#software || pause > 500) return;
    this.#interval += 0.15 * (pause - this.#interval);
    if (this.#interval < SLOW_MS || this.#ratio <= LEAST_RATIO) return;
    this.#setRatio(0.8 * this.#ratio);
  }

  #setRatio(ratio) {
    this.#ratio = ratio;
    this.#interval = 33;
    this.#renderer.setPixelRatio(ratio);
    this.#fitCanvas();
  }

  #render() { this.#renderer.render(this.#root, this.#camera); }
  renderNow() { this.#render(); }

  #moveCamera() {
    if (!this.#follows) return;
    const [p] = this.#scene.pose(this.#follows);
    if (this.#followed) {
      const way = p.clone().sub(this.#followed);
      this.#camera.position.add(way);
      this.#controls.target.add(way);
    } else {
      const away = this.#camera.position.clone().sub(this.#controls.target).setLength(Math.max(1.5, 4 * (this.#follows.model?.radius ?? 0.5)));
      this.#controls.target.copy(p);
      this.#camera.position.copy(p).add(away);
    }
    this.#followed = p;
    this.#controls.update();
  }

  #outlineSelected() {
    this.#outline.clear();
    const thing = this.#selected;
    if (!thing) return;
    const {description, model} = thing;
    const size = thing.kind === 'robot' ? [2 * model.radius, 2 * model.radius, model.height]
      : description.type === 'box' ? description.size
      : description.type === 'cylinder' ? [2 * description.size[0], 2 * description.size[0], description.size[1]]
      : description.type === 'sphere' ? Array(3).fill(2 * description.size[0]) : [0.2, 0.2, 0.2];
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(...size.map((s) => 1.02 * s + 0.01))),
      new THREE.LineBasicMaterial({color: 0x2f7bf0, depthTest: false, transparent: true}));
    if (thing.kind === 'robot') edges.position.z = model.height / 2;
    edges.renderOrder = 10;
    this.#outline.add(edges);
    this.#placeOutline();
  }

  #placeOutline() {
    if (!this.#selected || !this.#scene) return;
    const [p, q] = this.#scene.pose(this.#selected);
    this.#outline.position.copy(p);
    this.#outline.quaternion.copy(q);
  }

  // --- pointing
  #casterAt(clientX, clientY) {
    const box = this.#canvas.getBoundingClientRect();
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(2 * (clientX - box.left) / box.width - 1, 1 - 2 * (clientY - box.top) / box.height), this.#camera);
    return caster;
  }

  #listen() {
    let down = null;
    this.#canvas.addEventListener('pointerdown', (event) => { down = event.button === 0 ? [event.clientX, event.clientY] : null; });
    this.#canvas.addEventListener('pointerup', (event) => {
      const still = down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4;
      down = null;
      if (still && !this.busy) this.select(this.pick(event.clientX, event.clientY)?.thing ?? null);
    });
    this.#canvas.addEventListener('dblclick', (event) => this.follow(this.pick(event.clientX, event.clientY)?.thing));
    this.#canvas.addEventListener('keydown', (event) => {
      const does = {Home: () => this.fit(), t: () => this.fit('top'), f: () => this.follow(this.#follows ? null : this.#selected),
        Escape: () => { this.select(null); this.follow(null); }, '+': () => this.#zoom(0.9), '=': () => this.#zoom(0.9), '-': () => this.#zoom(1 / 0.9)}[event.key];
      if (!does || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      does();
    });
    byId('whole').addEventListener('click', () => this.fit());
    this.addTool('top', 'Look from above (T)', () => this.fit('top'));
    this.#followButton = this.addTool('follow', 'The camera follows the selected robot (F, or a double click on it)',
      () => this.follow(this.#follows ? null : this.#selected));
    const box = make('input', {type: 'checkbox', checked: true, id: 'show-shadows'});
    box.addEventListener('change', () => {
      this.#shadows = this.#sun.castShadow = box.checked;
      this.#dirty = true;
    });
    byId('show-list').append(make('label', {title: 'Shadows'}, box, ' shadows'));
    this.#showFollow();
  }
  #followButton;

  #showFollow() {
    if (!this.#followButton) return;
    setText(this.#followButton, this.#follows ? `following ${this.#follows.name}` : 'follow');
    this.#followButton.setAttribute('aria-pressed', String(Boolean(this.#follows)));
  }

  #zoom(factor) {
    this.#camera.position.sub(this.#controls.target).multiplyScalar(factor).add(this.#controls.target);
    this.#dirty = true;
  }
}
