// SPDX-License-Identifier: MIT
// Translates a console command into runnable code in the clients' languages. No drawing.
import {connectArguments, SEAT} from './seat.js';

const DEFAULT_NAME_PORT = 10000;

/** A string literal that is valid in both Python and C++. */
function quoted(text) {
  const escaped = [...text].map((char) => {
    const known = {'"': '\\"', '\\': '\\\\', '\n': '\\n', '\r': '\\r', '\t': '\\t'}[char];
    if (known) return known;
    const code = char.codePointAt(0);
    return code < 32 || code === 127 ? `\\${code.toString(8).padStart(3, '0')}` : char;
  });
  return `"${escaped.join('')}"`;
}

/** An expression that is valid in both MATLAB and Octave, where '\n' is two characters. */
function matlabText(text) {
  const parts = text.split(/([\n\r\t])/).filter(Boolean);
  const terms = parts.map((part) => ('\n\r\t'.includes(part) ? `char(${part.charCodeAt(0)})` : `'${part.replaceAll("'", "''")}'`));
  return terms.length === 1 && terms[0].startsWith("'") ? terms[0] : `[${terms.join(' ')}]`;
}

/** Numbers in the bridge's JSON: "inf", "-inf", "nan" if not finite. */
const number = (value, names) => (typeof value === 'number' ? String(value) : names[value] ?? String(value));
const MATLAB = {inf: 'Inf', '-inf': '-Inf', nan: 'NaN'};
const PYTHON = {inf: 'float("inf")', '-inf': 'float("-inf")', nan: 'float("nan")'};
const CPP = {inf: 'INFINITY', '-inf': '-INFINITY', nan: 'NAN'};

/** `args` without the empty ones at the end. */
function upToLast(args, isEmpty) {
  let count = args.length;
  while (count > 0 && isEmpty[count - 1]) --count;
  return args.slice(0, count);
}

const MODES = ['realtime', 'lockstep', 'free'];
/** Commands that a function of the clients sends as it is: {its arguments, of what was sent}. */
const OWN = {
  '/simulation': {run: () => [], pause: () => [], stop_all: () => [], reload: () => [], reset: ({params}) => params, set_step: ({data}) => data,
    set_speed: ({data}) => data, set_mode: ({params}) => [MODES[params[0]]], load_scenario: ({text}) => [text]},
  motors: {set_velocity: ({data}) => data, set_wheel_speeds: ({data}) => data, stop: () => []},
};

/** Variables of a program are letters, digits and _. */
export const variableOf = (robot) => robot.replace(/\W/g, '_').replace(/^(?=\d)/, 'r');

/** The call of the client's own function, as a maker of the text of one language; null if there is none. */
function ownCall({module, name, params = [], data = [], text = ''}) {
  const [, robot, last] = module.split('/');
  const own = OWN[last === undefined ? module : last];
  const fits = own && Object.hasOwn(own, name) && (last === undefined || params.length === 0);
  if (!fits) return null;
  const args = own[name]({params, data, text});
  if (args.some((arg) => arg === undefined)) return null;
  return (numbers, words) => `${last === undefined ? 'sim' : variableOf(robot)}.${name}(${args.map((arg) =>
    (typeof arg === 'number' || arg in numbers ? number(arg, numbers) : words(arg))).join(', ')})`;
}

/** `sent`: {module, name, line, params, data, text}; name null: only a line. Returns {MATLAB, Python, C++, telnet}, each a text. */
export function inLanguages({module, name, line, params = [], data = [], text = ''}) {
  const telnet = `OPEN ${module}\n${line}`;
  if (name === null) return {telnet};
  const own = ownCall({module, name, params, data, text});
  if (own) return {MATLAB: `${own(MATLAB, matlabText)};`, Python: own(PYTHON, quoted), 'C++': `${own(CPP, quoted)};`, telnet};
  const empty = [params.length === 0, data.length === 0, text === ''];
  const matlab = upToLast([`[${params.join(' ')}]`, `[${data.map((value) => number(value, MATLAB)).join(' ')}]`, matlabText(text)], empty);
  const cpp = upToLast([`{${params.join(', ')}}`, `{${data.map((value) => number(value, CPP)).join(', ')}}`, quoted(text)], empty);
  const python = [];
  if (!empty[0]) python.push(`params=[${params.join(', ')}]`);
  if (!empty[1]) python.push(`data=[${data.map((value) => number(value, PYTHON)).join(', ')}]`);
  if (!empty[2]) python.push(`text=${quoted(text)}`);
  return {
    MATLAB: `reply = sim.call('${module}', '${name}'${matlab.map((arg) => `, ${arg}`).join('')})`,
    Python: `reply = sim.call("${module}", "${name}"${python.map((arg) => `, ${arg}`).join('')})`,
    'C++': `sim.call("${module}", "${name}"${cpp.map((arg) => `, ${arg}`).join('')});`,
    telnet,
  };
}

/** The line that opens a robot in a language. */
const robotLine = (language, robot) => ({MATLAB: `${variableOf(robot)} = sim.robot('${robot}');`, Python: `${variableOf(robot)} = sim.robot("${robot}")`,
  'C++': `auto ${variableOf(robot)} = sim.robot("${robot}");`})[language];

/** The code before the first command: connects to the name server at this host and port, and opens the robots that `lines` drive. */
export function headOf(language, host, namePort, lines = [], robots = []) {
  const used = language === 'telnet' ? [] : robots.filter((robot) => lines.some((line) => line.startsWith(`${variableOf(robot)}.`)));
  return [connectionOf(language, host, namePort), ...used.map((robot) => robotLine(language, robot))].join('\n');
}

function connectionOf(language, host, namePort) {
  const server = namePort === DEFAULT_NAME_PORT ? host : `${host}:${namePort}`;
  switch (language) {
    case 'MATLAB': return `sim = coopdyn.connect(${connectArguments(language, server, "'")});`;
    case 'Python': return `import coopdyn\nsim = coopdyn.connect(${connectArguments(language, server)})`;
    case 'C++': return `auto sim = coopdyn::client::connect(${connectArguments(language, server)});`;
    default: return `telnet ${host.replace(/^\[|\]$/g, '')} ${namePort}${SEAT ? `\nSEAT ${SEAT.name} PIN` : ''}`;
  }
}

/** A program of such commands. In telnet, each connection leads to one module. */
export function programOf(language, host, namePort, lines, robots = []) {
  const head = headOf(language, host, namePort, lines, robots);
  if (language === 'C++') {
    const body = [...head.split('\n'), ...lines].map((line) => `  ${line}`).join('\n');
    return `#include <cmath>\n\n#include "clients/cpp/coopdyn_client.h"\n\nint main() {\n${body}\n}\n`;
  }
  if (language !== 'telnet') return `${[head, ...lines].join('\n')}\n`;
  const parts = [];
  for (const line of lines) {
    const [open, command] = line.split('\n');
    if (parts.at(-1)?.open === open) parts.at(-1).commands.push(command);
    else parts.push({open, commands: [command]});
  }
  return parts.map(({open, commands}) => [head, open, ...commands, 'exit'].join('\n')).join('\n') + '\n';
}
