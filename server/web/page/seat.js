// SPDX-License-Identifier: MIT
// The seat of a class whose page this is, by the page's address: /s/ana/, and for the teacher /wall/s/ana/.
const [, wall, name] = /^\/(wall\/)?s\/([^/]+)\//.exec(globalThis.location?.pathname ?? '') ?? [];

/** {name, teaches}; null: this daemon belongs to no class. */
export const SEAT = name ? {name, teaches: wall !== undefined} : null;

/** The address of the host's `what` ("me", "events", …) for this page. */
export const hostAddress = (what) => `${SEAT.teaches ? '../../' : ''}class/${what}`;

/** The address of `what` ("", "run", "stop", "output/") of this seat's program. */
export const programAddress = (what = '') => hostAddress((SEAT.teaches ? `programs/${SEAT.name}` : 'program') + (what && `/${what}`));

/** What the host says of this seat: of what it sends a student (docs/protocol.md), or of what the wall gets. */
export const seatIn = (said) => (SEAT.teaches ? {...said.seats.find(({seat}) => seat === SEAT.name), names: said.names} : said);

/** Asks the host. Rejects if it does not answer. */
export async function askHost() {
  const answer = await fetch(hostAddress(SEAT.teaches ? 'seats' : 'me'));
  if (!answer.ok) throw new Error(await answer.text());
  return seatIn(await answer.json());
}

/** fetch() of what a page asks by itself: it does not start a seat that is being put aside. */
export const ask = (path) => fetch(SEAT ? `${path}?wake=no` : path);

/** Whether a page may connect to its seat: one that was put aside would start again. No, while the host does not answer. */
export const isAwake = () => askHost().then(({daemon}) => daemon !== 'asleep', () => false);

/** What connect() is given in a language: the server, and the seat. Students know their PIN. */
export function connectArguments(language, server, quote = '"') {
  const text = (value) => quote + value + quote;
  const forms = {
    MATLAB: ({name: seat}) => [text('seat'), text(seat), text('pin'), text('PIN')],
    Python: ({name: seat}) => [`seat=${text(seat)}`, `pin=${text('PIN')}`],
    'C++': ({name: seat}) => [`{.seat = ${text(seat)}, .pin = ${text('PIN')}}`],
  };
  return [text(server), ...(SEAT ? forms[language](SEAT) : [])].join(', ');
}
