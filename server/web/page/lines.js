// SPDX-License-Identifier: MIT
// Ready-made lines that connect a client to a robot, with the address of this page.
import {make} from './dom.js';
import {connectArguments, SEAT} from './seat.js';
import {t} from './words.js';

const DEFAULT_NAME_PORT = 10000;

/** The host for a command line: an IPv6 address without its brackets. */
const plainHost = () => location.hostname.replace(/^\[|\]$/g, '');

/** The module of a type among a robot's `modules`; of several, preferably the one named like the type. */
export function ofType(modules, type) {
  const all = modules.filter((module) => module.type === type);
  return all.find((module) => module.name.endsWith(`/${type}`)) ?? all[0];
}

/** [title, lines] for each client. */
export function linesFor(robot, modules, namePort) {
  const server = namePort === DEFAULT_NAME_PORT ? location.hostname : `${location.hostname}:${namePort}`;
  const motors = ofType(modules, 'motors') ?? modules[0];
  const lines = [];
  if (namePort > 0) {
    lines.push(['MATLAB', `sim = coopdyn.connect(${connectArguments('MATLAB', server)});\nr = sim.robot("${robot}");`]);
    lines.push(['Python', `import coopdyn\nsim = coopdyn.connect(${connectArguments('Python', server)})\nr = sim.robot("${robot}")`]);
  }
  if (motors?.port > 0) {
    lines.push(['telnet', `telnet ${plainHost()} ${motors.port}`]);
  } else if (motors && namePort > 0) {
    lines.push(['telnet', `telnet ${plainHost()} ${namePort}`]);
    lines.push([t('then'), `${SEAT ? `SEAT ${SEAT.name} PIN\n` : ''}OPEN ${motors.name}`]);
  }
  return lines;
}

async function copy(button, line) {
  const text = line.textContent;
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = t('copied');
  } catch {  // without HTTPS, only pages of localhost may use the clipboard
    getSelection().selectAllChildren(line);
    button.textContent = t('press Ctrl+C');
  }
  setTimeout(() => { button.textContent = t('copy'); }, 2000);
}

export function connectionLines(robot, modules, namePort) {
  const list = make('dl', {class: 'lines'});
  if (SEAT) list.append(make('dt', {class: 'quiet'}, t('PIN: it stands on your sheet')));
  for (const [title, line] of linesFor(robot, modules, namePort)) {
    const code = make('code', {}, line);
    const button = make('button', {type: 'button', class: 'small'}, t('copy'));
    button.addEventListener('click', () => copy(button, code));
    list.append(make('dt', {}, title, button), make('dd', {}, code));
  }
  return list;
}
