// The engine: a WebAssembly module compiled from the same kernels that Python runs.

/**
 * @typedef {{name: string, length: number | "sets" | "rows", size: number}} Argument
 * @typedef {{stack: number, arguments: Argument[]}} Layout
 * @typedef {{parameters: string[], columns: string[], results: string[], limits: string[],
 *   defaults: number[], events: string[]} & Layout} Interface
 * @typedef {{results: Float64Array, track: Float64Array}} Found
 * @typedef {(sets: number[][], control: Record<string, number>, rows?: number) => Found} Engine
 */

const PAGE_BYTES = 65536;
const LINE = 8; // numbers in a cache line

/** Return the bytes of gzipped data in base 64. @param {string} text @returns {Promise<ArrayBuffer>} */
async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/**
 * Return the engine. It takes any number of sets, or one set and a track of `rows` rows to fill.
 * @param {BufferSource} binary @param {Interface} about @returns {Promise<Engine>}
 */
async function engineOf(binary, about) {
  const memory = new WebAssembly.Memory({ initial: 4 });
  const { stack, arguments: layout } = about;
  const { instance } = await WebAssembly.instantiate(binary, {
    env: {
      __linear_memory: memory,
      __stack_pointer: new WebAssembly.Global({ value: "i32", mutable: true }, stack),
      pow: Math.pow,
      exp2: (/** @type {number} */ power) => Math.pow(2, power),
    },
  });
  const run = /** @type {Function} */ (instance.exports.run);
  return (sets, control, rows = 0) => {
    const lengths = layout.map(({ length }) => (length === "sets" ? sets.length : length === "rows" ? rows : length));
    const words = stack + 8 * LINE; // after the result of the call
    let end = words + 8 * LINE * Math.ceil((2 * layout.length) / LINE);
    const places = layout.map(({ size }, n) => {
      const place = end;
      end += 8 * LINE * Math.ceil((lengths[n] * size) / LINE);
      return place;
    });
    const missing = end - memory.buffer.byteLength;
    if (missing > 0) memory.grow(Math.ceil(missing / PAGE_BYTES));
    const numbers = new Float64Array(memory.buffer), view = new DataView(memory.buffer);
    numbers.fill(0, words / 8, end / 8);
    layout.forEach((_, n) => {
      view.setUint32(words + 16 * n, places[n], true);
      view.setUint32(words + 16 * n + 8, lengths[n], true);
    });
    /** @param {string} argument */
    const at = (argument) => layout.findIndex((each) => each.name === argument);
    /** @param {string} argument */
    const found = (argument) => {
      const n = at(argument);
      return n < 0 ? new Float64Array(0) : numbers.subarray(places[n] / 8, places[n] / 8 + lengths[n] * layout[n].size);
    };
    sets.forEach((set, n) => found("given").set(set, n * about.parameters.length));
    about.limits.forEach((each, n) => { found("limits")[n] = control[each] ?? about.defaults[n]; });
    run(words, stack);
    return { results: found("results").slice(), track: found("memory.track") };
  };
}
