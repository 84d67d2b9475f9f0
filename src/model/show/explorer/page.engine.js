// The engines: WebAssembly modules compiled from the same kernels that Python runs.

/**
 * @typedef {{stack: number, memory: number}} Layout
 * @typedef {{parameters: string[], columns: string[], results: string[], control: string[],
 *   defaults: number[], events: string[], constants: number,
 *   functions: Record<string, Layout>}} Interface
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
 * Return an engine. `run_one` also fills a track of `rows` rows; `run_many` takes any number of sets.
 * @param {BufferSource} binary @param {string} name @param {Interface} about @returns {Promise<Engine>}
 */
async function engineOf(binary, name, about) {
  const memory = new WebAssembly.Memory({ initial: 4 });
  const { stack, memory: scratch } = about.functions[name];
  const { instance } = await WebAssembly.instantiate(binary, {
    env: {
      __linear_memory: memory,
      __stack_pointer: new WebAssembly.Global({ value: "i32", mutable: true }, stack),
      pow: Math.pow,
      exp2: (/** @type {number} */ power) => Math.pow(2, power),
    },
  });
  const run = /** @type {Function} */ (instance.exports[name]);
  const fields = about.results.length;
  return (sets, control, rows = 0) => {
    const one = name === "run_one";
    const room = one ? rows * about.columns.length : sets.length * (about.constants + 1);
    // numba's own results come first: a function's value and its error.
    const sizes = [2, sets.length * about.parameters.length, about.control.length, room, sets.length * fields, scratch];
    const places = [stack];
    for (const size of sizes) places.push(places[places.length - 1] + 8 * LINE * Math.ceil(size / LINE));
    const missing = places[sizes.length] - memory.buffer.byteLength;
    if (missing > 0) memory.grow(Math.ceil(missing / PAGE_BYTES));
    const numbers = new Float64Array(memory.buffer);
    const [value, given, limits, out, results, work] = places;
    sets.forEach((set, n) => numbers.set(set, given / 8 + n * about.parameters.length));
    about.control.forEach((each, n) => { numbers[limits / 8 + n] = control[each] ?? about.defaults[n]; });
    const status = run(value, value + 8, given, limits, one ? rows : sets.length, out, results, work);
    if (status !== 0) throw new Error(`the engine stopped with status ${status}`);
    return {
      results: numbers.slice(results / 8, results / 8 + sizes[4]),
      track: one ? numbers.subarray(out / 8, out / 8 + room) : new Float64Array(0),
    };
  };
}
