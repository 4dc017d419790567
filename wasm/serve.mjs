// The worker's side of worker.mjs: answers calls one after the other.

const EVERY = 50; // milliseconds between two words of progress

/** Answers the calls of a Caller.   port  { post, listen }.   begin  (start) => a promise of the calls { name: function },
 *  with `progress` to set, as a Brio has it. */
export function serve(port, begin) {
  let calls;
  port.listen(async ({ start, name, given, flag }) => {
    if (name === undefined) return void (calls = begin(start)).catch(() => {}); // the next call says why it failed
    try {
      const brio = await (calls ??= begin());
      let said = -Infinity;
      brio.progress = (stage, share) => {
        const now = performance.now();
        if (now - said >= EVERY) said = now, port.post({ stage, share }, []);
        return !!flag && Atomics.load(flag, 0) !== 0;
      };
      const answer = await brio[name](...given), result = answer?.copy ? answer.copy() : answer;
      if (name === 'surface') result.certificate = answer.certificate;
      answer?.free?.();
      port.post({ result }, buffers(result));
    } catch (error) {
      port.post({ error: { message: error.message, status: error.status } }, []);
    }
  });
}

/** The memory of all arrays in a result, which is sent, not copied. */
function buffers(result, found = new Set()) {
  if (ArrayBuffer.isView(result)) found.add(result.buffer);
  else if (result && typeof result === 'object') for (const part of Object.values(result)) buffers(part, found);
  return [...found];
}
