// SPDX-License-Identifier: MIT
// The live view drawn by the browser: the scene from /api/scene, moved by pose messages. Left button turns, right button moves, wheel
// zooms to the pointer; one finger turns, two move and zoom. A click selects, a double click follows.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {byId, make} from './dom.js';
import {Looks} from './looks.js';
import {Interpolator, PoseReader} from './poses.js';
import {Scene3d} from './scene3d.js';
import {Stage} from './stage.js';
import {t} from './words.js';

const RATE_HZ = 30;
const FOV_DEG = THREE.MathUtils.radToDeg(0.8);  // as in the daemon's pictures
const NEAR = 0.004;      // near plane, as a share of the distance to the camera's target

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
  #stage;
  #looks;
  #root = new THREE.Scene();
  #camera = new THREE.PerspectiveCamera(FOV_DEG, 1, 0.02, 2000);
  #controls;
  #scene = null;
  #reader = new PoseReader();
  #between = new Interpolator();
  #loading = false;   // a request for the scene is pending
  #stale = false;     // after reconnecting, the same number may mean another scene
  #drop = null;       // frees the last scene
  #dirty = true;
  #framed = '';       // the scenario that the camera was set up for
  #selected = null;
  #outline = new THREE.Group();
  #told = false;      // poses came that look as what is shown
  #drawn = 0;
  #pause = 0;

  /** `quality`: 'software' omits effects that need a graphics card. */
  constructor(connection, quality) {
    super();
    this.#connection = connection;
    // A canvas keeps its kind of context for life.
    this.#canvas = make('canvas', {id: 'view', tabIndex: 0, 'aria-label': byId('view').getAttribute('aria-label')});
    byId('view').replaceWith(this.#canvas);
    this.#stage = new Stage(this.#canvas, this.#frame, quality, this.#root);
    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, this.#canvas);
    this.#controls.zoomToCursor = true;
    this.#controls.maxPolarAngle = Math.PI * 0.495;
    Object.assign(this.#controls, {enableDamping: !this.#stage.software, dampingFactor: 0.15});
    this.#controls.listenToKeyEvents(this.#canvas);
    this.#controls.addEventListener('change', () => { this.#dirty = true; });
    this.#controls.addEventListener('start', () => { this.#canvas.focus({preventScroll: true}); });
    this.#root.add(this.#outline);
    // A new daemon restarts the numbers of scenes.
    connection.addEventListener('open', () => { this.#stale = true; });
    connection.addEventListener('hello', () => this.#ask());
    connection.addEventListener('poses', ({detail}) => this.#onPoses(detail));
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
  #wanted = '';  // name of a thing to select once it appears

  // --- for other parts of the page
  get scene() { return this.#scene; }
  get canvas() { return this.#canvas; }
  get camera() { return this.#camera; }
  get controls() { return this.#controls; }
  get selected() { return this.#selected; }
  get step() { return this.#reader.step; }
  get time() { return this.#reader.time; }
  get framesDrawn() { return this.#drawn; }
  /** Whether the camera moves to a named view. */
  get flies() { return this.#looks.flies; }
  /** Makes materials for the light of a scene of /api/scene: a function (rgb, options). */
  materialsFor({lights}) { return this.#stage.materialsFor(lights); }
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

  /** Shows everything: 'top' from above, 'front', 'side', else from the first view. */
  fit(from) { this.#looks.fit(from); }
  follow(thing) { this.#looks.follow(thing); }

  /** A PNG of the view. */
  snapshot() {
    this.#render();
    return new Promise((resolve) => this.#canvas.toBlob(resolve, 'image/png'));
  }

  // --- the wire
  #ask() {
    this.#connection.send({type: 'poses', rate: document.hidden ? 0 : RATE_HZ});
  }

  #onPoses(buffer) {
    if (!this.#reader.take(buffer)) return;
    if (this.#stale || this.#scene?.number !== this.#reader.scene) return this.load();
    if (this.#between.push(this.#reader, performance.now())) this.#dirty = true;
    else this.#told = true;
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
    const wanted = this.#wanted, selected = this.#selected?.name;
    this.#drop?.();
    this.#retire(this.#scene);
    this.#scene = new Scene3d(description, {onLoaded: () => { this.#stage.changed(); this.#dirty = true; }, makeMaterial: this.materialsFor(description)});
    this.#root.add(this.#scene.root);
    this.#between.reset(description.bodies);
    if (this.#reader.scene === description.scene) this.#between.push(this.#reader, performance.now());
    this.#between.write(this.#scene.bodies, performance.now());
    this.#scene.place();
    const anew = this.#framed !== description.scenario;
    if (anew) this.#stage.startAnew();
    this.#stage.show(this.#scene, this.#scene.box());
    if (anew) {
      this.#framed = description.scenario;
      const look = new URLSearchParams(location.search).get('view');
      this.#looks.start(['top', 'front', 'side'].includes(look) ? {from: look} : description.view);
    }
    this.select(this.#scene.find(wanted) ?? this.#scene.find(selected) ?? null);
    if (this.#selected?.name !== wanted) this.#wanted = wanted;  // still not in the scene
    this.#looks.keep(this.#scene);
    this.#dirty = true;
    this.dispatchEvent(new Event('scene'));
  }

  /** Takes a scene away. The next one reuses its shaders: it is freed after drawing that one. Not a part of #show, whose other functions
   *  would keep the last scene alive as long as the new one. */
  #retire(last) {
    last?.root.removeFromParent();
    this.#drop = () => { last?.dispose(); this.#drop = null; };
  }

  // --- drawing
  #paint() {
    this.#stage.paint();
    this.#dirty = true;
  }

  #fitCanvas() {
    const {clientWidth: width, clientHeight: height} = this.#frame;
    if (width === 0 || height === 0) return;
    this.#stage.resize();
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#looks?.resized();
    this.#dirty = true;
  }

  #draw(now) {
    requestAnimationFrame((next) => this.#draw(next));
    if (document.hidden || !this.#scene) return;
    const moves = this.#between.moves(now);
    if (!moves && !this.#dirty) {
      if (this.#told) return this.#tell();
      if (this.#stage.isFineDue(now)) this.#stage.drawFine(this.#camera);
      return;
    }
    if (now < this.#pause) return;
    this.#between.write(this.#scene.bodies, now);
    const turns = this.#looks.step(performance.now());
    this.dispatchEvent(new Event('drawing'));
    this.#placeOutline();
    this.#dirty = moves || turns;  // draw once more at rest
    this.#render(now, moves);
    this.#drop?.();
    // After a slow drawing, leave time for the rest of the page.
    const took = Math.max(performance.now() - now, 0);
    this.#pause = took > 40 ? performance.now() + 0.5 * took : 0;
    this.#tell();
  }

  /** What is shown is the newest step. */
  #tell() {
    this.#told = false;
    this.#canvas.dataset.step = this.#reader.step;
    this.#canvas.dataset.shown = ++this.#drawn;
    this.dispatchEvent(new Event('drawn'));
  }

  #render(now = 0, moves = false) {
    const near = Math.max(0.01, NEAR * this.#camera.position.distanceTo(this.#controls.target));
    if (Math.abs(near / this.#camera.near - 1) > 0.2) {
      this.#camera.near = near;
      this.#camera.updateProjectionMatrix();
    }
    this.#stage.draw(this.#camera, now, moves);
  }
  renderNow() { this.#render(); }

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
      if (event.ctrlKey || event.metaKey) return;
      const does = {Escape: () => { this.select(null); this.follow(null); }, '+': () => this.#looks.zoom(0.9), '=': () => this.#looks.zoom(0.9),
        '-': () => this.#looks.zoom(1 / 0.9)}[event.key];
      does?.();
      if (does || this.#looks.onKey(event.key)) event.preventDefault();
    });
    this.#looks = new Looks(this);
    const box = make('input', {type: 'checkbox', checked: true, id: 'show-shadows'});
    box.addEventListener('change', () => {
      this.#stage.shadows = box.checked;
      this.#dirty = true;
    });
    byId('show-list').append(make('label', {title: t('Shadows')}, box, ` ${t('shadows')}`));
  }
}
