// SPDX-License-Identifier: MIT
// Optional marks in the view, each with its own box under Show: sensors, names, trails, joint axes, bearings of targets, contacts.
import * as THREE from 'three';
import {CornerCamera} from './corner_camera.js';
import {byId, make} from './dom.js';
import {shownColor} from './palette.js';
import {SensorMarks} from './sensor_marks.js';
import {t} from './words.js';

const TRAIL_POINTS = 600;
const MOST_NAMED = 200;    // things with names, robots with trails
const MOST_ASKED = 8;      // robots whose sensors are polled at once
const ASK_MS = 200;
const AXIS_M = 0.15;
const FORCE_M = 0.01;      // length of a force, per N

const robotsOf = (view) => view.scene?.things.filter(({kind}) => kind === 'robot') ?? [];

/** Line segments, set as one list of coordinates. */
class Segments {
  #view;
  #line;

  constructor(view, color) {
    this.#view = view;
    this.#line = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({color, depthTest: false, transparent: true}));
    this.#line.frustumCulled = false;
    this.#line.renderOrder = 9;
    view.add(this.#line);
  }

  get count() { return (this.#line.geometry.getAttribute('position')?.count ?? 0) / 2; }

  set(points) {
    this.#line.geometry.dispose();
    this.#line.geometry = new THREE.BufferGeometry().setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
    this.#view.redraw();
  }
}

class Names {
  #view;
  #labels = make('div', {id: 'labels', 'aria-hidden': 'true'});
  #of = new Map();

  constructor(view) {
    this.#view = view;
    view.canvas.after(this.#labels);
  }

  begin(on) {
    this.#labels.replaceChildren();
    this.#of.clear();
    for (const thing of on && this.#view.scene ? this.#view.scene.things.filter(({kind}) => kind !== 'light').slice(0, MOST_NAMED) : []) {
      const label = make('span', {}, thing.name);
      this.#labels.append(label);
      this.#of.set(thing, label);
    }
  }

  draw() {
    const {clientWidth: width, clientHeight: height} = this.#labels;
    for (const [thing, label] of this.#of) {
      const [p] = this.#view.scene.pose(thing);
      p.z += thing.model?.height ?? 0.3;
      p.project(this.#view.camera);
      label.hidden = p.z > 1 || Math.abs(p.x) > 1.1 || Math.abs(p.y) > 1.1;
      label.style.transform = `translate(-50%, -100%) translate(${((p.x + 1) * width / 2).toFixed(1)}px, ${((1 - p.y) * height / 2).toFixed(1)}px)`;
    }
  }
}

class Trails {
  #view;
  #of = new Map();

  constructor(view) { this.#view = view; }

  begin() {
    for (const {line} of this.#of.values()) {
      line.removeFromParent();
      line.geometry.dispose();
    }
    this.#of.clear();
  }

  draw() {
    for (const thing of robotsOf(this.#view).slice(0, MOST_NAMED)) {
      const trail = this.#of.get(thing) ?? this.#make(thing);
      const [p] = this.#view.scene.pose(thing);
      const last = trail.points.at(-1);
      if (last && last.distanceTo(p) < 0.01) continue;
      if (last && last.distanceTo(p) > 1) trail.points = [];  // the robot was moved
      trail.points.push(p.clone());
      if (trail.points.length > TRAIL_POINTS) trail.points.shift();
      const positions = trail.line.geometry.attributes.position;
      trail.points.forEach((point, i) => positions.setXYZ(i, point.x, point.y, 0.004));
      positions.needsUpdate = true;
      trail.line.geometry.setDrawRange(0, trail.points.length);
    }
  }

  #make(thing) {
    const geometry = new THREE.BufferGeometry().setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * TRAIL_POINTS), 3));
    const color = new THREE.Color().setRGB(...shownColor(thing.description.color), THREE.SRGBColorSpace);
    const trail = {line: new THREE.Line(geometry, new THREE.LineBasicMaterial({color, toneMapped: false})), points: []};
    trail.line.frustumCulled = false;
    this.#of.set(thing, trail);
    this.#view.add(trail.line);
    return trail;
  }
}

class JointAxes {
  #view;
  #lines;

  constructor(view) {
    this.#view = view;
    this.#lines = new Segments(view, 0xd07000);
  }

  get count() { return this.#lines.count; }
  begin(on) { if (!on) this.#lines.set([]); }

  draw() {
    const points = [];
    for (const robot of robotsOf(this.#view).slice(0, MOST_NAMED)) {
      for (const {body, position, axis} of robot.model.joints) {
        const [p, q] = this.#view.scene.poseOf(robot.body + body);
        const middle = new THREE.Vector3(...position).applyQuaternion(q).add(p);
        const way = new THREE.Vector3(...axis).applyQuaternion(q).setLength(AXIS_M / 2);
        points.push(...middle.clone().sub(way), ...middle.add(way));
      }
    }
    this.#lines.set(points);
  }
}

/** Polls the sensors of a type: of the selected robot, else of the first ones. */
class Asked {
  #view;
  #connection;
  #type;
  #command;
  #timer = 0;
  #on = false;
  #robots = [];  // in the last status: {name, modules}
  #asked = new Set();  // modules to which this page has a connection
  #lines;
  #linesOf;

  /** `linesOf(robot, data)` returns the coordinates of segments in the robot's frame. */
  constructor(view, connection, {type, command, color, linesOf}) {
    this.#view = view;
    this.#connection = connection;
    this.#type = type;
    this.#command = command;
    this.#linesOf = linesOf;
    this.#lines = new Segments(view, color);
    connection.addEventListener('status', ({detail}) => { this.#robots = detail?.robots ?? []; });
  }

  get count() { return this.#lines.count; }
  draw() {}

  begin(on) {
    if (on === this.#on) return;
    this.#on = on;
    if (on) return void this.#ask();
    clearTimeout(this.#timer);
    this.#lines.set([]);
    for (const module of this.#asked) this.#connection.send({type: 'close', module, channel: 'marks'});
    this.#asked.clear();
  }

  async #ask() {
    const chosen = this.#view.selected?.kind === 'robot' ? [this.#view.selected] : robotsOf(this.#view).slice(0, MOST_ASKED);
    const points = [];
    await Promise.all(chosen.map(async (robot) => {
      const modules = this.#robots.find(({name}) => name === robot.name)?.modules ?? [];
      for (const {name: module} of modules.filter(({type}) => type === this.#type)) {
        this.#asked.add(module);
        const reply = await this.#connection.call({module, channel: 'marks', command: this.#command});
        if (reply.error !== 0 || !this.#view.scene?.things.includes(robot)) continue;
        const [p, q] = this.#view.scene.pose(robot);
        for (const point of this.#linesOf(robot, reply.data)) points.push(...point.applyQuaternion(q).add(p));
      }
    }));
    if (!this.#on) return;
    this.#lines.set(points);
    this.#timer = setTimeout(() => this.#ask(), ASK_MS);
  }
}

/** Lines from the robot to each target that it sees. */
function bearingLines(robot, data) {
  const lines = [], height = 0.8 * (robot.model?.height ?? 0.2);
  for (let i = 0; i + 1 < data.length - 2; i += 2) {
    if (!Number.isFinite(data[i]) || !Number.isFinite(data[i + 1])) continue;
    lines.push(new THREE.Vector3(0, 0, height), new THREE.Vector3(data[i] * Math.cos(data[i + 1]), data[i] * Math.sin(data[i + 1]), height));
  }
  return lines;
}

/** For each contact, a line along its force, and a cross. */
function contactLines(robot, data) {
  const lines = [];
  for (let i = 0; i + 6 < data.length - 2 + 1; i += 7) {
    const [force, x, y, z, nx, ny, nz] = data.slice(i, i + 7);
    if (![force, x, y, z, nx, ny, nz].every(Number.isFinite)) continue;
    const point = new THREE.Vector3(x, y, z);
    lines.push(point, point.clone().addScaledVector(new THREE.Vector3(nx, ny, nz), Math.max(0.05, FORCE_M * force)));
    for (const side of [new THREE.Vector3(0.02, 0, 0), new THREE.Vector3(0, 0.02, 0), new THREE.Vector3(0, 0, 0.02)]) {
      lines.push(point.clone().sub(side), point.clone().add(side));
    }
  }
  return lines;
}

/** Adds the boxes to Show. */
export class ViewMarks {
  of = {};
  #on = {};

  constructor(view, connection) {
    this.of = {
      sensors: new SensorMarks(view, connection), names: new Names(view), trails: new Trails(view), axes: new JointAxes(view),
      bearings: new Asked(view, connection, {type: 'target', command: 'get_targets', color: 0xb23fb5, linesOf: bearingLines}),
      contacts: new Asked(view, connection, {type: 'contact', command: 'get_contacts', color: 0xd0342c, linesOf: contactLines}),
      camera: new CornerCamera(view, connection),
    };
    const titles = {names: [t('names'), t('Names of robots and things')], trails: [t('trails'), t('Where robots have been')],
      axes: [t('joint axes'), t('The axes of all joints')], bearings: [t('target bearings'), t('Lines to the targets that robots see: of the selected robot, or the first ones')],
      contacts: [t('contacts'), t('Contacts at contact sensors and their forces: of the selected robot, or the first ones')],
      camera: [t('camera'), t('What the camera of the selected robot sees, or of the first that has one, in the corner')]};
    const listen = (key, box) => {
      const change = () => {
        this.#on[key] = box.checked;
        this.of[key].begin(box.checked);
        view.redraw();
      };
      box.addEventListener('change', change);
      if (box.checked) change();  // before this was loaded
    };
    listen('sensors', byId('rays'));
    for (const [key, [text, title]] of Object.entries(titles)) {
      const box = make('input', {type: 'checkbox', id: `show-${key}`});
      listen(key, box);
      byId('show-list').append(make('label', {title}, box, ` ${text}`));
    }
    const each = (act) => { for (const key of Object.keys(this.of)) if (this.#on[key]) act(this.of[key]); };
    view.addEventListener('scene', () => each((mark) => mark.begin(true)));
    view.addEventListener('drawing', () => each((mark) => mark.draw()));
  }
}
