// SPDX-License-Identifier: MIT
// The world as three.js objects: built from /api/scene, moved by poses. Robots of one model are instances of the same
// shapes, so that thousands cost little.
import * as THREE from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {ContactShadows} from './contact_shadows.js';
import {FloorMesh} from './floor.js';
import {RobotMeshes, color} from './robot_meshes.js';
import {geometryOf} from './shapes.js';

const ROUND = 32;  // segments of round shapes
const CROWD = 60;  // robots
const BEVEL_M = {thing: 0.02, flag: 0.006};
const LEAST_SEEN_M = 3;  // shows some floor around a single small thing
const FLAG = {pole: 0.012, ball: 0.03, foot: 0.09, ring: 0.22, height: 0.55, cloth: [0.30, 0.19]};

const vector = (xyz) => new THREE.Vector3(xyz[0], xyz[1], xyz[2]);
const turn = (xyzw) => new THREE.Quaternion(xyzw[0], xyzw[1], xyzw[2], xyzw[3]);

/** Half the sides of a shape's bounding box in its own frame; null for a mesh. */
function halfOf({type, size = []}) {
  const [a, b] = size;
  switch (type) {
    case 'box': return size.map((side) => side / 2);
    case 'cylinder': return [a, a, b / 2];
    case 'sphere': return [a, a, a];
    case 'capsule': return [a, a, b / 2 + a];
    default: return null;
  }
}

/** The corners of a box about `middle`, moved by `p` and `q`. */
function cornersOf(half, middle, p, q) {
  return Array.from({length: 8}, (_, corner) => new THREE.Vector3(...half.map((side, axis) => (corner >> axis & 1 ? side : -side)))
    .add(middle).applyQuaternion(q).add(p));
}

/** The bounding box of the shapes of each body of a model, in its frame, by body. */
function boxesOf(model) {
  const boxes = new Map();
  for (const shape of model.shapes) {
    const half = halfOf(shape) ?? Array(3).fill(0.5 * model.radius);
    const box = boxes.get(shape.body) ?? boxes.set(shape.body, new THREE.Box3()).get(shape.body);
    for (const corner of cornersOf(half, new THREE.Vector3(), vector(shape.position), turn(shape.quaternion))) box.expandByPoint(corner);
  }
  return boxes;
}

/** The world of one scene. `bodies`: a position and a quaternion for each body, applied by `place`. */
export class Scene3d {
  root = new THREE.Group();
  things = [];    // {kind, name, id, description, object?, body}
  #robots = [];     // RobotMeshes, by model
  #X_WB = [];       // by body
  #pickable = [];   // but robots
  #moving = [];   // {object, body}
  #loader = new GLTFLoader();
  #meshes = new Map();  // promises of parts, by name
  #disposed = false;
  #makeMaterial;
  #floor;
  #contacts;
  #pixels = null;  // see lookFrom()

  /** `makeMaterial(rgb, options)`: materials for the light of the view. */
  constructor(scene, {onLoaded, makeMaterial}) {
    this.#makeMaterial = (rgb, options) => makeMaterial(color(rgb), options);
    this.number = scene.scene;
    this.description = scene;
    this.bodies = new Float32Array(7 * scene.bodies);
    this.#floor = new FloorMesh(scene.floor, this.#makeMaterial);
    this.floor = this.#floor.root;
    this.root.add(this.floor);
    if (scene.floor.texture) this.#texture(this.#floor.top.material, scene.floor.texture, scene.floor.size);
    for (const thing of scene.things) this.#addThing(thing);
    scene.models.forEach((model, index) => {
      this.#addRobots(model, scene.robots.filter((robot) => robot.model === index), onLoaded);
    });
    for (const target of scene.targets) this.#addTarget(target);
    for (const light of scene.lights) this.#addLight(light);
    this.#contacts = new ContactShadows(this.#spots());
    this.contacts = this.#contacts.mesh;
    this.root.add(this.contacts);
    this.things.forEach((thing) => { if (thing.object) thing.object.userData.thing = thing; });
  }

  /** Meshes; userData.things: the things by instance. */
  get pickable() { return [...this.#pickable, ...this.#robots.flatMap(({meshes}) => meshes.filter(({visible}) => visible))]; }

  dispose() {
    this.#disposed = true;
    this.root.traverse((object) => {
      object.geometry?.dispose();
      for (const material of [object.material].flat()) { material?.map?.dispose(); material?.dispose(); }
      object.dispose?.();
    });
    this.root.removeFromParent();
  }

  /** Colours what depends on the theme. */
  paint(dark) { this.#floor.paint(dark); }

  /** From the next place() on, robots are as detailed as `camera` sees them in a picture of this height. */
  lookFrom(camera, height_px) {
    const eye = camera.position, at_1m = height_px / (2 * Math.tan(THREE.MathUtils.degToRad(camera.fov) / 2));
    this.#pixels = (p_W) => at_1m / p_W.distanceTo(eye);
  }

  find(name) { return this.things.find((thing) => thing.name === name); }

  /** Whether a thing's outline, seen from above, is within `radius` of a point on the floor. */
  isTaken(x, y, radius) {
    return this.things.some((thing) => {
      if (!['thing', 'robot'].includes(thing.kind)) return false;
      const [p, q] = this.pose(thing), {type, size} = thing.description;
      const at = new THREE.Vector3(x - p.x, y - p.y, 0).applyQuaternion(q.invert());
      const half = thing.kind === 'robot' ? [thing.model.radius, thing.model.radius] : type === 'box' ? [size[0] / 2, size[1] / 2] : [size[0], size[0]];
      return Math.hypot(Math.max(0, Math.abs(at.x) - half[0]), Math.max(0, Math.abs(at.y) - half[1])) < radius;
    });
  }

  /** The pose of body `body`: [position, quaternion]. */
  poseOf(body) {
    const at = 7 * body;
    return [new THREE.Vector3(...this.bodies.subarray(at, at + 3)), new THREE.Quaternion(...this.bodies.subarray(at + 3, at + 7))];
  }

  /** The pose of a thing's own frame; of a robot, its frame R. */
  pose(thing) {
    if (thing.body < 0) return [vector(thing.description.position), turn(thing.description.quaternion ?? [0, 0, 0, 1])];
    const [p, q] = this.poseOf(thing.body);
    if (thing.kind !== 'robot') return [p, q];
    return [vector(thing.description.origin).applyQuaternion(q).add(p), q.multiply(turn(thing.description.turn))];
  }

  /** Moves everything to `bodies`. */
  place() {
    const b = this.bodies;
    for (const {object, body} of this.#moving) {
      const at = 7 * body;
      object.position.set(b[at], b[at + 1], b[at + 2]);
      object.quaternion.set(b[at + 3], b[at + 4], b[at + 5], b[at + 6]);
    }
    const p = new THREE.Vector3(), q = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1);
    for (let body = 0, at = 0; at < b.length; ++body, at += 7) {
      p.set(b[at], b[at + 1], b[at + 2]);
      q.set(b[at + 3], b[at + 4], b[at + 5], b[at + 6]);
      (this.#X_WB[body] ??= new THREE.Matrix4()).compose(p, q, one);
    }
    for (const robots of this.#robots) robots.place(this.#X_WB, this.#pixels);
    this.#contacts.place(b, this.#pixels);
  }

  /** Points that enclose everything but lamps, and some floor. */
  outline() {
    const points = [], some = this.description.robots.length <= CROWD;
    for (const thing of this.things) {
      if (thing.kind === 'light') continue;
      const [p, q] = this.pose(thing);
      if (thing.kind === 'thing') points.push(...cornersOf(halfOf(thing.description), new THREE.Vector3(), p, q));
      if (thing.kind === 'target') points.push(...cornersOf([FLAG.ring, FLAG.ring, 0], new THREE.Vector3(), p.clone().setZ(0), q), this.#topOf(thing.description));
      if (thing.kind !== 'robot') continue;
      const {radius, height} = thing.model;
      if (!some) points.push(...cornersOf([radius, radius, height / 2], new THREE.Vector3(0, 0, height / 2), p, q));
      for (const [body, box] of some ? thing.model.boxes : []) {
        const half = box.getSize(new THREE.Vector3()).multiplyScalar(0.5).toArray();
        points.push(...cornersOf(half, box.getCenter(new THREE.Vector3()), ...this.poseOf(thing.body + body)));
      }
    }
    const [length, width] = this.description.floor.size, box = new THREE.Box3().setFromPoints(points);
    if (points.length === 0) box.set(new THREE.Vector3(-length / 4, -width / 4, 0), new THREE.Vector3(length / 4, width / 4, 0.5));
    const middle = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3());
    const half = [Math.max(LEAST_SEEN_M, size.x) / 2, Math.max(LEAST_SEEN_M, size.y) / 2, 0];
    return [...points, ...cornersOf(half, middle.setZ(0), new THREE.Vector3(), new THREE.Quaternion())];
  }

  box() { return new THREE.Box3().setFromPoints(this.outline()); }

  #topOf({position: [x, y, z]}) { return new THREE.Vector3(x, y, Math.max(z, FLAG.height)); }

  /** Where contact shadows are: under things, targets and the bodies of robots; of crowds, one for each robot. */
  #spots() {
    const spots = [];
    for (const {kind, description, body, model} of this.things) {
      const X = [vector(description.position ?? [0, 0, 0]), turn(description.quaternion ?? [0, 0, 0, 1])], none = [0, 0, 0];
      if (kind === 'target') spots.push({X: [X[0].setZ(0), X[1]], body, half: [FLAG.foot, FLAG.foot], round: FLAG.foot, low: 0, middle: none});
      if (kind === 'thing') {
        const half = halfOf(description), ball = description.type === 'sphere', side = ball ? 0.5 : 1;
        spots.push({X, body, half: [side * half[0], side * half[1]], round: description.type === 'box' ? 0 : side * half[0], low: -half[2], middle: none});
      }
      if (kind !== 'robot') continue;
      if (this.description.robots.length > CROWD) {
        spots.push({body, half: [model.radius, model.radius], round: model.radius, low: -description.origin[2], middle: description.origin.map((x) => -x)});
        continue;
      }
      for (const [of, box] of model.boxes) {
        const [x, y, z] = box.getSize(new THREE.Vector3()).multiplyScalar(0.5).toArray();
        spots.push({body: body + of, half: [x, y], round: Math.min(x, y), low: -z, middle: box.getCenter(new THREE.Vector3()).toArray()});
      }
    }
    return spots;
  }

  #texture(material, texture, [width, height]) {
    new THREE.TextureLoader().load(`api/texture/${encodeURIComponent(texture.name)}`, (map) => {
      if (this.#disposed) return map.dispose();
      if (!material.isPlain) map.colorSpace = THREE.SRGBColorSpace;
      map.wrapS = map.wrapT = THREE.RepeatWrapping;
      map.repeat.set(width / texture.size[0], height / texture.size[1]);
      map.anisotropy = 8;
      material.map = map;
      material.color.set(0xffffff);
      material.needsUpdate = true;
    });
  }

  #addThing(description) {
    const {type, size, texture} = description, clad = texture && type === 'box';  // bevelled boxes have no place for pictures
    const geometry = clad ? new THREE.BoxGeometry(...size) : geometryOf(description, ROUND, BEVEL_M.thing);
    const material = this.#makeMaterial(description.color, {roughness: 0.6});
    if (texture) this.#texture(material, texture, [size[0], size[2] ?? 1]);
    const object = new THREE.Mesh(geometry, material);
    object.castShadow = object.receiveShadow = true;
    object.position.copy(vector(description.position));
    object.quaternion.copy(turn(description.quaternion));
    const thing = {kind: 'thing', name: description.name, id: description.id, description, object, body: description.body};
    if (description.body >= 0) this.#moving.push({object, body: description.body});
    object.userData.things = [thing];
    this.#add(thing, object);
  }

  #add(thing, object) {
    this.things.push(thing);
    this.#pickable.push(object);
    this.root.add(object);
  }

  #addRobots(model, robots, onLoaded) {
    const things = robots.map((description) => {
      const thing = {kind: 'robot', name: description.name, id: description.id, description, model, body: description.body};
      this.things.push(thing);
      return thing;
    });
    model.boxes = boxesOf(model);
    const meshes = new RobotMeshes(this.root, model, things, {makeMaterial: this.#makeMaterial, meshOf: (name) => this.#mesh(name), onLoaded: () => {
      this.place();
      onLoaded();
    }});
    this.#robots.push(meshes);
  }

  /** The parts of a mesh: [{geometry, map, color}]; null if it did not come. A part's `map` is a picture's texture, or null. */
  #mesh(name) {
    if (!this.#meshes.has(name)) {
      this.#meshes.set(name, this.#loader.loadAsync(`api/mesh/${name}.glb`).then(async (gltf) => {
        const parts = [];
        gltf.scene.traverse(({geometry, material}) => {
          if (!geometry) return;
          // Flat faces: shared vertices would give smoothed ones.
          const flat = geometry.toNonIndexed(), {texture} = material.userData;
          flat.computeVertexNormals();
          parts.push((texture ? this.#picture(texture) : Promise.resolve(null)).then((map) => ({geometry: flat, map, color: material.color})));
        });
        const all = await Promise.all(parts);
        return this.#disposed ? null : all;
      }, () => null));
    }
    return this.#meshes.get(name);
  }

  /** The texture of a mesh; null if it did not come. */
  #picture(name) {
    return new THREE.TextureLoader().loadAsync(`api/texture/${encodeURIComponent(name)}`).then((map) => {
      map.flipY = false;  // as glTF has it
      map.wrapS = map.wrapT = THREE.RepeatWrapping;
      map.anisotropy = 8;
      return map;
    }, () => null);
  }

  /** A flag on a pole, with a ring on the floor; the ball is at the target, or above it where that is low. */
  #addTarget(description) {
    const object = new THREE.Group(), {x, y, z} = this.#topOf(description);
    const thing = {kind: 'target', name: description.name, id: description.id, description, object, body: -1};
    const base = z - description.position[2];  // of the top, over the target
    const add = (geometry, material, height) => {
      const mesh = new THREE.Mesh(geometry, material);
      mesh.position.z = base + height;
      mesh.castShadow = true;
      mesh.userData.things = [thing];
      object.add(mesh);
      this.#pickable.push(mesh);
      return mesh;
    };
    const own = this.#makeMaterial(description.color, {roughness: 0.6, side: THREE.DoubleSide, emissive: color(description.color), emissiveIntensity: 0.3}), metal = this.#makeMaterial([0.75, 0.76, 0.78], {roughness: 0.35, metalness: 0.6});
    const cylinder = (radius, length) => geometryOf({type: 'cylinder', size: [radius, length]}, ROUND, BEVEL_M.flag);
    add(cylinder(FLAG.pole, z), metal, -z / 2);
    add(cylinder(FLAG.foot, 0.02), own, 0.01 - z);
    add(new THREE.SphereGeometry(FLAG.ball, ROUND, ROUND / 2), own, 0);
    const cloth = new THREE.PlaneGeometry(...FLAG.cloth, 12, 1), at = cloth.attributes.position;
    for (let i = 0; i < at.count; ++i) {  // it waves, and narrows to its end
      const along = (at.getX(i) + FLAG.cloth[0] / 2) / FLAG.cloth[0];
      at.setXYZ(i, FLAG.pole + along * FLAG.cloth[0], 0.035 * along * Math.sin(6 * along), at.getY(i) * (1 - 0.35 * along));
    }
    cloth.computeVertexNormals();
    add(cloth, own, -FLAG.ball - FLAG.cloth[1] / 2).rotation.z = -0.5;  // seen well from the first view
    const ring = add(new THREE.RingGeometry(0.8 * FLAG.ring, FLAG.ring, 48),
      this.#makeMaterial(description.color, {transparent: true, opacity: 0.8, polygonOffset: true, polygonOffsetFactor: -3, polygonOffsetUnits: -3}), 0.003 - z);
    ring.castShadow = false;
    object.position.set(x, y, description.position[2]);
    this.things.push(thing);
    this.root.add(object);
  }

  #addLight(description) {
    const lamp = new THREE.PointLight(color(description.color), 4 * description.power, 0, 2);
    lamp.position.copy(vector(description.position));
    const bulb = new THREE.Mesh(new THREE.SphereGeometry(0.05, 16, 8), new THREE.MeshBasicMaterial({color: color(description.color)}));
    bulb.position.copy(lamp.position);
    this.root.add(lamp);
    const thing = {kind: 'light', name: description.name, id: description.id, description, object: bulb, body: -1};
    bulb.userData.things = [thing];
    this.#add(thing, bulb);
  }
}
