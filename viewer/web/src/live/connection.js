// Talks to the server that this page comes from. One picture is asked for at a time, when the last one is about to be
// drawn: what is sent is always the newest, and a page that is slow gets fewer of them.

/** Reads what live/message.cpp wrote: JSON, then arrays in the order of its counts. */
export class Message {
  constructor(buffer) {
    this.buffer = buffer;
    const length = new DataView(buffer).getUint32(0, true);
    this.head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    this.at = 4 + length;
  }

  take(ArrayType, count) {
    const from = this.at;
    this.at += 4 * count;
    if (this.at > this.buffer.byteLength) throw new Error('a message of the server is cut short');
    return new ArrayType(this.buffer, from, count); // little-endian, as every machine that runs a browser is
  }

  floats(count) { return this.take(Float32Array, count); }
  integers(count) { return this.take(Uint32Array, count); }
}

/** What the server says when it refuses; `status` is that of HTTP. */
export class Refusal extends Error {
  constructor(status, sentence) {
    super(sentence);
    this.status = status;
  }
}

export class Connection {
  constructor(token) {
    this.token = token;
    this.viewer = '';
    this.sending = Promise.resolve();
    this.pending = new Map();
  }

  /** What is said where no answer comes. */
  get silence() { return 'The server does not answer; has it ended? Trying again.'; }

  async ask(path, options = {}) {
    const answer = await fetch(path, {
      ...options, cache: 'no-store', headers: { 'X-Isochor-Token': this.token, 'X-Isochor-Viewer': this.viewer },
    });
    if (answer.ok) return answer;
    let sentence = `the server answers ${answer.status}`;
    try { sentence = (await answer.json()).error ?? sentence; } catch { /* the number has to do */ }
    throw new Refusal(answer.status, sentence);
  }

  /** The scene, as a new viewer. */
  async join() {
    this.viewer = '';
    const { viewer } = await (await this.ask('/join', { method: 'POST' })).json();
    this.viewer = viewer;
    return new Message(await (await this.ask('/scene')).arrayBuffer());
  }

  /** When the page goes; nobody waits for an answer. */
  leave() {
    if (this.viewer) this.ask('/leave', { method: 'POST', keepalive: true }).catch(() => {});
  }

  async picture(after, field, wants) {
    const query = new URLSearchParams({ after: String(after), field, wants });
    return new Message(await (await this.ask(`/picture?${query}`)).arrayBuffer());
  }

  /** In the order in which they are given; resolves to the sentence of a refusal, or null. */
  send(command) {
    const done = this.sending.then(async () => {
      try {
        await this.ask('/command', { method: 'POST', body: JSON.stringify(command) });
        return null;
      } catch (error) {
        return error.message;
      }
    });
    this.sending = done;
    return done;
  }

  /** Of commands with the same key the last one counts: a slider does not queue up what it has passed. */
  sendLatest(key, command) {
    const waiting = this.pending.get(key);
    if (waiting) {
      waiting.command = command;
      return waiting.done;
    }
    const entry = { command };
    this.pending.set(key, entry);
    entry.done = this.sending.then(() => {
      this.pending.delete(key);
      return this.send(entry.command);
    });
    return entry.done;
  }
}
