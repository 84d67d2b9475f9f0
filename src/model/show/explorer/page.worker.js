// A worker: runs the sets of one chunk of a map after another.

/** @type {Promise<Engine> | undefined} */
let workerEngine;

self.onmessage = async (/** @type {MessageEvent} */ message) => {
  const { binary, about, chunk } = message.data;
  if (binary) {
    workerEngine = engineOf(binary, "run_many", about);
    await workerEngine;
    self.postMessage({ ready: true });
    return;
  }
  const engine = await /** @type {Promise<Engine>} */ (workerEngine);
  const { results } = engine(chunk.sets, chunk.control);
  self.postMessage({ generation: chunk.generation, nodes: chunk.nodes, results });
};
