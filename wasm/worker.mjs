// brio in a worker: its calls as promises, with progress and cancel. Results are copies (copy() of results.mjs), sent without another.
//
//   const brio = await start();
//   const { tetrahedra } = await brio.delaunay(points, { signal, progress: (stage, share) => ... });
//
// An AbortSignal stops a call: by a flag in shared memory where the page may have that, and else by the end of the worker; another one
// starts with the next call. Calls wait for those before them.
import { BrioError } from './brio.mjs';

const CALLS = ['delaunay', 'regular', 'hull', 'alphaComplex', 'alphaShape', 'voronoi', 'surface', 'read', 'write'];

/** A worker of a page or of Node, with the same few words. */
async function open(address) {
  if (typeof Worker !== 'undefined') {
    const worker = new Worker(address, { type: 'module' });
    return { post: (m, list) => worker.postMessage(m, list), listen: (f) => { worker.onmessage = (e) => f(e.data); },
      fail: (f) => { worker.onerror = (e) => f(new Error(e.message || 'the worker did not start')); }, end: () => worker.terminate() };
  }
  const worker = new (await import('node:worker_threads')).Worker(address), on = {};
  for (const event of ['message', 'error']) worker.on(event, (what) => on[event]?.(what));
  worker.unref(); // a worker that has nothing to do keeps no program from its end
  return { post: (m, list) => worker.postMessage(m, list), listen: (f) => { on.message = f; }, fail: (f) => { on.error = f; },
    hold: (busy) => (busy ? worker.ref() : worker.unref()), end: () => worker.terminate() };
}

/** A queue of calls to a worker that `serve` (serve.mjs) answers.   start  () => a worker as `open` gives it.
 *  hello  what the worker is told first. */
export class Caller {
  constructor(start, hello) { this.start = start; this.hello = hello; this.last = Promise.resolve(); this.worker = null; this.ended = null; }

  /** Calls `name` with arguments; `signal` and `progress` are of this call. */
  call(name, given, { signal, progress, transfer = [] } = {}) {
    const turn = this.last.then(() => this.now(name, given, { signal, progress, transfer }));
    this.last = turn.catch(() => {});
    return turn;
  }
  async now(name, given, { signal, progress, transfer }) {
    signal?.throwIfAborted();
    const worker = (this.worker ??= await this.begin());
    signal?.throwIfAborted(); // while the worker began
    const flag = typeof SharedArrayBuffer === 'undefined' ? null : new Int32Array(new SharedArrayBuffer(4));
    return new Promise((done, failed) => {
      const abort = () => {
        if (flag) return void Atomics.store(flag, 0, 1);
        this.ended = null;
        this.end();
        failed(signal.reason);
      };
      signal?.addEventListener('abort', abort, { once: true });
      const settle = (f, value) => { this.ended = null; signal?.removeEventListener('abort', abort); worker.hold?.(false); f(value); };
      this.ended = () => settle(failed, new Error('the worker was ended'));
      worker.fail((error) => { settle(failed, error); this.end(); });
      worker.listen((m) => {
        if (m.stage !== undefined) return void progress?.(m.stage, m.share);
        if (!m.error) settle(done, m.result);
        else settle(failed, signal?.aborted ? signal.reason : m.error.status === undefined ? new Error(m.error.message) : new BrioError(m.error.status, m.error.message));
      });
      worker.hold?.(true);
      try {
        worker.post({ name, given, flag }, transfer);
      } catch (error) { // of what cannot be sent
        settle(failed, error);
      }
    });
  }
  async begin() {
    const worker = await this.start();
    if (this.hello) worker.post(this.hello, []);
    return worker;
  }
  /** Ends the worker; a call that runs fails. */
  end() { this.worker?.end(); this.worker = null; this.ended?.(); }
}

/** Starts a worker.   options.source  a compiled WebAssembly.Module, or the bytes of brio.wasm; not given: the package's. */
export async function start({ source } = {}) {
  const caller = new Caller(() => open(new URL('./thread.mjs', import.meta.url)), { start: source });
  const brio = { end: () => caller.end() };
  for (const name of CALLS)
    brio[name] = (...given) => {
      const last = given.at(-1), plain = last && Object.getPrototypeOf(last) === Object.prototype && given.length > 1;
      const { signal, progress, transfer, ...options } = plain ? given.pop() : {};
      return caller.call(name, [...given, options], { signal, progress, transfer });
    };
  return brio;
}
