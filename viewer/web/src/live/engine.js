// In the place of a server: the engine as WebAssembly, carried by the page, in a worker of it.
// viewer/live_page.cpp writes what is read here; the other end of the messages is live/wasm/worker.js.
import { inflate } from '../data.js';
import { Connection, Refusal } from './connection.js';

const carried = (kind) => [...document.querySelectorAll(`script.isochor-${kind}`)];
const text = (bytes) => new TextDecoder().decode(bytes);

export class Engine extends Connection {
  static isCarried() { return carried('engine').length > 0; }

  constructor() {
    super('');
    this.waiting = new Map();
    this.asked = 0;
    this.worker = this.start();
  }

  get silence() { return 'The engine of this page has ended; load the page again.'; }

  async start() {
    const [loader, engine, scene] = await Promise.all(['loader', 'engine', 'scene'].map((kind) => inflate(carried(kind)[0].textContent)));
    const files = await Promise.all(carried('file').map(async (file) => [file.dataset.name, await inflate(file.textContent)]));
    const worker = new Worker(URL.createObjectURL(new Blob([loader], { type: 'text/javascript' })));
    const opened = new Promise((done, fail) => {
      worker.onmessage = ({ data }) => {
        if (data.opened !== undefined) {
          if (data.opened === '') done();
          else fail(new Refusal(400, data.opened));
          return;
        }
        const waits = this.waiting.get(data.id);
        this.waiting.delete(data.id);
        waits?.(data);
      };
      worker.onerror = (event) => {
        event.preventDefault();
        const why = `${event.message || 'the worker did not start'}; the page needs Chrome 95, Firefox 113, Safari 16.4 or a later one`;
        fail(new Refusal(403, why));
        for (const waits of this.waiting.values()) waits({ status: 500, body: new TextEncoder().encode(JSON.stringify({ error: this.silence })) });
        this.waiting.clear();
      };
    });
    const playing = carried('engine')[0].dataset.name === 'playing';
    worker.postMessage({ open: { engine, scene: text(scene), files, playing } }, [engine.buffer]);
    await opened;
    return worker;
  }

  /** As of a server; the answer has what is used of a Response. */
  async ask(path, { body = '' } = {}) {
    const worker = await this.worker;
    const id = ++this.asked;
    const answer = await new Promise((done) => {
      this.waiting.set(id, done);
      worker.postMessage({ id, path, viewer: this.viewer, body });
    });
    if (answer.status < 400) return new Response(answer.body);
    throw new Refusal(answer.status, JSON.parse(text(answer.body)).error);
  }
}
