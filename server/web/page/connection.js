// SPDX-License-Identifier: MIT
// The WebSocket to the daemon: calls with replies, pushes, status and pictures. Reconnects automatically.
import {t} from './words.js';

const SILENCE_MS = 2000;  // the status comes five times a second
const REFUSED_MS = 1000;

/** The address of a WebSocket at `path`, relative to the page. */
export function socketAddress(path) {
  const address = new URL(path, location.href);
  address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  return address;
}

export class Connection extends EventTarget {
  #socket = null;
  #next = 1;
  #waiting = new Map();
  #retry = 250;
  #heard = 0;
  #silence = 0;
  #token;
  #mayOpen;

  /** `mayOpen`: asked before each try to reconnect; resolves to whether to try now.
   *  Events: open, lost, hello (detail: {trusted, pictures, version}; wrong_token: true if the token sent is wrong;
   *  token_wait: after too many wrong ones, how long tokens are ignored), status (detail: object or null),
   *  silence (no status for two seconds), picture (detail: {about, jpeg}), poses and sensors (detail: the message), push (detail: message). */
  constructor(token, mayOpen = async () => true) {
    super();
    this.#token = token;
    this.#mayOpen = mayOpen;
    this.open();
    setInterval(() => {
      // The status comes five times a second; silence means that the daemon hangs or the cable is out.
      if (this.isOpen && performance.now() - this.#heard > 6000) this.#socket.close();
    }, 1000);
  }

  /** When this page last asked for a change of the run. */
  actedAt = -Infinity;

  /** Whether the daemon draws pictures: not with --no-render. */
  draws = true;

  get isOpen() { return this.#socket?.readyState === WebSocket.OPEN; }
  get token() { return this.#token; }

  /** Sends the token that gives this page its rights; a hello event follows. */
  unlock(token) {
    this.#token = token;
    this.send({type: 'hello', token});
  }

  /** Sends no token after reconnecting. */
  forgetToken() { this.#token = ''; }

  send(message) {
    if (this.isOpen) this.#socket.send(JSON.stringify(message));
  }

  /** Calls a module: {module, command, params, data, text} or {module, line}. Resolves to the reply, even an
   *  error; `error` is −1 if the connection was lost. */
  call(request) {
    return new Promise((resolve) => {
      if (!this.isOpen) return resolve({error: -1, text: t('the daemon does not answer'), params: [], data: []});
      const id = this.#next++;
      if (/^\/(simulation|world|playback)$/.test(request.module) && !/^(get_|list|save|describe)/.test(request.command ?? '')) {
        this.actedAt = performance.now();
      }
      this.#waiting.set(id, resolve);
      this.send({id, ...request});
    });
  }

  async #reopen() {
    if (await this.#mayOpen()) this.open();
    else setTimeout(() => this.#reopen(), REFUSED_MS);
  }

  /** Connects, unless it is connected or connecting. */
  open() {
    if (this.#socket && this.#socket.readyState !== WebSocket.CLOSED) return;
    const socket = new WebSocket(socketAddress('ws'));
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    socket.onopen = () => {
      this.#retry = 250;
      this.#heard = performance.now();
      if (this.#token) this.send({type: 'hello', token: this.#token});
      this.#awaitStatus();
      this.dispatchEvent(new Event('open'));
    };
    socket.onmessage = ({data}) => {
      this.#heard = performance.now();
      if (typeof data === 'string') this.#onText(JSON.parse(data));
      else this.#onBytes(data);
    };
    socket.onclose = () => {
      clearTimeout(this.#silence);
      for (const resolve of this.#waiting.values()) {
        resolve({error: -1, text: t('the connection to the daemon was lost'), params: [], data: []});
      }
      this.#waiting.clear();
      this.dispatchEvent(new Event('lost'));
      setTimeout(() => this.#reopen(), this.#retry);
      this.#retry = Math.min(2 * this.#retry, 2000);
    };
  }

  #onText(message) {
    if (message.type) {
      if (message.type === 'status') this.#awaitStatus();
      if (message.type === 'hello') this.draws = message.pictures;
      const detail = message.type === 'status' ? message.status : message;
      this.dispatchEvent(new CustomEvent(message.type, {detail}));
    } else if (message.push) {
      this.dispatchEvent(new CustomEvent('push', {detail: message}));
    } else {
      const resolve = this.#waiting.get(message.id);
      this.#waiting.delete(message.id);
      resolve?.(message);
    }
  }

  #awaitStatus() {
    clearTimeout(this.#silence);
    this.#silence = setTimeout(() => this.dispatchEvent(new Event('silence')), SILENCE_MS);
  }

  /** The first byte is the type: 1 a picture, 2 poses, 3 what sensors show. */
  #onBytes(buffer) {
    const view = new DataView(buffer);
    if (view.getUint8(0) === 2) {
      this.received = (this.received ?? 0) + buffer.byteLength;
      this.dispatchEvent(new CustomEvent('poses', {detail: buffer}));
      return;
    }
    if (view.getUint8(0) === 3) return void this.dispatchEvent(new CustomEvent('sensors', {detail: buffer}));
    const length = view.getUint32(1, true);
    const about = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 5, length)));
    const jpeg = new Blob([new Uint8Array(buffer, 5 + length)], {type: 'image/jpeg'});
    this.dispatchEvent(new CustomEvent('picture', {detail: {about, jpeg}}));
  }
}
