// SPDX-License-Identifier: MIT
// The process of a seat's daemon.
import {readdirSync, readFileSync} from 'node:fs';
import {join} from 'node:path';

/** The process id. `folder`: of the class. */
export function seatDaemon(folder, seat) {
  const door = join(folder, 'seats', seat, 'door');
  return readdirSync('/proc').filter((name) => /^\d+$/.test(name)).map(Number).find((id) => {
    try { return readFileSync(`/proc/${id}/cmdline`, 'utf8').split('\0').includes(door); } catch { return false; }
  });
}
