// SPDX-License-Identifier: MIT
// The world as three.js objects: built from /api/scene, moved by poses. Robots of one model are instances of the same
// shapes, so that thousands cost little.
import * as THREE from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';

const ROUND = 32;  // segments of round shapes
const ROUND_OF_MANY = [[20, 24], [100, 16], [Infinity, 8]];  // [maximum robots of a kind, segments of their round shapes]

const CROWD = 100;  // robots

const color = (rgb) => new THREE.Color().setRGB(rgb[0], rgb[1], rgb[2], THREE.SRGBColorSpace);
const vector = (xyz) => new THREE.Vector3(xyz[0], xyz[1], xyz[2]);
const turn = (xyzw) => new THREE.Quaternion(xyzw[0], xyzw[1], xyzw[2], xyzw[3]);
const UP = new THREE.Matrix4().makeRotationX(Math.PI / 2);  // three.js's cylinders are along y, ours along z

function geometryOf(shape, round) {
  const [a, b] = shape.size ?? [];
  switch (shape.type) {
    case 'box': return new THREE.BoxGeometry(...shape.size);
    case 'cylinder': return new THREE.CylinderGeometry(a, a, b, round).applyMatrix4(UP);
    case 'sphere': return new THREE.SphereGeometry(a, round, round / 2);
    case 'capsule': return new THREE.CapsuleGeometry(a, b, Math.ceil(round / 4), round).applyMatrix4(UP);
    default: return null;
  }
}

/** The world of one scene. `bodies`: a position and a quaternion for each body, applied by `place`. */
export class Scene3d {
  root = new THREE.Group();
  things = [];    // {kind, name, id, description, object?, body}
  pickable = [];  // meshes; userData.things: the things by instance
  #instances = [];  // {mesh, first, count, X_BG, ofBody}
  #moving = [];   // {object, body}
  #loader = new GLTFLoader();
  #geometries = new Map();
  #disposed = false;
  #plain;

  /** `plain`: draw only the large parts of large crowds. */
  constructor(scene, {onLoaded, plain = false}) {
    this.#plain = plain;
    this.number = scene.scene;
    this.description = scene;
    this.bodies = new Float32Array(7 * scene.bodies);
    this.#addFloor(scene.floor);
    for (const thing of scene.things) this.#addThing(thing);
    scene.models.forEach((model, index) => {
      this.#addRobots(model, scene.robots.filter((robot) => robot.model === index), onLoaded);
    });
    for (const target of scene.targets) this.#addTarget(target);
    for (const light of scene.lights) this.#addLight(light);
    this.things.forEach((thing) => { if (thing.object) thing.object.userData.thing = thing; });
  }

  dispose() {
    this.#disposed = true;
    this.root.traverse((object) => {
      object.geometry?.dispose();
      for (const material of [object.material].flat()) { material?.map?.dispose(); material?.dispose(); }
      object.dispose?.();
    });
    this.root.removeFromParent();
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
    const X = new THREE.Matrix4(), p = new THREE.Vector3(), q = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1);
    for (const {mesh, bodies, X_BG} of this.#instances) {
      for (let i = 0; i < bodies.length; ++i) {
        const at = 7 * bodies[i];
        p.set(b[at], b[at + 1], b[at + 2]);
        q.set(b[at + 3], b[at + 4], b[at + 5], b[at + 6]);
        X.compose(p, q, one).multiply(X_BG);
        mesh.setMatrixAt(i, X);
      }
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingSphere = null;
    }
  }

  box() {
    const box = new THREE.Box3();
    for (const thing of this.things) {
      if (thing.kind === 'light') continue;
      const [p, q] = this.pose(thing), {size = [0.1], type} = thing.description, radius = thing.model?.radius ?? 0;
      const half = (radius > 0 ? [2 * radius, 2 * radius, 2 * thing.model.height] : type === 'box' ? size
        : type === 'cylinder' ? [2 * size[0], 2 * size[0], size[1]] : Array(3).fill(2 * size[0])).map((side) => side / 2);
      for (let corner = 0; corner < 8; ++corner) {
        const at = new THREE.Vector3(...half.map((side, axis) => (corner >> axis & 1 ? side : -side)));
        box.expandByPoint(at.applyQuaternion(q).add(p));
      }
    }
    const [length, width] = this.description.floor.size;
    if (box.isEmpty()) box.set(new THREE.Vector3(-length / 4, -width / 4, 0), new THREE.Vector3(length / 4, width / 4, 0.5));
    return box;
  }

  #material(rgb, texture, size) {
    const material = new THREE.MeshLambertMaterial({color: color(rgb)});
    if (texture) this.#texture(material, texture, size);
    return material;
  }

  #texture(material, texture, [width, height]) {
    new THREE.TextureLoader().load(`api/texture/${encodeURIComponent(texture.name)}`, (map) => {
      if (this.#disposed) return map.dispose();
      map.colorSpace = THREE.SRGBColorSpace;
      map.wrapS = map.wrapT = THREE.RepeatWrapping;
      map.repeat.set(width / texture.size[0], height / texture.size[1]);
      map.anisotropy = 8;
      material.map = map;
      material.color.set(0xffffff);
      material.needsUpdate = true;
    });
  }

  #addFloor({size: [length, width, height], color: rgb, texture}) {
    const floor = new THREE.Mesh(new THREE.BoxGeometry(length, width, height), this.#material(rgb, texture, [length, width]));
    floor.position.z = -height / 2 - 0.0005;
    floor.receiveShadow = true;
    floor.userData.floor = true;
    this.floor = floor;
    this.root.add(floor);
    const step = Math.max(1, Math.ceil(Math.max(length, width) / 60));
    const points = [];
    for (let x = Math.ceil(-length / 2); x <= length / 2; x += step) points.push(x, -width / 2, 0, x, width / 2, 0);
    for (let y = Math.ceil(-width / 2); y <= width / 2; y += step) points.push(-length / 2, y, 0, length / 2, y, 0);
    const lines = new THREE.BufferGeometry().setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
    const grid = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({color: 0x000000, transparent: true, opacity: 0.09}));
    grid.position.z = 0.001;
    if (!texture) this.root.add(grid);
  }

  #addThing(description) {
    const geometry = geometryOf(description, ROUND);
    const material = this.#material(description.color, description.texture, [description.size[0], description.size[2] ?? 1]);
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
    this.pickable.push(object);
    this.root.add(object);
  }

  #addRobots(model, robots, onLoaded) {
    const round = robots.length < 3 ? ROUND : ROUND_OF_MANY.find(([most]) => robots.length <= most)[1];
    const things = robots.map((description) => {
      const thing = {kind: 'robot', name: description.name, id: description.id, description, model, body: description.body};
      this.things.push(thing);
      return thing;
    });
    const extent = (shape) => Math.max(...(shape.size ?? [model.radius]));
    const least = this.#plain && robots.length > CROWD ? 0.5 * Math.max(...model.shapes.map(extent)) : 0;
    for (const shape of model.shapes.filter((one) => extent(one) >= least)) {
      const put = (geometry, vertexColors) => {
        const material = new THREE.MeshLambertMaterial({color: vertexColors || !shape.color ? 0xffffff : color(shape.color), vertexColors});
        const mesh = new THREE.InstancedMesh(geometry, material, robots.length);
        if (!shape.color && !vertexColors) robots.forEach((robot, i) => mesh.setColorAt(i, color(robot.color)));
        mesh.castShadow = mesh.receiveShadow = true;
        mesh.frustumCulled = false;
        mesh.userData.things = things;
        const X_BG = new THREE.Matrix4().compose(vector(shape.position), turn(shape.quaternion), new THREE.Vector3(1, 1, 1));
        this.#instances.push({mesh, bodies: robots.map((robot) => robot.body + shape.body), X_BG});
        this.pickable.push(mesh);
        this.root.add(mesh);
      };
      const geometry = geometryOf(shape, round);
      if (geometry) {
        put(geometry, false);
      } else {
        this.#mesh(shape.mesh).then((loaded) => {
          if (this.#disposed || !loaded) return;
          put(loaded, loaded.hasAttribute('color'));
          this.place();
          onLoaded();
        });
      }
    }
  }

  #mesh(name) {
    if (!this.#geometries.has(name)) {
      this.#geometries.set(name, this.#loader.loadAsync(`api/mesh/${name}.glb`).then((gltf) => {
        let found = null;
        gltf.scene.traverse((object) => { found ??= object.geometry; });
        // Flat faces: shared vertices would give smoothed ones.
        const flat = found.toNonIndexed();
        flat.computeVertexNormals();
        return flat;
      }, () => null));
    }
    return this.#geometries.get(name);
  }

  #addTarget(description) {
    const object = new THREE.Mesh(new THREE.SphereGeometry(0.1, ROUND, ROUND / 2),
      new THREE.MeshLambertMaterial({color: color(description.color), emissive: color(description.color), emissiveIntensity: 0.35}));
    object.position.copy(vector(description.position));
    const thing = {kind: 'target', name: description.name, id: description.id, description, object, body: -1};
    object.userData.things = [thing];
    this.#add(thing, object);
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
