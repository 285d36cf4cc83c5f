// SPDX-License-Identifier: MIT
// The robots of one model: equal shapes are instances of one mesh, so that thousands cost little. Without a graphics card, robots that are
// small in the picture have fewer triangles, and tiny ones are a cylinder each.
import * as THREE from 'three';
import {shownColor} from './palette.js';
import {geometryOf} from './shapes.js';

const ROUND = 32;  // segments of round shapes
const ROUND_OF_MANY = [[2, ROUND], [20, 24], [100, 16], [Infinity, 8]];  // [maximum robots of a kind, segments of their round shapes]
const FEW = 20;        // robots, of which also the small parts are drawn from afar
const FAR = {round: 10, roundOfMany: 8, below_px: 70};
const TINY = {round: 6, below_px: 11};
const BEVEL_M = 0.006;
const GREY = 0.08;     // of a robot's parts: the largest difference of red, green and blue of bare metal

export const color = (rgb) => new THREE.Color().setRGB(...shownColor(rgb), THREE.SRGBColorSpace);
const matrix = ([x, y, z], [a, b, c, d]) => new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), new THREE.Quaternion(a, b, c, d), new THREE.Vector3(1, 1, 1));

/** How the surface of a robot's part shines, judged by its colour: rubber is black, metal grey. */
function surfaceOf(rgb) {
  if (!rgb) return {roughness: 0.42};
  const most = Math.max(...rgb), grey = most - Math.min(...rgb) < GREY;
  if (!grey) return {roughness: 0.42};
  return most < 0.2 ? {roughness: 0.75} : most < 0.9 ? {roughness: 0.38, metalness: 0.55} : {roughness: 0.5};
}

export class RobotMeshes {
  meshes = [];       // userData.things: the robots by instance
  #model;
  #things;
  #root;
  #makeMaterial;
  #levels = [];      // from near to tiny: {below_px, parts: [{mesh, shapes: [{body, X_BG}], painted}], robots: those shown so}
  #chosen = null;    // by robot: its level

  /** Adds meshes to `root`. `things`: robots of `model`, as in a scene. `meshOf(name)` resolves to parts {geometry, map, color}, or null; `onLoaded` is called after each. */
  constructor(root, model, things, {makeMaterial, meshOf, onLoaded}) {
    this.#root = root;
    this.#model = model;
    this.#things = things;
    this.#makeMaterial = makeMaterial;
    const few = things.length <= FEW, extent = ({size}) => Math.max(...(size ?? [model.radius]));
    const most = Math.max(...model.shapes.map(extent));
    this.#add(Infinity, model.shapes, ROUND_OF_MANY.find(([count]) => things.length <= count)[1], meshOf, onLoaded);
    this.#add(FAR.below_px, few ? model.shapes : model.shapes.filter((shape) => extent(shape) >= 0.5 * most), few ? FAR.round : FAR.roundOfMany, meshOf, onLoaded);
    if (model.height < 4 * model.radius) this.#add(TINY.below_px, [this.#tiny()], TINY.round, meshOf, onLoaded);
  }

  /** All of a robot as one shape. */
  #tiny() {
    const {origin, turn} = this.#things[0].description, {radius, height, shapes} = this.#model;
    const R = matrix(origin, turn).multiply(new THREE.Matrix4().makeTranslation(0, 0, height / 2));
    const position = new THREE.Vector3(), quaternion = new THREE.Quaternion();
    R.decompose(position, quaternion, new THREE.Vector3());
    const own = shapes.some(({color: one}) => !one) ? null : shapes[0].color;
    return {body: 0, position: position.toArray(), quaternion: quaternion.toArray(), color: own, type: 'cylinder', size: [0.85 * radius, height], open: true};
  }

  #add(below_px, shapes, round, meshOf, onLoaded) {
    const level = {below_px, parts: [], robots: []};
    this.#levels.push(level);
    const equal = Map.groupBy(shapes, ({type, size, mesh, skin, color: own}) => JSON.stringify([type, size, mesh, skin, own]));
    for (const group of equal.values()) {
      const geometry = geometryOf(group[0], round, BEVEL_M);
      if (geometry) {
        this.#addPart(level, group, geometry);
        continue;
      }
      meshOf(group[0].mesh).then((loaded) => {
        if (!loaded) return;
        for (const part of loaded) this.#addPart(level, group, part.geometry, group[0].skin ? part : {});
        onLoaded();
      });
    }
  }

  /** `skin`: of a mesh's part that is drawn in its own colours: {map, color}. */
  #addPart(level, shapes, geometry, {map = null, color: tint = null} = {}) {
    const [{color: own}] = shapes, vertexColors = Boolean(tint) && !map && geometry.hasAttribute('color');
    const painted = !own && !tint;
    const material = this.#makeMaterial(own ?? [1, 1, 1], {...surfaceOf(own), vertexColors, ...(map ? {map} : {})});
    if (map || vertexColors || painted) material.color.set(0xffffff);
    if (map) {
      material.color.copy(tint);
      if (!material.isPlain) map.colorSpace = THREE.SRGBColorSpace;
    }
    const mesh = new THREE.InstancedMesh(geometry, material, this.#things.length * shapes.length);
    if (painted) mesh.setColorAt(0, color([1, 1, 1]));
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = mesh.visible = false;
    mesh.count = 0;
    mesh.userData.things = [];
    level.parts.push({mesh, painted, shapes: shapes.map(({body, position, quaternion}) => ({body, X_BG: matrix(position, quaternion)}))});
    this.#chosen = null;
    this.meshes.push(mesh);
    this.#root.add(mesh);
  }

  /** Moves the robots. `X_WB`: by body; `pixels`: how many a metre at a point has in the picture; null: all are near. */
  place(X_WB, pixels) {
    const at = new THREE.Vector3(), size_m = 2 * this.#model.radius;
    const chosen = this.#things.map(({body}) => {
      if (!pixels) return 0;
      const size_px = size_m * pixels(at.setFromMatrixPosition(X_WB[body]));
      return this.#levels.findLastIndex(({below_px}) => size_px < below_px);
    });
    const same = this.#chosen !== null && chosen.every((level, i) => level === this.#chosen[i]);
    this.#chosen = chosen;
    this.#levels.forEach((level, index) => {
      if (!same) level.robots = this.#things.filter((_, i) => chosen[i] === index);
      for (const part of level.parts) this.#placePart(part, level.robots, X_WB, !same);
    });
  }

  #placePart({mesh, painted, shapes}, robots, X_WB, anew) {
    const {array} = mesh.instanceMatrix, X_WG = new THREE.Matrix4();
    let count = 0;
    for (const {body, X_BG} of shapes) {
      for (const robot of robots) X_WG.multiplyMatrices(X_WB[robot.body + body], X_BG).toArray(array, 16 * count++);
    }
    mesh.visible = count > 0;
    mesh.boundingSphere = null;
    mesh.instanceMatrix.clearUpdateRanges();
    mesh.instanceMatrix.addUpdateRange(0, 16 * count);
    mesh.instanceMatrix.needsUpdate = true;
    if (!anew) return;
    mesh.count = count;
    mesh.userData.things = shapes.flatMap(() => robots);
    if (!painted) return;
    for (let i = 0; i < count; ++i) mesh.setColorAt(i, color(robots[i % robots.length].description.color));
    mesh.instanceColor.needsUpdate = true;
  }
}
