// A worker of the package: the calls of a Brio.
import { load } from './brio.mjs';
import { serve } from './serve.mjs';

/** The port of the worker that this runs in. */
async function own() {
  if (typeof WorkerGlobalScope !== 'undefined' && self instanceof WorkerGlobalScope)
    return { post: (m, list) => self.postMessage(m, list), listen: (f) => { self.onmessage = (e) => f(e.data); } };
  const { parentPort } = await import('node:worker_threads');
  return { post: (m, list) => parentPort.postMessage(m, list), listen: (f) => parentPort.on('message', f) };
}

serve(await own(), load);
