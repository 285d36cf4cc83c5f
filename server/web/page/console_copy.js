// SPDX-License-Identifier: MIT
// A command of the console in the languages of our clients: text that runs. No drawing.

const DEFAULT_NAME_PORT = 10000;

/** A text in quotes that Python and C++ read alike. */
function quoted(text) {
  const escaped = [...text].map((char) => {
    const known = {'"': '\\"', '\\': '\\\\', '\n': '\\n', '\r': '\\r', '\t': '\\t'}[char];
    if (known) return known;
    const code = char.codePointAt(0);
    return code < 32 || code === 127 ? `\\${code.toString(8).padStart(3, '0')}` : char;
  });
  return `"${escaped.join('')}"`;
}

/** A text that MATLAB and Octave read alike: there '\n' is two signs. */
function matlabText(text) {
  const parts = text.split(/([\n\r\t])/).filter(Boolean);
  const terms = parts.map((part) => ('\n\r\t'.includes(part) ? `char(${part.charCodeAt(0)})` : `'${part.replaceAll("'", "''")}'`));
  return terms.length === 1 && terms[0].startsWith("'") ? terms[0] : `[${terms.join(' ')}]`;
}

/** Numbers as they come: "inf", "-inf", "nan" are not finite. */
const number = (value, names) => (typeof value === 'number' ? String(value) : names[value] ?? String(value));
const MATLAB = {inf: 'Inf', '-inf': '-Inf', nan: 'NaN'};
const PYTHON = {inf: 'float("inf")', '-inf': 'float("-inf")', nan: 'float("nan")'};
const CPP = {inf: 'INFINITY', '-inf': '-INFINITY', nan: 'NAN'};

/** Without what follows the last argument that says something. */
function upToLast(args, isEmpty) {
  let count = args.length;
  while (count > 0 && isEmpty[count - 1]) --count;
  return args.slice(0, count);
}

/** `sent`: {module, name, line, params, data, text}; name null: only a line. {MATLAB, Python, C++, telnet}, each a text. */
export function inLanguages({module, name, line, params = [], data = [], text = ''}) {
  const telnet = `OPEN ${module}\n${line}`;
  if (name === null) return {telnet};
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

/** What stands before the first such line, with this host and port of names. */
export function headOf(language, host, namePort) {
  const server = namePort === DEFAULT_NAME_PORT ? host : `${host}:${namePort}`;
  switch (language) {
    case 'MATLAB': return `sim = coopdyn.connect('${server}');`;
    case 'Python': return `import coopdyn\nsim = coopdyn.connect("${server}")`;
    case 'C++': return `auto sim = coopdyn::client::connect("${server}");`;
    default: return `telnet ${host.replace(/^\[|\]$/g, '')} ${namePort}`;
  }
}

/** A program of such lines. A telnet connection leads to one module. */
export function programOf(language, host, namePort, lines) {
  const head = headOf(language, host, namePort);
  if (language === 'C++') {
    const body = [head, ...lines].map((line) => `  ${line}`).join('\n');
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
