// SPDX-License-Identifier: MIT
// Asks for name and PIN, and leads to the student's seat.
import {hostText, sentenceOf} from './class_words.js';
import {byId, setText} from './dom.js';
import {post} from './host_events.js';

byId('login').addEventListener('submit', async (event) => {
  event.preventDefault();
  const button = byId('login').querySelector('button');
  button.disabled = true;
  const {error, go} = await post('login', {name: byId('name').value.trim(), pin: byId('pin').value.trim()});
  button.disabled = false;
  setText(byId('answer'), sentenceOf(hostText(error)));
  if (!error) return location.assign(go);
  byId('pin').select();
});
