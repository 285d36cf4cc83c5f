// SPDX-License-Identifier: MIT
// The geometries of shapes. Edges are bevelled: they catch the light, which shows where a side ends. Metres.
import * as THREE from 'three';

const UP = new THREE.Matrix4().makeRotationX(Math.PI / 2);  // three.js's capsules are along y, ours along z
const FINE = 16;  // segments of round shapes from which edges are bevelled

function fromArrays(positions, normals, triangles) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.Float32BufferAttribute(normals, 3));
  geometry.setIndex(triangles);
  return geometry;
}

/** A box whose edges are cut by `bevel`: 44 triangles. Shading makes them round. */
function bevelledBox(size, bevel) {
  const positions = [], normals = [], triangles = [];
  const index = (axis, signs) => 8 * axis + signs.reduce((sum, sign, i) => sum + (sign > 0 ? 1 << i : 0), 0);
  for (let axis = 0; axis < 3; ++axis) {
    for (let corner = 0; corner < 8; ++corner) {
      for (let i = 0; i < 3; ++i) {
        const sign = corner >> i & 1 ? 1 : -1;
        positions.push(sign * (size[i] / 2 - (i === axis ? 0 : bevel)));
        normals.push(i === axis ? sign : 0);
      }
    }
  }
  const at = (i) => new THREE.Vector3(...positions.slice(3 * i, 3 * i + 3));
  const triangle = (a, b, c) => {  // facing outwards
    const out = at(b).sub(at(a)).cross(at(c).sub(at(a))).dot(at(a).add(at(b)).add(at(c)));
    triangles.push(...(out > 0 ? [a, b, c] : [a, c, b]));
  };
  const quad = (a, b, c, d) => { triangle(a, b, c); triangle(a, c, d); };
  for (let axis = 0; axis < 3; ++axis) {
    const u = (axis + 1) % 3, v = (axis + 2) % 3;
    const signs = (of, ...given) => [0, 1, 2].map((i) => given[of.indexOf(i)]);
    for (const s of [-1, 1]) {
      quad(...[[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => index(axis, signs([axis, u, v], s, a, b))));
      for (const t of [-1, 1]) {  // the edge along v between the sides of axis and u
        const edge = (of, end) => index(of, signs([axis, u, v], s, t, end));
        quad(edge(axis, -1), edge(u, -1), edge(u, 1), edge(axis, 1));
      }
    }
  }
  for (let corner = 0; corner < 8; ++corner) triangle(corner, 8 + corner, 16 + corner);
  return fromArrays(positions, normals, triangles);
}

/** A cylinder along z whose rims are cut by `bevel`; 0: sharp. `open`: at its lower end. */
function bevelledCylinder(radius, length, round, bevel, open = false) {
  const positions = [], normals = [], triangles = [], half = length / 2;
  // Radius, height; the normal outwards, along z.
  const rings = [[radius - bevel, -half, 0, -1], [radius, bevel - half, 1, 0], [radius, half - bevel, 1, 0], [radius - bevel, half, 0, 1]];
  for (const [r, z, out, up] of rings) {
    for (let i = 0; i < round; ++i) {
      const c = Math.cos(2 * Math.PI * i / round), s = Math.sin(2 * Math.PI * i / round);
      positions.push(r * c, r * s, z);
      normals.push(out * c, out * s, up);
    }
  }
  for (let i = 0; i < round; ++i) {
    const next = (i + 1) % round;
    for (const ring of bevel > 0 ? [0, 1, 2] : [1]) {
      const a = ring * round + i, b = ring * round + next;
      triangles.push(a, b, b + round, a, b + round, a + round);
    }
    if (i === 0 || next === 0) continue;
    if (!open) triangles.push(0, next, i);
    triangles.push(3 * round, 3 * round + i, 3 * round + next);
  }
  return fromArrays(positions, normals, triangles);
}

/** The geometry of a shape of /api/scene; null for a mesh. `round`: segments of round shapes. `most`: the widest bevel. */
export function geometryOf({type, size = [], open}, round, most) {
  const [a, b] = size, fine = round >= FINE;
  switch (type) {
    case 'box': return fine ? bevelledBox(size, Math.min(most, 0.15 * Math.min(...size))) : new THREE.BoxGeometry(...size);
    case 'cylinder': return bevelledCylinder(a, b, round, fine ? Math.min(most, 0.15 * b, 0.2 * a) : 0, open);
    case 'sphere': return new THREE.SphereGeometry(a, round, round / 2).applyMatrix4(UP);
    case 'capsule': return new THREE.CapsuleGeometry(a, b, Math.ceil(round / 4), round).applyMatrix4(UP);
    default: return null;
  }
}
