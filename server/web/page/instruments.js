// SPDX-License-Identifier: MIT
// Readings as one sees them: small pictures of a robot's sensors, seen from above with its front up. Numbers are in the captions.
import {make, setText, showNumber} from './dom.js';
import {t} from './words.js';

const SIZE_PX = 112;
const MIDDLE = SIZE_PX / 2;
const ROBOT_PX = 8;
const finite = (value) => typeof value === 'number' && Number.isFinite(value);
const degrees = (rad) => (finite(rad) ? (rad * 180) / Math.PI : rad);
/** The angle on the canvas of a bearing, 0 ahead and left positive. */
const onCanvas = (bearing) => -Math.PI / 2 - bearing;

/** A figure with a canvas that `draw(context, colours, data)` fills; it returns the caption. */
class Instrument {
  #canvas = make('canvas', {width: 2 * SIZE_PX, height: 2 * SIZE_PX});
  #note = make('figcaption');
  #draw;
  element;

  constructor(name, draw) {
    this.#draw = draw;
    this.#canvas.setAttribute('role', 'img');
    this.element = make('figure', {class: 'instrument'}, this.#canvas, this.#note);
    this.element.dataset.module = name;
  }

  show(data) {
    const context = this.#canvas.getContext('2d'), style = getComputedStyle(this.#canvas);
    // The borders have no width: they hold the theme's colours.
    const {color: accent, borderTopColor: ink, borderRightColor: line, borderBottomColor: warn, borderLeftColor: ground} = style;
    context.setTransform(2, 0, 0, 2, 0, 0);
    context.clearRect(0, 0, SIZE_PX, SIZE_PX);
    context.lineWidth = 1;
    const said = this.#draw(context, {ink, accent, line, warn, ground}, data);
    setText(this.#note, said);
    this.#canvas.setAttribute('aria-label', said);
  }
}

function circle(context, radius, colour) {
  context.strokeStyle = colour;
  context.beginPath();
  context.arc(MIDDLE, MIDDLE, radius, 0, 2 * Math.PI);
  context.stroke();
}

/** The robot in the middle, its front up. */
function robot(context, colour) {
  context.fillStyle = colour;
  context.beginPath();
  context.moveTo(MIDDLE, MIDDLE - ROBOT_PX - 2);
  context.lineTo(MIDDLE + ROBOT_PX - 2, MIDDLE + ROBOT_PX - 2);
  context.lineTo(MIDDLE - ROBOT_PX + 2, MIDDLE + ROBOT_PX - 2);
  context.fill();
}

/** An arrow from the middle. */
function arrow(context, angle, length, colour) {
  const at = (radius, turn = 0) => [MIDDLE + radius * Math.cos(angle + turn), MIDDLE + radius * Math.sin(angle + turn)];
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 3;
  context.beginPath();
  context.moveTo(MIDDLE, MIDDLE);
  context.lineTo(...at(Math.max(0, length - 5)));
  context.stroke();
  if (length < 6) return;
  context.beginPath();
  context.moveTo(...at(length));
  context.lineTo(...at(length - 9, 5 / length));
  context.lineTo(...at(length - 9, -5 / length));
  context.fill();
}

/** Distances as a fan. `geometry`: bearing, opening and range of each sensor; without, they lie around the robot. */
export function distanceFan(name, geometry) {
  const place = (i, count) => geometry?.slice(3 * i, 3 * i + 3) ?? [Math.PI * (2 * (i + 0.5) / count - 1), 2 * Math.PI / count, 4];
  return new Instrument(name, (context, {accent, line, ground, warn}, data) => {
    const rim = MIDDLE - 2, hub = ROBOT_PX + 4;
    data.forEach((range, i) => {
      const [bearing, opening, most] = place(i, data.length);
      const half = Math.max(opening, 0.06) / 2, there = finite(range) && range < most;
      // The root shows near things larger: those are what one drives into.
      const reach = hub + (rim - hub) * Math.sqrt(there ? Math.max(0, range) / most : 1);
      context.beginPath();
      context.moveTo(MIDDLE, MIDDLE);
      context.arc(MIDDLE, MIDDLE, reach, onCanvas(bearing) - half, onCanvas(bearing) + half);
      context.closePath();
      context.fillStyle = ground;
      context.fill();
      context.strokeStyle = line;
      context.lineWidth = 1;
      context.stroke();
      if (!there) return;
      context.beginPath();
      context.arc(MIDDLE, MIDDLE, reach, onCanvas(bearing) - half, onCanvas(bearing) + half);
      context.strokeStyle = range < 0.2 * most ? warn : accent;
      context.lineWidth = 3;
      context.stroke();
    });
    robot(context, accent);
    const hits = data.filter(finite);
    return `${name}: ${hits.length > 0 ? t('nearest {distance} m', {distance: showNumber(Math.min(...hits), 2)}) : t('nothing in range')}`;
  });
}

/** Directions and distances of targets. `colours`: a word for each. */
export function targetCompass(colours) {
  return new Instrument('target', (context, {accent, line, ink}, data) => {
    const rim = MIDDLE - 8, count = Math.floor(data.length / 2);
    circle(context, rim, line);
    robot(context, accent);
    let nearest = '';
    let least = Infinity;
    for (let i = 0; i < count; ++i) {
      const [distance, bearing] = data.slice(2 * i, 2 * i + 2);
      if (!finite(distance) || !finite(bearing)) continue;
      const reach = Math.min(rim, 14 + (rim - 14) * Math.sqrt(distance / 5));
      context.beginPath();
      context.arc(MIDDLE + reach * Math.cos(onCanvas(bearing)), MIDDLE + reach * Math.sin(onCanvas(bearing)), 5, 0, 2 * Math.PI);
      context.fillStyle = CSS.supports('color', colours[i] ?? '') ? colours[i] : ink;
      context.fill();
      context.strokeStyle = ink;
      context.stroke();
      if (distance < least) nearest = `${colours[i] ?? t('target')} ${showNumber(least = distance, 2)} m`;
    }
    return `${t('targets')}: ${nearest || t('none')}`;
  });
}

/** An artificial horizon, of the quaternion w x y z. */
export function attitude(name) {
  return new Instrument(name, (context, {accent, line, ground, ink}, [w, x, y, z]) => {
    const roll = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), pitch = Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))));
    const rim = MIDDLE - 4;
    context.save();
    context.beginPath();
    context.arc(MIDDLE, MIDDLE, rim, 0, 2 * Math.PI);
    context.clip();
    context.translate(MIDDLE, MIDDLE);
    context.rotate(-roll);
    context.fillStyle = ground;
    context.fillRect(-SIZE_PX, -SIZE_PX, 2 * SIZE_PX, 2 * SIZE_PX);
    context.fillStyle = line;
    context.fillRect(-SIZE_PX, -pitch * rim, 2 * SIZE_PX, 2 * SIZE_PX);
    context.restore();
    circle(context, rim, ink);
    context.strokeStyle = accent;
    context.lineWidth = 3;
    context.beginPath();
    context.moveTo(MIDDLE - 26, MIDDLE);
    context.lineTo(MIDDLE - 8, MIDDLE);
    context.moveTo(MIDDLE + 8, MIDDLE);
    context.lineTo(MIDDLE + 26, MIDDLE);
    context.stroke();
    return `${name}: ${t('roll {roll}°, pitch {pitch}°', {roll: showNumber(degrees(roll), 0), pitch: showNumber(degrees(pitch), 0)})}`;
  });
}

/** A force as an arrow along the floor, and a bar for its vertical part. The scale grows with the largest force so far. */
export function forceArrow(name) {
  let most = 1;
  return new Instrument(name, (context, {accent, line, ground}, [x, y, z]) => {
    if (![x, y, z].every(finite)) return `${name}: ${t('no force')}`;
    const size = Math.hypot(x, y, z), rim = MIDDLE - 10;
    most = Math.max(most, size);
    circle(context, rim, line);
    arrow(context, onCanvas(Math.atan2(y, x)), rim * Math.hypot(x, y) / most, accent);
    context.fillStyle = ground;
    context.fillRect(SIZE_PX - 6, 4, 6, SIZE_PX - 8);
    context.fillStyle = accent;
    context.fillRect(SIZE_PX - 6, MIDDLE, 6, -(MIDDLE - 4) * z / most);
    return `${name}: ${showNumber(size, 1)} N`;
  });
}

/** Where the front points, 0 along x of the world, left positive; x is to the right. */
export function needle(name) {
  return new Instrument(name, (context, {accent, line}, [heading]) => {
    circle(context, MIDDLE - 6, line);
    if (finite(heading)) arrow(context, -heading, MIDDLE - 10, accent);
    return `${name}: ${showNumber(degrees(heading), 0)}°`;
  });
}

/** A battery as a gauge: energy J, fraction, power W. */
export function gauge(name) {
  return new Instrument(name, (context, {accent, line, warn}, [, fraction, power]) => {
    const from = 0.75 * Math.PI, whole = 1.5 * Math.PI, share = finite(fraction) ? Math.min(1, Math.max(0, fraction)) : 0;
    const part = (to, colour) => {
      context.beginPath();
      context.arc(MIDDLE, MIDDLE, MIDDLE - 12, from, from + whole * to);
      context.strokeStyle = colour;
      context.lineWidth = 9;
      context.stroke();
    };
    part(1, line);
    if (share > 0) part(share, share < 0.2 ? warn : accent);
    return `${name}: ${showNumber(100 * fraction, 0)} %, ${showNumber(power, 1)} W`;
  });
}
