// SPDX-License-Identifier: MIT
// A world from above on a 2D canvas: cheap enough for a wall of thirty. Built from /api/scene, moved by poses. x is right, y up.
import {floorColor, shownColor} from './palette.js';

const ROUND = 20;          // corners of a round shape
const LEAST_SEEN_M = 3;    // shows some floor around a single small thing
const LEAST_ROBOT_PX = 7;  // smaller robots become an arrow of this radius
const TRAIL = 40;          // points of a robot's way that are kept
const TRAIL_STEP_PX = 3;
const TRAIL_PAUSE_S = 1, TRAIL_TURN_RAD = 0.8;  // longer or more between two poses, the way between them is not known
const MAX_TRAILS = 12;     // robots in a world beyond which ways are not drawn
const MAX_SHAPES = 300;    // of robots; beyond, each robot is an arrow
const UPRIGHT = 1e-3;      // of the sine of half the tilt

const asCss = ([r, g, b]) => `rgb(${Math.round(255 * r)} ${Math.round(255 * g)} ${Math.round(255 * b)})`;
const css = (rgb) => asCss(shownColor(rgb));
const shade = (rgb, factor) => asCss(shownColor(rgb).map((part) => part * factor));

/** Turns `p` by the quaternion q = [x, y, z, w]. */
function turned([x, y, z], [qx, qy, qz, qw]) {
  const tx = 2 * (qy * z - qz * y), ty = 2 * (qz * x - qx * z), tz = 2 * (qx * y - qy * x);
  return [x + qw * tx + qy * tz - qz * ty, y + qw * ty + qz * tx - qx * tz, z + qw * tz + qx * ty - qy * tx];
}

/** The corners of the smallest convex polygon around points [x, y, …] (Andrew's monotone chain). */
function hull(points) {
  const sorted = points.toSorted((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list) => {
    const chain = [];
    for (const p of list) {
      while (chain.length >= 2) {
        const [a, b] = chain.slice(-2);
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        chain.pop();
      }
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.toReversed())];
}

/** Points in a shape's own frame whose hull is the shape, about. */
function pointsOf({type, size = []}, radius) {
  const ring = (r, z, n = ROUND) => Array.from({length: n}, (_, i) => [r * Math.cos(2 * Math.PI * i / n), r * Math.sin(2 * Math.PI * i / n), z]);
  const [a, b, c] = size;
  switch (type) {
    case 'box': return [-1, 1].flatMap((i) => [-1, 1].flatMap((j) => [-1, 1].map((k) => [i * a / 2, j * b / 2, k * c / 2])));
    case 'cylinder': return [...ring(a, -b / 2), ...ring(a, b / 2)];
    case 'sphere': return [...ring(a, 0), [0, 0, a], [0, 0, -a], ...ring(0.7 * a, 0.7 * a, 8), ...ring(0.7 * a, -0.7 * a, 8)];
    case 'capsule': return [-1, 1].flatMap((end) => [...ring(a, end * b / 2), ...ring(0.7 * a, end * (b / 2 + 0.7 * a), 8), [0, 0, end * (b / 2 + a)]]);
    default: return [...ring(radius, 0, 8)];  // a mesh: its bounds are not told
  }
}

function pathOf(corners) {
  const path = new Path2D();
  corners.forEach(([x, y], i) => (i === 0 ? path.moveTo(x, y) : path.lineTo(x, y)));
  path.closePath();
  return path;
}

const footprint = (points, q) => hull(points.map((p) => turned(p, q)));

/** What one scene looks like from above; views of any size share it. */
export class TopScene {
  #shapes = [];   // of bodies that move: {body, points, fill, edge, top, path}
  #still = [];    // {path, fill, edge, top}
  robots = [];    // {name, body, origin, turn, radius, color, trail, last}; trail: [x, y, whether the way to there is not known]
  bodies;
  time_s = 0;

  constructor(description) {
    this.description = description;
    this.number = description.scene;
    this.bodies = new Float32Array(7 * description.bodies);
    for (const thing of description.things) {
      const points = pointsOf(thing, 0.1);
      const look = {fill: css(thing.color), edge: shade(thing.color, 0.6)};
      if (thing.body >= 0) {
        this.#addShape(thing.body, points, look);
        continue;
      }
      const placed = points.map((p) => turned(p, thing.quaternion)).map(([x, y, z]) => [x + thing.position[0], y + thing.position[1], z + thing.position[2]]);
      this.#still.push({path: pathOf(hull(placed)), points: placed, top: Math.max(...placed.map((p) => p[2])), ...look});
    }
    this.#still.sort((a, b) => a.top - b.top);
    const shapes = description.robots.reduce((sum, robot) => sum + description.models[robot.model].shapes.length, 0);
    for (const robot of description.robots) {
      const model = description.models[robot.model];
      this.robots.push({...robot, radius: model.radius, fill: css(robot.color), trail: [], last: null});
      if (shapes > MAX_SHAPES) continue;
      for (const shape of model.shapes) {
        const points = pointsOf(shape, 0.5 * model.radius)
          .map((p) => turned(p, shape.quaternion)).map(([x, y, z]) => [x + shape.position[0], y + shape.position[1], z + shape.position[2]]);
        const color = shape.color ?? robot.color;
        this.#addShape(robot.body + shape.body, points, {fill: css(color), edge: shade(color, 0.6), robot: this.robots.at(-1)});
      }
    }
    this.#shapes.sort((a, b) => a.top - b.top);
  }

  #addShape(body, points, look) {
    this.#shapes.push({body, points, path: pathOf(hull(points)), top: Math.max(...points.map((p) => p[2])), ...look});
  }

  get shapes() { return this.#shapes; }
  get still() { return this.#still; }

  /** Position and quaternion of a body. */
  pose(body) {
    const at = 7 * body, b = this.bodies;
    return [[b[at], b[at + 1], b[at + 2]], [b[at + 3], b[at + 4], b[at + 5], b[at + 6]]];
  }

  /** Where a robot is, and its yaw. */
  robotPose({body, origin, turn}) {
    const [p, q] = this.pose(body), [ox, oy] = turned(origin, q), [hx, hy] = turned(turned([1, 0, 0], turn), q);
    return [p[0] + ox, p[1] + oy, Math.atan2(hy, hx)];
  }

  /** The part of the floor that is worth seeing: {x, y, width, height} in m, around its middle. */
  bounds() {
    const xs = [], ys = [];
    const add = (x, y, r) => { xs.push(x - r, x + r); ys.push(y - r, y + r); };
    for (const {points} of this.#still) for (const [x, y] of points) add(x, y, 0);
    for (const {body, points, robot} of this.#shapes) {
      if (robot) continue;
      const [p] = this.pose(body);
      add(p[0], p[1], Math.max(...points.map(([x, y, z]) => Math.hypot(x, y, z))));
    }
    for (const robot of this.robots) {
      const [x, y] = this.robotPose(robot);
      add(x, y, robot.radius);
    }
    for (const {position: [x, y]} of this.description.targets) add(x, y, 0.1);
    const [length, width] = this.description.floor.size;
    const span = (values, most) => {
      const low = Math.max(Math.min(...values), -most / 2), high = Math.min(Math.max(...values), most / 2);
      return values.length > 0 && high > low ? [(low + high) / 2, Math.max(high - low, LEAST_SEEN_M)] : [0, Math.min(most, 2 * LEAST_SEEN_M)];
    };
    const [x, w] = span(xs, length), [y, h] = span(ys, width);
    return {x, y, width: w, height: h};
  }

  /** Remembers where the robots have been, in steps of at least `step_m`. */
  mark(step_m) {
    if (this.robots.length > MAX_TRAILS) return;
    for (const robot of this.robots) {
      const [x, y, yaw] = this.robotPose(robot), {last, trail} = robot;
      const wayFrom = (point) => (point ? Math.hypot(x - point[0], y - point[1]) : Infinity);
      robot.last = [x, y, yaw, this.time_s];
      const unknown = last && wayFrom(last) > step_m && (Math.abs(this.time_s - last[3]) > TRAIL_PAUSE_S || Math.cos(yaw - last[2]) < Math.cos(TRAIL_TURN_RAD));
      const way = wayFrom(trail.at(-1));
      if (way < step_m && !unknown) continue;
      if (trail.length > 0 && way > 1) trail.length = 0;  // it was put elsewhere
      trail.push([x, y, unknown]);
      if (robot.trail.length > TRAIL) robot.trail.shift();
    }
  }
}

/** A canvas that shows a TopScene. */
export class TopView {
  #canvas;
  #context;
  #still = document.createElement('canvas');  // what does not move, drawn once
  #scene = null;
  #seen = null;     // bounds
  #scale = 1;       // px/m
  #ground = '#888';

  constructor(canvas) {
    this.#canvas = canvas;
    this.#context = canvas.getContext('2d', {alpha: false});
  }

  /** `scene`: a TopScene whose poses are known. */
  show(scene) {
    this.#scene = scene;
    this.fit();
  }

  /** After a change of size, colours or scene. */
  fit() {
    const {clientWidth, clientHeight} = this.#canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    const ratio = Math.min(2, devicePixelRatio || 1);
    this.#canvas.width = Math.round(clientWidth * ratio);
    this.#canvas.height = Math.round(clientHeight * ratio);
    this.#ground = getComputedStyle(this.#canvas).backgroundColor;
    if (!this.#scene) {
      this.#context.fillStyle = this.#ground;
      this.#context.fillRect(0, 0, this.#canvas.width, this.#canvas.height);
      return;
    }
    this.#look(this.#scene.bounds());
    this.draw();
  }

  #look(bounds) {
    this.#seen = bounds;
    this.#scale = 0.94 * Math.min(this.#canvas.width / bounds.width, this.#canvas.height / bounds.height);
    this.#drawStill();
  }

  /** x, y in m to pixels, turned by `yaw`. */
  #place(context, x, y, yaw = 0) {
    const s = this.#scale, c = s * Math.cos(yaw), n = s * Math.sin(yaw);
    context.setTransform(c, -n, -n, -c, this.#canvas.width / 2 + s * (x - this.#seen.x), this.#canvas.height / 2 - s * (y - this.#seen.y));
  }

  #drawStill() {
    const {floor, targets} = this.#scene.description;
    this.#still.width = this.#canvas.width;
    this.#still.height = this.#canvas.height;
    const context = this.#still.getContext('2d', {alpha: false});
    context.fillStyle = this.#ground;
    context.fillRect(0, 0, this.#still.width, this.#still.height);
    this.#place(context, 0, 0);
    const [length, width] = floor.size;
    const [r, g, b] = this.#ground.match(/[\d.]+/g).map(Number), dark = 0.3 * r + 0.6 * g + 0.1 * b < 128;
    context.fillStyle = asCss(floorColor(floor.color, dark));
    context.fillRect(-length / 2, -width / 2, length, width);
    context.lineWidth = 1 / this.#scale;
    context.strokeStyle = dark ? 'rgb(255 255 255 / 14%)' : 'rgb(0 0 0 / 8%)';
    context.beginPath();
    const step = Math.max(1, Math.ceil(Math.max(this.#seen.width, this.#seen.height) / 24));
    for (let x = Math.ceil(-length / 2); x <= length / 2; x += step) { context.moveTo(x, -width / 2); context.lineTo(x, width / 2); }
    for (let y = Math.ceil(-width / 2); y <= width / 2; y += step) { context.moveTo(-length / 2, y); context.lineTo(length / 2, y); }
    context.stroke();
    for (const {color, position: [x, y]} of targets) {
      for (const [radius, alpha] of [[0.22, 0.3], [0.1, 1]]) {
        context.globalAlpha = alpha;
        context.fillStyle = css(color);
        context.beginPath();
        context.arc(x, y, radius, 0, 2 * Math.PI);
        context.fill();
      }
    }
    context.globalAlpha = 1;
    for (const {path, fill, edge} of this.#scene.still) {
      context.fillStyle = fill;
      context.strokeStyle = edge;
      context.fill(path);
      context.stroke(path);
    }
  }

  /** Draws the scene as its bodies are. */
  draw() {
    if (!this.#scene || !this.#seen) return;
    this.#keepRobotsInSight();
    const context = this.#context;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.#still, 0, 0);
    this.#scene.mark(TRAIL_STEP_PX / this.#scale);
    this.#drawTrails(context);
    context.lineWidth = 1 / this.#scale;
    const small = ({radius}) => radius * this.#scale < LEAST_ROBOT_PX;
    for (const {body, points, path, fill, edge, robot} of this.#scene.shapes) {
      if (robot && small(robot)) continue;
      const [[x, y], q] = this.#scene.pose(body);
      const upright = Math.abs(q[0]) + Math.abs(q[1]) < UPRIGHT;
      this.#place(context, x, y, upright ? 2 * Math.atan2(q[2], q[3]) : 0);
      const shown = upright ? path : pathOf(footprint(points, q));
      context.fillStyle = fill;
      context.fill(shown);
      context.strokeStyle = edge;
      context.stroke(shown);
    }
    for (const robot of this.#scene.robots) {
      if (small(robot) || this.#scene.shapes.length === 0) this.#drawArrow(context, robot, LEAST_ROBOT_PX / this.#scale);
      else this.#drawArrow(context, robot, Math.max(0.45 * robot.radius, 4 / this.#scale), true);
    }
  }

  /** A view that a robot leaves shows more. */
  #keepRobotsInSight() {
    const {x, y, width, height} = this.#seen;
    const left = this.#scene.robots.some((robot) => {
      const [rx, ry] = this.#scene.robotPose(robot);
      return Math.abs(rx - x) > 0.53 * Math.max(width, this.#canvas.width / this.#scale) || Math.abs(ry - y) > 0.53 * Math.max(height, this.#canvas.height / this.#scale);
    });
    if (!left) return;
    const now = this.#scene.bounds(), [length, floorWidth] = this.#scene.description.floor.size;
    const grown = {x: now.x, y: now.y, width: Math.max(1.2 * now.width, width), height: Math.max(1.2 * now.height, height)};
    if (width >= length && height >= floorWidth) return;
    this.#look(grown);
  }

  #drawTrails(context) {
    this.#place(context, 0, 0);
    context.lineWidth = 2.2 / this.#scale;
    context.lineJoin = context.lineCap = 'round';
    context.globalAlpha = 0.45;
    for (const robot of this.#scene.robots) {
      if (robot.trail.length < 2) continue;
      const [x, y] = this.#scene.robotPose(robot);
      context.strokeStyle = robot.fill;
      context.beginPath();
      robot.trail.forEach(([tx, ty, unknown], i) => (i === 0 || unknown ? context.moveTo(tx, ty) : context.lineTo(tx, ty)));
      context.lineTo(x, y);
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  /** Where a robot heads. `over`: on top of its shapes. */
  #drawArrow(context, robot, size, over = false) {
    const [x, y, yaw] = this.#scene.robotPose(robot);
    this.#place(context, x, y, yaw);
    context.beginPath();
    context.moveTo(size, 0);
    context.lineTo(-0.7 * size, 0.75 * size);
    context.lineTo(-0.35 * size, 0);
    context.lineTo(-0.7 * size, -0.75 * size);
    context.closePath();
    context.lineJoin = 'round';
    context.lineWidth = 1.8 / this.#scale;
    context.strokeStyle = over ? 'rgb(0 0 0 / 45%)' : '#fff';
    context.stroke();
    context.fillStyle = over ? '#fff' : robot.fill;
    context.fill();
  }
}
