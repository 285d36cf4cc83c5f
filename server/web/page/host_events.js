// SPDX-License-Identifier: MIT
// Requests to the host of a class, and its events.
import {t} from './words.js';

const RETRY_MS = 2000;

/** Sends JSON. {error, ...answer}: the error is a text to show, empty if there is none. */
export async function post(address, body) {
  try {
    const answer = await fetch(address, {method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body)});
    const text = await answer.text();
    return answer.ok ? {error: '', ...JSON.parse(text)} : {error: text.trim() || t('the host answers {status}', {status: answer.status})};
  } catch {
    return {error: t('the host does not answer: try again in a moment')};
  }
}

/** Calls `take` with each event of the stream at `address`, `lost` whenever the stream breaks, and `refused` when the host says
 *  at `probe` that we may not have it. Goes on by itself when the host starts again. */
export function follow(address, probe, {take, lost = () => {}, refused}) {
  const events = new EventSource(address);
  events.onmessage = ({data}) => take(JSON.parse(data));
  events.onerror = async () => {
    lost();
    if (events.readyState !== EventSource.CLOSED) return;  // the browser tries again
    const answer = await fetch(probe).catch(() => null);
    if (answer?.status === 403) return refused();
    setTimeout(() => follow(address, probe, {take, lost, refused}), RETRY_MS);
  };
}
