// Serves an engine to Plumb by plumb.engine/1 (../process/PROTOCOL.md).
//
// An engine is an object with what it answers to hello (describe), and with create(setup), which returns a scene:
//
//   step(number)        makes step `number` (from 1) and returns its statistics, an object
//   readFrame(out)      fills out, a Float64Array of 13 numbers a body, in the scene's order
//   readContacts()      returns the contacts of the last step, a Float64Array or an array (optional)
//   settings()          returns what the engine really simulates (optional)
//   pair(a, b)          returns {friction, restitution} of two bodies (optional)
//   destroy()           frees the scene (optional)
//
// `setup` is the request create. Throw Unsupported for what the engine cannot simulate, and GaveUp where it says itself that
// it failed.
//
// The CPU time of a step is that of step(number) without what it does in apart(work): callbacks that an engine calls within
// its step, and that read contacts for Plumb, are none of its work.
import fs from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';

/** What an engine cannot simulate; its message is the reason. */
export class Unsupported extends Error {}

/** A failure that the engine reports; its message is the reason. Others are mistakes, whose place is printed. */
export class GaveUp extends Error {}

const NUMBERS_A_BODY = 13;

// Standard output belongs to the protocol: whatever a library prints goes to standard error. Import this file first.
console.log = console.info = console.debug = console.warn = console.error;

/**
 * The installed npm package that has the module `name`: its version, and its files that an engine consists of, which are
 * package.json, the module, and `others` beside the module. `files` goes into what the engine answers to hello.
 */
export function packageOf(name, ...others) {
  const module = fileURLToPath(import.meta.resolve(name));
  const [folder] = module.match(/^.*\/node_modules\/(@[^/]+\/)?[^/]+/);
  const files = [`${folder}/package.json`, module, ...others.map((other) => path.join(path.dirname(module), other))];
  return {version: JSON.parse(fs.readFileSync(files[0])).version, files};
}

const ADAPTER = process.argv[1];
const DESCRIPTION = ADAPTER.replace(/mjs$/, 'json');

/** `hello` of the engine's description, which lies next to the adapter by its name, with the engine's own `values` of options. */
export function describe(version, files, values = {}) {
  const {hello} = JSON.parse(fs.readFileSync(DESCRIPTION));
  hello.options?.forEach((option) => {
    option.value = values[option.name] ?? option.value;
  });
  return {name: path.basename(ADAPTER, '.mjs'), version, files, ...hello};
}

/** The files of an adapter that are not of a package. A hash of all files tells one engine from another. */
const adapterFiles = () => [ADAPTER, DESCRIPTION, ...['protocol', 'mechanics', 'materials'].map((name) => fileURLToPath(new URL(`${name}.mjs`, import.meta.url)))];

/* ---- Numbers: through descriptor 3 where it is a file, else as JSON arrays ---- */

const hasNumberFile = (() => {
  try {
    return fs.fstatSync(3).isFile();
  } catch {
    return false;
  }
})();

const finiteOrNull = (value) => (Number.isFinite(value) ? value : null);

/** Puts `numbers` into the answer. Returns the offset after them in the file. */
function addNumbers(answer, key, numbers, offset) {
  if (!hasNumberFile) {
    answer[key] = Array.from(numbers, finiteOrNull);
    return offset;
  }
  const values = numbers instanceof Float64Array ? numbers : Float64Array.from(numbers);
  const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
  for (let done = 0; done < bytes.length;) {
    done += fs.writeSync(3, bytes, done, bytes.length - done, offset + done);
  }
  answer[key] = {offset, count: values.length};
  return offset + bytes.length;
}

function addState(answer, scene, frame) {
  scene.readFrame(frame);
  const offset = addNumbers(answer, 'frame', frame, 0);
  if (scene.readContacts) {
    addNumbers(answer, 'contacts', scene.readContacts(), offset);
  }
}

/* ---- Requests ---- */

/** CPU time of this process, s. */
function cpuSeconds() {
  const used = process.cpuUsage();
  return 1e-6 * (used.user + used.system);
}

let secondsApart = 0;

/**
 * Returns work(), which is not the engine's, within a step: its time is not counted as the step's. It is wall time, as a call
 * for CPU time takes longer than many callbacks; in one thread they are the same, unless other programs interrupt it.
 */
export function apart(work) {
  const begin = performance.now();
  const result = work();
  secondsApart += 1e-3 * (performance.now() - begin);
  return result;
}

/** Answers requests until standard input ends, and ends the process. `engine` as described at the head of this file. */
export function serve(engine) {
  const {create, ...hello} = engine;
  let scene = null;
  let frame = null;
  const handlers = {
    hello: () => ({protocol: 'plumb.engine/1', ...hello, files: [...adapterFiles(), ...hello.files]}),
    create: (request) => {
      frame = new Float64Array(NUMBERS_A_BODY * request.bodies.length);
      scene = create(request);
      return scene.settings ? {settings: scene.settings()} : {};
    },
    frame: () => {
      const answer = {};
      addState(answer, scene, frame);
      return answer;
    },
    step: (request) => {
      secondsApart = 0;
      const before = cpuSeconds();
      const stats = scene.step(request.step) ?? {};
      const answer = {cpu: Math.max(0, cpuSeconds() - before - secondsApart), stats};
      addState(answer, scene, frame);
      return answer;
    },
    pair: (request) => scene.pair(...request.bodies),
    destroy: () => {
      scene?.destroy?.();
      scene = null;
      return {};
    },
  };
  for (const line of lines()) {
    const request = JSON.parse(line);
    write(`${JSON.stringify({id: request.id, ...answerTo(handlers, request)})}\n`);
  }
  // An ordinary exit would first wait for V8 to finish optimising WebAssembly: a second, with Rapier.
  process.kill(process.pid, 'SIGKILL');
}

function answerTo(handlers, request) {
  if (!Object.hasOwn(handlers, request.request)) {
    return {error: `unknown request ${request.request}`};
  }
  try {
    return handlers[request.request](request);
  } catch (error) {
    if (!(error instanceof Unsupported || error instanceof GaveUp)) {
      console.error(error);
    }
    return {error: String(error?.message ?? error), unsupported: error instanceof Unsupported};
  }
}

/* ---- Lines: read and written without the event loop, which would cost more than small steps ---- */

function* lines() {
  const chunk = Buffer.alloc(1 << 16);
  let pieces = [];
  for (;;) {
    const length = fs.readSync(0, chunk);
    if (length === 0) {
      return;
    }
    let begin = 0;
    for (let end = chunk.indexOf(10); end >= 0 && end < length; end = chunk.indexOf(10, begin)) {
      pieces.push(Buffer.from(chunk.subarray(begin, end)));
      yield Buffer.concat(pieces).toString();
      pieces = [];
      begin = end + 1;
    }
    pieces.push(Buffer.from(chunk.subarray(begin, length)));
  }
}

function write(text) {
  const bytes = Buffer.from(text);
  for (let done = 0; done < bytes.length;) {
    done += fs.writeSync(1, bytes, done);
  }
}
