// SPDX-License-Identifier: MIT
// The words of a scenario and their meaning, for completion. A test compares them with the daemon's reader.
import {t} from './words.js';

const COLORS = ['red', 'green', 'blue', 'yellow', 'magenta', 'cyan', 'orange', 'purple', 'brown', 'pink'];
const YES_NO = ['yes', 'no'];
const watchdog = [t('in real time a robot stops when its client is silent for this long'), 'watchdog 2s', ['off']];
const pose = {
  position: [t('x y [z], m'), 'position 1 0.5'],
  orientation: [t('yaw, or roll pitch yaw; rad, or with a unit'), 'orientation 90deg'],
  quaternion: ['w x y z', 'quaternion 1 0 0 0'],
};
const driven = {
  type: [t('robot type: its folder on the search path'), 'type coopbot'],
  name: [t('its name'), 'name ana'],
  color: [t('a colour word, or R G B'), 'color blue', COLORS],
  fidelity: [t('accuracy of the simulation'), 'fidelity rolling', ['full', 'rolling', 'planar']],
  controller: [t('a loaded controller and its options'), 'controller diffuse speed=0.2'],
  sockets: [t('its own ports'), 'sockets yes', YES_NO],
  watchdog,
};
const texture = {
  texture: [t('a picture, or checker or grid'), 'texture checker', ['checker', 'grid']],
  texture_size: [t('width [height] of one picture, m'), 'texture_size 1'],
};

/** By kind of section: words, each with [help, example, choices]. */
export const GRAMMAR = {
  WORLD: {file: [t('a .world file'), 'file arena.world']},
  SIMULATION: {
    mode: [t('how time advances'), 'mode lockstep', ['realtime', 'lockstep', 'free']],
    step: [t('length of a step'), 'step 10ms'],
    substeps: [t('equal parts of a step'), 'substeps 2'],
    seed: [t('seed of everything random'), 'seed 1'],
    speed: [t('simulated seconds per second; 0: no limit'), 'speed 2'],
    duration: [t('the run ends after this time, s'), 'duration 60'],
    watchdog,
    gravity: [t('downwards, m/s²; 0: none, below 0: up; or x y z'), 'gravity 9.81'],
    overlaps: [t('pushes out things that start inside something'), 'overlaps yes', YES_NO],
    ambient_light: [t('reading of light sensors without lamps'), 'ambient_light 0.2'],
    angles: [t('unit of angles without one'), 'angles deg', ['rad', 'deg']],
    supervisor: [t('a loaded controller of the world'), 'supervisor referee rounds=5'],
    waits_for: [t('programs of YARP that a step of lockstep waits for'), 'waits_for yarp /my/controller'],
  },
  TASK: {
    title: [t('what it is called'), 'title Reach the red target'],
    text: [t('a paragraph, or with "- " an item of a list, in Markdown; may be repeated'), 'text Do not touch the **walls**.'],
    hint: [t('opened by the student, one after the other; may be repeated'), 'hint Turn towards the target first.'],
    counts: [t('what is worth points; may be repeated'), 'counts 2 points: the target is reached within 20 s'],
  },
  VIEW: {
    from: [t('everything is seen from there'), 'from top', ['whole', 'top', 'front', 'side']],
    eye: [t('the place of the camera, x y z, m; instead of from'), 'eye 3 -2 2'],
    look: [t('what it looks at, x y z, m'), 'look 0 0 0.2'],
  },
  FLOOR: {
    size: [t('length width [height], m'), 'size 10 8'],
    color: [t('a colour word, or R G B'), 'color lightgray', COLORS],
    friction: [t('1 is rubber on wood'), 'friction 1'],
    ...texture,
    ambient_light: [t('reading of light sensors without lamps'), 'ambient_light 0.2'],
    angles: [t('unit of angles without one'), 'angles deg', ['rad', 'deg']],
  },
  TARGET: Object.fromEntries(COLORS.map((color) => [color, [t('x y [z], m'), `${color} 2 0`]])),
  LIGHT: {
    position: [t('x y z, m'), 'position 0 0 2.5'],
    color: [t('a colour word, or R G B'), 'color white', COLORS],
    power: [t('reading of a light sensor 1 m away'), 'power 1'],
    shadows: [t('things block it'), 'shadows yes', YES_NO],
  },
  ROBOT: {
    ...driven, ...pose,
    deadline: [t('how long lockstep waits for its command'), 'deadline 500ms'],
    on_deadline: [t('action at the deadline'), 'on_deadline hold', ['hold', 'stop', 'drop']],
    on_disconnect: [t('action when its client disconnects'), 'on_disconnect stop', ['wait', 'hold', 'stop', 'drop']],
    sync: [t('takes part in lockstep'), 'sync yes', YES_NO],
    waits_for: [t('modules that need a command for each step'), 'waits_for motors'],
  },
  SWARM: {
    ...driven,
    count: [t('number of robots'), 'count 20'],
    spacing: [t('least distance between two, m'), 'spacing 0.5'],
    area: [t('x y of the centre, length, width, m'), 'area 0 0 4 4'],
    seed: [t('seed of the positions'), 'seed 1'],
  },
  THING: {
    type: [t('its shape'), 'type box', ['box', 'cylinder', 'sphere']],
    size: [t('length width height; diameter twice, height; or diameter, m'), 'size 1 0.5 0.3'],
    count: [t('number of copies, at random places'), 'count 5'],
    spacing: [t('least distance between two copies, m'), 'spacing 0.5'],
    area: [t('area of the copies: x y of the centre, length, width, m'), 'area 0 0 4 4'],
    seed: [t('seed of the positions of the copies'), 'seed 1'],
    ...pose,
    mass: [t('kg; without a mass, it never moves'), 'mass 2'],
    color: [t('a colour word, or R G B'), 'color orange', COLORS],
    friction: [t('1 is rubber on wood'), 'friction 0.6'],
    bounce: [t('fraction of the speed that remains after an impact'), 'bounce 0.8'],
    rolling_friction: [t('torque against rolling per load, m'), 'rolling_friction 1mm'],
    velocity: [t('at the start, x y z, m/s'), 'velocity 1 0 0'],
    turn_rate: [t('at the start, x y z, rad/s'), 'turn_rate 0 0 1'],
    ...texture,
  },
};

/** Section templates: the name in brackets, and the first lines. */
export const TEMPLATES = [
  ['WORLD', 'file arena.world'], ['TASK', 'title Reach the red target\ntext Do not touch the **walls**.'], ['VIEW', 'from top'], ['SIMULATION', 'mode realtime'], ['FLOOR', 'size 10 8'], ['TARGET', 'red 2 0'],
  ['ROBOT_1', 'type coopbot\nposition 0 0'], ['SWARM_1', 'type minibot\ncount 20'], ['LIGHT_1', 'position 0 0 2.5'],
  ['BOX_1', 'type box\nsize 0.5 0.5 0.5\nposition 1 1\nmass 2'], ['WALL_1', 'type box\nsize 4 0.1 0.5\nposition 0 2'],
  ['BALL_1', 'type sphere\nsize 0.3\nposition 1 0\nmass 0.5'], ['CYLINDER_1', 'type cylinder\nsize 0.4 0.4 0.5\nposition -1 0'],
];

/** The kind of a section by its name. */
export function kindOf(section) {
  const stem = section.toUpperCase().replace(/_?\d+$|_\*$/, '');
  return Object.hasOwn(GRAMMAR, stem) ? stem : 'THING';
}
