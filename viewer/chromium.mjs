// A headless Chromium over its debugging pipe: enough to open a page, ask it things and take its picture.
// No package is needed, so pictures can be made wherever node and a browser are.
import { spawn } from 'node:child_process';
import { accessSync, constants, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { delimiter, join } from 'node:path';

const NAMES = ['chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable'];

/** The first browser on PATH, or null. */
export function findChromium() {
  for (const folder of (process.env.PATH ?? '').split(delimiter)) {
    for (const name of NAMES) {
      const path = join(folder, name);
      try {
        accessSync(path, constants.X_OK);
        return path;
      } catch { /* look further */ }
    }
  }
  return null;
}

export const MISSING = `No Chromium found: none of ${NAMES.join(', ')} is on PATH.`;

// Software rendering gives the same picture on every machine: WebGL by SwiftShader, the rest by the processor, as a
// browser does without a graphics card. Nothing may reach the network.
const FLAGS = [
  '--headless=new', '--no-sandbox', '--remote-debugging-pipe', '--disable-gpu', '--enable-unsafe-swiftshader',
  '--disable-quic', '--no-first-run', '--no-default-browser-check', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--disable-extensions', '--disable-default-apps',
  '--disable-dev-shm-usage', '--hide-scrollbars', '--mute-audio',
  '--proxy-server=127.0.0.1:9', '--force-color-profile=srgb',
];

export class Browser {
  static async launch({ timeout = 300000 } = {}) {
    const path = findChromium();
    if (!path) throw new Error(MISSING);
    const browser = new Browser();
    browser.profile = mkdtempSync(join(tmpdir(), 'isochor-browser-'));
    browser.child = spawn(path, [...FLAGS, `--user-data-dir=${browser.profile}`, 'about:blank'], {
      stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe'], detached: true,
    });
    browser.waiting = new Map();
    browser.listeners = new Set();
    browser.next = 1;
    browser.timeout = timeout;
    browser.log = '';
    browser.child.stderr.on('data', (data) => { browser.log = (browser.log + data).slice(-4000); });
    browser.child.on('exit', () => {
      for (const { reject } of browser.waiting.values()) reject(new Error(`Chromium ended early:\n${browser.log}`));
      browser.waiting.clear();
    });
    let rest = Buffer.alloc(0);
    browser.child.stdio[4].on('data', (data) => {
      rest = Buffer.concat([rest, data]);
      for (let end; (end = rest.indexOf(0)) >= 0; rest = rest.subarray(end + 1)) {
        browser.receive(JSON.parse(rest.subarray(0, end).toString('utf8')));
      }
    });
    browser.child.stdio[3].on('error', () => {}); // the exit handler says it better
    return browser;
  }

  receive(message) {
    const waiting = this.waiting.get(message.id);
    if (!waiting) {
      for (const listener of this.listeners) listener(message);
      return;
    }
    this.waiting.delete(message.id);
    if (message.error) waiting.reject(new Error(`${waiting.method}: ${message.error.message}`));
    else waiting.resolve(message.result);
  }

  send(method, params = {}, sessionId = undefined) {
    const id = this.next++;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => {
        this.waiting.delete(id);
        reject(new Error(`${method} got no answer from Chromium in ${this.timeout / 1000} s`));
      }, this.timeout);
      const settle = (done) => (value) => { clearTimeout(timer); done(value); };
      this.waiting.set(id, { method, resolve: settle(resolve), reject: settle(reject) });
      this.child.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    });
  }

  /** Opens an address in a window of this size; everything the page complains about lands in page.errors. */
  async open(url, { width = 1280, height = 800, scale = 1, dark = false } = {}) {
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
    const page = new Page(this, sessionId, targetId);
    await page.send('Page.enable');
    await page.send('Runtime.enable');
    await page.send('Log.enable');
    await page.resize(width, height, scale);
    await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }] });
    await page.send('Page.navigate', { url });
    return page;
  }

  async close() {
    const gone = new Promise((done) => { this.child.once('exit', done); });
    if (this.child.exitCode === null && this.child.signalCode === null) {
      await this.send('Browser.close').catch(() => {});
      const timer = setTimeout(() => {
        // Its own process group only: the browser's helpers, nobody else's.
        try { process.kill(-this.child.pid, 'SIGKILL'); } catch { /* already gone */ }
      }, 5000);
      await gone;
      clearTimeout(timer);
    }
    rmSync(this.profile, { recursive: true, force: true, maxRetries: 5, retryDelay: 100 });
  }
}

class Page {
  constructor(browser, session, target) {
    Object.assign(this, { browser, session, target, errors: [] });
    this.listener = (message) => {
      if (message.sessionId !== session) return;
      const { method, params } = message;
      if (method === 'Runtime.exceptionThrown') {
        this.errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
      } else if (method === 'Runtime.consoleAPICalled' && ['error', 'warning', 'assert'].includes(params.type)) {
        this.errors.push(params.args.map((a) => a.value ?? a.description).join(' '));
      } else if (method === 'Log.entryAdded' && params.entry.level === 'error') {
        this.errors.push(params.entry.text);
      }
    };
    browser.listeners.add(this.listener);
  }

  send(method, params) { return this.browser.send(method, params, this.session); }

  resize(width, height, scale = 1) {
    return this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: scale, mobile: false });
  }

  /** Value of an expression; promises are awaited. */
  async evaluate(expression) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /** The timeout is for what never comes: on a machine with other work a minute is not long. */
  async waitFor(expression, timeout = 300000) {
    const end = Date.now() + timeout;
    for (;;) {
      if (await this.evaluate(expression).catch(() => false)) return;
      if (Date.now() > end) throw new Error(`waited ${timeout / 1000} s for: ${expression}\n${this.errors.join('\n')}`);
      await new Promise((done) => setTimeout(done, 30));
    }
  }

  /** PNG bytes of the window, of the whole page, or of a rectangle {x, y, width, height}. */
  async picture({ whole = false, clip = undefined } = {}) {
    const { data } = await this.send('Page.captureScreenshot', {
      format: 'png', captureBeyondViewport: whole, ...(clip ? { clip: { ...clip, scale: 1 } } : {}),
    });
    return Buffer.from(data, 'base64');
  }

  async key(key, modifiers = 0) {
    const text = key.length === 1 ? { text: key } : {};
    await this.send('Input.dispatchKeyEvent', { type: 'keyDown', key, modifiers, ...text });
    await this.send('Input.dispatchKeyEvent', { type: 'keyUp', key, modifiers });
  }

  async close() {
    this.browser.listeners.delete(this.listener);
    await this.browser.send('Target.closeTarget', { targetId: this.target });
  }
}
