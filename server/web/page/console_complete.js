// SPDX-License-Identifier: MIT
// Completions and hints for a console line, from the `describe` of its module. No drawing.
import {t} from './words.js';

/** The longest common prefix of `words`. */
export function commonStart(words) {
  let start = words[0] ?? '';
  for (const word of words) {
    while (!word.startsWith(start)) start = start.slice(0, -1);
  }
  return start;
}

/** The spec of value `at`. A group of repeated specs at the end of `specs` recurs without limit. */
export function specAt(specs, at) {
  const repeated = specs.findIndex((spec) => spec.repeated);
  if (repeated < 0 || at < repeated) return specs[at];
  return specs[repeated + (at - repeated) % (specs.length - repeated)];
}

/** The place at the end of the line: {word} in the command; {command, at, start, token, spec} in an argument: its index, where
 *  its token begins, the token, and its spec. */
export function placeIn(line, commands) {
  const text = line.trimStart(), offset = line.length - text.length;
  const [word] = text.match(/^[^\s(]*/);
  const command = commands.find(({name}) => name === word);
  if (text.length === word.length || !command) return {word, command};
  let rest = text.slice(word.length), start = offset + word.length;
  let specs = command.data.length > 0 ? command.data : command.params;
  const bracket = rest.match(/^\s*\(([^)]*)(\)?)/);
  if (bracket && !bracket[2]) {
    specs = command.params;
    start += rest.indexOf('(') + 1;
    rest = bracket[1];
  } else if (bracket) {
    start += bracket[0].length;
    rest = rest.slice(bracket[0].length);
  }
  const tokens = rest.split(/[\s,[\]]+/);
  if (tokens[0] === '' && tokens.length > 1) tokens.shift();
  const token = tokens.at(-1), at = Math.max(0, tokens.length - 1);
  const isText = !bracket && (command.text === 'rest' || (command.text === 'first' && at === 0) ||
    (command.text === 'or_number' && !/^[\d+-]/.test(token)));
  return {word, command, at, token, start: start + rest.length - token.length, isText,
    spec: isText ? null : specAt(specs, command.text === 'first' ? Math.max(0, at - 1) : at)};
}

/** Completions at a place; `names` has lists by the kind of name: ROBOT, MODULE, SCENARIO, … */
export function wordsAt(place, commands, names) {
  if (!('at' in place)) return commands.map(({name}) => name).filter((name) => name.startsWith(place.word));
  const {command, at, token, spec, isText} = place;
  let words = [];
  if (isText) {
    const [first] = command.text_name.match(/[A-Z_]+/) ?? [];
    words = names[first] ?? [];
  } else if (spec?.enums.length > 0) {
    words = spec.enums.map(({word}) => word);
  }
  if (words.length === 0 && token === '') {
    const example = command.example.slice(command.name.length).trim().replace(/^\([^)]*\)\s*/, '').split(/\s+/);
    if (example[at]) words = [example[at]];
  }
  return words.filter((word) => word.startsWith(token));
}

/** "angular: rad/s, from −1 to 1"; empty if unknown. */
export function aboutPlace(place) {
  if (!('at' in place)) return '';
  if (place.isText) return place.command.text_name ? t('now: {what}', {what: place.command.text_name}) : '';
  const {spec} = place;
  if (!spec) return '';
  const parts = [spec.name];
  if (spec.unit) parts.push(spec.unit);
  if (spec.enums.length > 0) parts.push(spec.enums.map(({word}) => word).join(' | '));
  if (spec.min !== null && spec.max !== null) parts.push(t('{from} to {to}', {from: spec.min, to: spec.max}));
  else if (spec.min !== null) parts.push(t('from {from}', {from: spec.min}));
  return t('now: {what}', {what: parts.join(', ')}) + (spec.optional ? ` ${t('(may be left out)')}` : '');
}

/** The reply in words: "left_speed 1.5 rad/s, …; t 2.4 s, step 240"; empty if its line says all. */
export function explain(command, reply) {
  const MOST = 24;
  if (!command || reply.error !== 0 || reply.data.length > MOST + 2 || reply.params.length > MOST) return '';
  const short = (value) => (typeof value === 'number' ? String(Number(value.toPrecision(6))) : String(value));
  const word = (value, spec) => spec.enums.find((one) => one.value === value)?.word ?? short(value);
  const show = (specs, values) => values.map((value, i) => {
    const spec = specAt(specs, i);
    return spec ? `${spec.name} ${word(value, spec)}${spec.unit ? ` ${spec.unit}` : ''}` : short(value);
  });
  const values = [...show(command.reply_params, reply.params), ...show(command.reply_data, reply.data.slice(0, -2))];
  const [time, step] = reply.data.slice(-2);
  if (time !== undefined && step !== undefined) values.push(t('at {time} s, step {step}', {time, step}));
  return values.join(', ');
}
