// A worker: runs the sets that it is sent, one message after another.

/** @type {Promise<Engine> | undefined} */
let workerEngine;

self.onmessage = async (/** @type {MessageEvent} */ message) => {
  const { binary, about, chunk } = message.data;
  if (binary) {
    workerEngine = engineOf(binary, about);
    await workerEngine;
    self.postMessage({ ready: true });
    return;
  }
  const engine = await /** @type {Promise<Engine>} */ (workerEngine);
  const found = engine(chunk.sets, chunk.control, chunk.rows), track = found.track.slice();
  self.postMessage({ generation: chunk.generation, nodes: chunk.nodes, results: found.results, track }, { transfer: [track.buffer] });
};
