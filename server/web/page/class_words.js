// SPDX-License-Identifier: MIT
// What the pages of a class say: states of seats, orders of the teacher, and what students read.

const LANGUAGES = {python: 'Python', matlab: 'MATLAB', octave: 'Octave', cpp: 'C++', telnet: 'telnet', page: 'the page'};
export const languageText = (language) => LANGUAGES[language?.toLowerCase()] ?? language ?? '';

/** [key, text]: the state of a seat in the wall's events. `moves`: its time goes on. The key chooses the colour. */
export function stateOf(seat, moves) {
  if (seat.daemon === 'failed') return ['crashed', 'crashed'];
  if (seat.daemon === 'asleep') return ['asleep', 'asleep'];
  if (seat.daemon === 'starting') return ['starting', 'starting'];
  if (seat.frozen) return ['frozen', 'frozen'];
  switch (seat.state) {
    case undefined: return ['starting', 'starting'];
    case 'waiting': return moves ? ['running', 'running'] : ['waiting', 'waits for its program'];
    case 'ended': return ['ended', seat.ended ? `ended: ${seat.ended}` : 'ended'];
    case 'running': case 'paused': return [seat.state, seat.state];
    default: return ['paused', seat.state];
  }
}

/** "now", "40 s", "12 min", "2 h": how long nothing has happened. */
export function idleText(seconds) {
  if (seconds < 10) return 'now';
  if (seconds < 60) return `${10 * Math.floor(seconds / 10)} s`;
  return seconds < 3600 ? `${Math.floor(seconds / 60)} min` : `${Math.floor(seconds / 3600)} h`;
}

/** The host's word for a trouble, as one tells it to the student. */
export const troubleText = (trouble) => trouble.replace(/^its daemon/, 'Your simulation');

/** "20261129-181523" as "18:15". */
export const whenText = (when) => when.replace(/^\d{8}-(\d\d)(\d\d).*$/, '$1:$2');

const KEPT = {'recording.run': 'the recording of your run', 'program.py': 'your program', 'output.txt': 'what it printed'};
/** What was handed in, in words. */
export const keptText = (files = []) => (files.length > 0 ? files.map((file) => KEPT[file] ?? file).join(', ') : 'nothing yet: run something first');

/** The teacher's orders. `title` and `hint` of the button; `asks`: what happens, for the question before it is done to many;
 *  `text`: the question for the text that it needs. */
export const ORDERS = {
  freeze: {title: 'Freeze', hint: 'The worlds stand still, and students may only watch', done: 'frozen'},
  thaw: {title: 'Thaw', hint: 'The worlds go on', done: 'thawed'},
  take: {title: 'Take over', hint: 'You drive; the student watches', done: 'you drive', asks: 'Their programs cannot drive until you give the seats back.'},
  give: {title: 'Give back', hint: 'The student drives again', done: 'given back'},
  reset: {title: 'Reset', hint: 'The run begins again at zero', done: 'reset', asks: 'Their runs begin again at zero.'},
  restart: {title: 'Restart lesson', hint: 'Starts the simulation anew with the scenario of the lesson', done: 'begins the lesson anew',
    asks: 'Their simulations start anew with the scenario of the lesson. Their recordings stay.'},
  push: {title: 'Push scenario', hint: 'Loads another scenario: a name, or a text', done: 'told to load the scenario',
    asks: 'It replaces the worlds that they have now.', text: 'Name of a scenario, or its whole text'},
  message: {title: 'Message', hint: 'Appears on the student’s page', done: 'message sent', text: 'Message'},
  lower_hand: {title: 'Lower hand', hint: 'The question is answered', done: 'hand lowered'},
  aside: {title: 'Put aside', hint: 'Ends the simulation; it goes on where it was when somebody comes', done: 'put aside',
    asks: 'Their simulations end, and go on where they were when somebody comes.'},
  next: {title: 'Next', hint: 'Everybody loads the next scenario of the lesson', done: 'told to load the next scenario',
    asks: 'It replaces the worlds that they have now.'},
};

/** "Ana Lima, Ben Okafor and 28 more". */
export function namesText(names, shown = 6) {
  if (names.length === 1) return names[0];
  if (names.length <= shown) return `${names.slice(0, -1).join(', ')} and ${names.at(-1)}`;
  return `${names.slice(0, shown).join(', ')} and ${names.length - shown} more`;
}
export const studentsText = (count) => `${count} student${count === 1 ? '' : 's'}`;
