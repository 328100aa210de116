// The worker of a page without a server: gives the engine its turns, and answers what the page would ask of
// live/server.cpp. Stands behind what Emscripten makes (makeIsochor), in one script.
/* global makeIsochor */
const PATIENCE = 800; // ms, that a picture is waited for, as in live/hub.cpp

let engine = null; // the module
let over = null; // the answer to everything, once it has ended
let timer = null;
const pictures = []; // requests that wait for the next one
// Between two turns messages are looked at; timers would wait for 4 ms.
const again = new MessageChannel();
let begun = false; // one of these turns
again.port1.onmessage = () => {
  begun = false;
  work();
};

const call = (name, types = [], values = []) => engine.ccall(`isochor_${name}`, 'number', types.map(() => 'string'), values);

/** A copy of the last answer, which may be given away. */
function answerOf(status) {
  const from = engine._isochor_answer();
  return { status, body: engine.HEAPU8.slice(from, from + engine._isochor_answer_size()).buffer };
}

const sentenceOf = (answer) => JSON.parse(new TextDecoder().decode(answer.body)).error;

function give(id, answer) {
  if (over) postMessage({ id, ...over });
  else postMessage({ id, ...answer }, [answer.body]);
}

function answer({ id, path, viewer, body }) {
  const [what, query] = path.split('?');
  if (over) give(id);
  else if (what === '/picture') {
    const wish = new URLSearchParams(query);
    pictures.push({ id, viewer, after: wish.get('after'), field: wish.get('field'), wants: wish.get('wants'), until: performance.now() + PATIENCE });
    has(pictures.at(-1)); // tells the engine what is wanted
  } else if (what === '/command') give(id, answerOf(call('command', ['', ''], [viewer, body])));
  else if (what === '/scene') give(id, answerOf(call('scene', [''], [viewer])));
  else if (what === '/leave') give(id, answerOf(call('leave', [''], [viewer])));
  else give(id, answerOf(call('join')));
}

const has = ({ after, field }) => engine.ccall('isochor_has_picture', 'number', ['number', 'string'], [Number(after), field]) !== 0;

function serve() {
  for (const asked of pictures.splice(0)) {
    if (over || performance.now() >= asked.until || has(asked)) {
      give(asked.id, over ?? answerOf(call('picture', ['', '', '', ''], [asked.viewer, asked.after, asked.field, asked.wants])));
    } else pictures.push(asked);
  }
}

function work() {
  clearTimeout(timer);
  if (over) return;
  const wait = engine._isochor_turn();
  if (wait < 0) over = answerOf(500);
  serve();
  if (wait === 0 && !begun) {
    begun = true;
    again.port2.postMessage(0);
  } else if (wait > 0) timer = setTimeout(work, wait);
}

async function open({ engine: wasmBinary, scene, files, playing }) {
  engine = await makeIsochor({ wasmBinary });
  engine.FS.mkdir('/scene');
  for (const [name, bytes] of files) engine.FS.writeFile(`/scene/${name}`, bytes);
  const status = engine.ccall('isochor_open', 'number', ['string', 'string', 'number'], [scene, '/scene', playing ? 1 : 0]);
  if (status !== 200) return sentenceOf(answerOf(status));
  work();
  return '';
}

onmessage = ({ data }) => {
  if (data.open) {
    open(data.open).then((opened) => postMessage({ opened }), (error) => postMessage({ opened: String(error) }));
    return;
  }
  answer(data);
  if (!over) work();
};
