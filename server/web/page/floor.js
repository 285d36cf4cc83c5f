// SPDX-License-Identifier: MIT
// The floor: tiles of a metre, stronger lines every five, decimetres from near, and numbers along two sides. Metres, world frame.
import * as THREE from 'three';
import {floorColor} from './palette.js';

const NUMBER_PX = 64, NUMBER_M = 0.22;
const MOST_NUMBERS = 60;  // along a side
const SLAB_M = 0.1;
const INK = {light: [0.25, 0.29, 0.34], dark: [0.80, 0.84, 0.89]};

// Lines as wide as given, at least a pixel; far away they fade to their share of the floor. `pixel`: the size of one, in units of p.
const TILES = `
float lines(vec2 p, vec2 pixel, float width) {
  vec2 drawn = max(vec2(width), pixel);
  vec2 away = 2.0 * abs(fract(p - 0.5) - 0.5);
  vec2 cover = clamp((drawn + pixel - away) / (2.0 * pixel), 0.0, 1.0) * width / drawn;
  return max(cover.x, cover.y);
}
vec3 tiled(vec3 base, vec3 ink, vec2 p) {
  vec2 pixel = max(fwidth(p), vec2(1e-5));
  float coarse = max(pixel.x, pixel.y);
  vec2 cell = floor(p);
  base *= 1.0 - 0.06 * mod(cell.x + cell.y, 2.0) * max(0.0, 1.0 - 2.0 * coarse);
  float mark = 0.30 * lines(p, pixel, 0.016) + 0.28 * lines(0.2 * p, 0.2 * pixel, 0.007);
#ifdef STANDARD  // physically based materials: there is a graphics card
  mark += 0.14 * lines(10.0 * p, 10.0 * pixel, 0.05) * (1.0 - smoothstep(0.003, 0.009, coarse));
#endif
  return mix(base, ink, min(mark, 0.6));
}
`;

/** Adds tiles to a material; a texture of the floor takes their place. */
function addTiles(material, ink) {
  const compile = material.onBeforeCompile;
  material.onBeforeCompile = (shader) => {
    compile.call(material, shader);
    shader.uniforms.tileInk = ink;
    const add = (stage, declared, ...places) => {
      shader[stage] = shader[stage].replace('#include <common>', `#include <common>\n${declared}`);
      for (const [place, more] of places) shader[stage] = shader[stage].replace(place, `${place}\n${more}`);
    };
    const onFloor = ['#include <begin_vertex>', 'onFloor = position.xy;'];
    if (material.isPlain) {  // squares instead of sRGB's curve, which is dear; the light on the ink is that on the floor
      add('vertexShader', 'varying vec2 onFloor;\nvarying vec3 ink;\nuniform vec3 tileInk;', onFloor,
        ['// marks', 'ink = shown(RECIPROCAL_PI * tileInk * (sky + sun)) / max(sunny, 0.01);']);
      add('fragmentShader', `varying vec2 onFloor;\nvarying vec3 ink;\n${TILES}`,
        ['// marks', `#ifndef USE_MAP\ndiffuseColor.rgb *= sqrt(tiled(vec3(1.0), ink * ink, onFloor));\n#endif`]);
    } else {
      add('vertexShader', 'varying vec2 onFloor;', onFloor);
      add('fragmentShader', `varying vec2 onFloor;\nuniform vec3 tileInk;\n${TILES}`,
        ['#include <color_fragment>', '#ifndef USE_MAP\ndiffuseColor.rgb = tiled(diffuseColor.rgb, tileInk, onFloor);\n#endif']);
    }
  };
  material.customProgramCacheKey = () => `tiles ${material.isPlain}`;
}

/** Quads with the numbers of whole metres, just outside the floor. */
function numbers(length, width, color) {
  const step = [1, 2, 5, 10, 50].find((every) => Math.max(length, width) / every <= MOST_NUMBERS) ?? 100;
  const marks = [];
  const along = (side, place) => {
    for (let n = step * Math.ceil(-side / 2 / step); n <= side / 2; n += step) marks.push([String(n).replace('-', '−'), ...place(n)]);
  };
  const gap = 0.9 * NUMBER_M * Math.sqrt(step);
  along(length, (n) => [n, -width / 2 - gap]);
  along(width, (n) => [-length / 2 - gap, n]);
  const texts = [...new Set(marks.map(([text]) => text))], columns = Math.ceil(Math.sqrt(texts.length));
  const sheet = document.createElement('canvas');
  sheet.width = sheet.height = columns * NUMBER_PX;
  const draw = sheet.getContext('2d');
  Object.assign(draw, {font: `600 ${0.5 * NUMBER_PX}px system-ui, sans-serif`, textAlign: 'center', textBaseline: 'middle', fillStyle: '#fff'});
  const place = (text) => { const i = texts.indexOf(text); return [i % columns, Math.floor(i / columns)]; };
  for (const text of texts) draw.fillText(text, (place(text)[0] + 0.5) * NUMBER_PX, (place(text)[1] + 0.5) * NUMBER_PX);
  const positions = [], uvs = [], triangles = [], half = NUMBER_M * Math.sqrt(step);
  marks.forEach(([text, x, y], i) => {
    const [column, row] = place(text);
    for (const [a, b] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
      positions.push(x + (2 * a - 1) * half, y + (2 * b - 1) * half, 0);
      uvs.push((column + a) / columns, 1 - (row + 1 - b) / columns);
    }
    triangles.push(4 * i, 4 * i + 1, 4 * i + 2, 4 * i, 4 * i + 2, 4 * i + 3);
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('uv', new THREE.Float32BufferAttribute(uvs, 2));
  geometry.setIndex(triangles);
  const map = new THREE.CanvasTexture(sheet);
  map.anisotropy = 4;
  const material = new THREE.MeshBasicMaterial({map, color, transparent: true, opacity: 0.75, depthWrite: false, toneMapped: false});
  return new THREE.Mesh(geometry, material);
}

/** The floor of /api/scene: `top` is the drawn surface. `makeMaterial(rgb, options)` makes its materials. */
export class FloorMesh {
  root = new THREE.Group();
  top;
  #given;
  #ink = {value: new THREE.Color()};
  #slab;
  #numbers;

  constructor({size: [length, width, height], color}, makeMaterial) {
    this.#given = color;
    const material = makeMaterial(color, {roughness: 0.9});
    addTiles(material, this.#ink);
    this.top = new THREE.Mesh(new THREE.PlaneGeometry(length, width), material);
    this.top.position.z = -0.0005;
    this.top.receiveShadow = true;
    this.top.renderOrder = 50;  // after what hides it
    const thick = Math.min(height, SLAB_M);
    const sides = new THREE.BoxGeometry(length, width, thick);
    sides.setIndex([...sides.index.array].filter((_, i) => i < 24 || i >= 30));  // its upper side is never seen
    this.#slab = new THREE.Mesh(sides, makeMaterial(color, {roughness: 0.9}));
    this.#slab.position.z = -thick / 2 - 0.002;
    this.#numbers = numbers(length, width, this.#ink.value);
    this.#numbers.raycast = () => {};
    this.root.add(this.top, this.#slab, this.#numbers);
  }

  /** Colours it for the theme. */
  paint(dark) {
    const rgb = floorColor(this.#given, dark);
    const luma = 0.3 * rgb[0] + 0.6 * rgb[1] + 0.1 * rgb[2];
    this.#ink.value.setRGB(...(luma > 0.45 ? INK.light : INK.dark), THREE.SRGBColorSpace);
    if (!this.top.material.map) this.top.material.color.setRGB(...rgb, THREE.SRGBColorSpace);
    this.#slab.material.color.setRGB(...rgb.map((part) => 0.8 * part), THREE.SRGBColorSpace);
    this.#numbers.material.color.setRGB(...(dark ? INK.dark : INK.light), THREE.SRGBColorSpace);
  }
}
