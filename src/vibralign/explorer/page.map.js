// The map over two parameters: computed from coarse to fine in Workers, along the boundary first, and finest near what aligns.

/**
 * @typedef {{x: string, y: string, xs: [number, number], ys: [number, number], cells: number,
 *   tau: Float64Array, outcome: Int8Array, step: Uint8Array}} MapData
 * @typedef {{set: number[], control: Record<string, number>, judge: (results: Record<string, number>) => Record<string, number>}} Task a run
 * @typedef {{label: string, one: number}} MapAxis its title, and the size of the unit in which it is shown
 */

const UNKNOWN = -1, ALIGNED = 0, SETTLED = 1, LEFT_SCENE = 2, FAILED = 4, INSERTED = 5;
const FIRST_STEP = 8, CHUNK = 1024;
const FILLED_BEYOND = 2; // nodes; farther than this from aligned nodes, every second node is computed
const LONG_CHUNK = 500; // ms, after which a chunk of a replaced map is given up
const CIVIDIS = [[0, 34, 78], [24, 52, 111], [63, 74, 108], [92, 97, 109], [119, 120, 112], [147, 144, 113], [177, 168, 106], [208, 195, 94], [240, 222, 78], [254, 232, 56]];
const INSET = { left: 68, right: 22, top: 8, bottom: 40 };

/** Return an empty map. @param {string} x @param {string} y @param {[number, number]} xs @param {[number, number]} ys @param {number} cells @returns {MapData} */
function emptyMap(x, y, xs, ys, cells) {
  const size = cells * cells;
  return { x, y, xs, ys, cells, tau: new Float64Array(size).fill(NaN), outcome: new Int8Array(size).fill(UNKNOWN), step: new Uint8Array(size) };
}

/** Return the values of a node. @param {MapData} map @param {number} node @returns {[number, number]} */
function valuesAt(map, node) {
  const n = map.cells - 1, column = node % map.cells, row = Math.floor(node / map.cells);
  return [map.xs[0] + ((map.xs[1] - map.xs[0]) * column) / n, map.ys[0] + ((map.ys[1] - map.ys[0]) * row) / n];
}

/** True if a node aligns within `reach` nodes of a place. @param {MapData} map @param {number} row @param {number} column @param {number} reach */
function alignsNear({ cells, outcome }, row, column, reach) {
  for (let r = Math.max(0, row - reach); r <= Math.min(cells - 1, row + reach); r += 1) {
    for (let c = Math.max(0, column - reach); c <= Math.min(cells - 1, column + reach); c += 1) if (outcome[r * cells + c] === ALIGNED) return true;
  }
  return false;
}

/**
 * Return the nodes of a step to compute, those beside a change of outcome first; of the finest step only nodes near an
 * aligned one.
 * @param {MapData} map @param {number} step
 */
function nodesOf(map, step) {
  const coarse = 2 * step, { cells, outcome } = map;
  const edge = /** @type {number[]} */ ([]), rest = /** @type {number[]} */ ([]);
  for (let row = 0; row < cells; row += step) {
    for (let column = 0; column < cells; column += step) {
      const node = row * cells + column;
      if (outcome[node] !== UNKNOWN || (step === 1 && !alignsNear(map, row, column, FILLED_BEYOND))) continue;
      const found = new Set();
      if (step < FIRST_STEP) {
        const top = row - (row % coarse), left = column - (column % coarse);
        for (const r of [top, Math.min(top + coarse, cells - 1 - ((cells - 1) % coarse))]) {
          for (const c of [left, Math.min(left + coarse, cells - 1 - ((cells - 1) % coarse))]) found.add(outcome[r * cells + c] === ALIGNED);
        }
      }
      (found.size > 1 ? edge : rest).push(node);
    }
  }
  return [...edge, ...rest];
}

/** Give nodes that are not computed the outcome of a computed neighbour; their step stays 0. @param {MapData} map */
function fill({ cells, outcome }) {
  for (let node = 0; node < outcome.length; node += 1) {
    const row = Math.floor(node / cells), column = node % cells;
    if (outcome[node] === UNKNOWN) outcome[node] = outcome[(row - (row % 2)) * cells + column - (column % 2)];
  }
}

/** Computes maps in Workers; a new one replaces the one under way. */
class Mapper {
  /** @param {BufferSource} binary @param {Interface} about @param {string} code @param {(map: MapData, done: boolean) => void} changed */
  constructor(binary, about, code, changed) {
    this.binary = binary;
    this.about = about;
    this.changed = changed;
    this.generation = 0;
    this.pending = 0;
    this.map = /** @type {MapData | null} */ (null);
    this.queue = /** @type {number[]} */ ([]);
    this.step = 0;
    this.url = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
    this.count = Math.max(1, Math.min(8, navigator.hardwareConcurrency || 2));
    this.idle = /** @type {Worker[]} */ ([]);
    this.busy = /** @type {Map<Worker, number>} */ (new Map()); // workers that run a chunk, with its start
    for (let n = 0; n < this.count; n += 1) this.hire();
  }

  /** Start a worker, which is idle when it is ready. */
  hire() {
    const worker = new Worker(this.url);
    worker.onmessage = (message) => this.receive(worker, message.data);
    worker.onerror = (error) => stuck("This browser starts no Worker here: no map is computed", error);
    worker.postMessage({ binary: this.binary, about: this.about });
  }

  /** Replace the workers that have long been busy with a replaced map. */
  giveUp() {
    for (const [worker, since] of this.busy) {
      if (performance.now() - since < LONG_CHUNK) continue;
      worker.terminate();
      this.busy.delete(worker);
      this.hire();
    }
  }

  /** Compute a map. @param {MapData} map @param {(changes: Record<string, number>) => Task} taskOf returns the run with other values, given in the page's units */
  compute(map, taskOf) {
    this.giveUp();
    this.generation += 1;
    this.map = map;
    this.taskOf = (/** @type {number} */ node) => {
      const [x, y] = valuesAt(map, node);
      return taskOf({ [map.x]: x, [map.y]: y });
    };
    this.step = FIRST_STEP;
    this.queue = nodesOf(map, this.step);
    this.pending = 0;
    this.feed();
  }

  /** Stop computing. */
  stop() {
    this.giveUp();
    this.generation += 1;
    this.queue = [];
    this.map = null;
  }

  feed() {
    while (this.map && this.queue.length && this.idle.length) {
      const worker = /** @type {Worker} */ (this.idle.pop());
      const share = Math.ceil(this.queue.length / (2 * this.count));
      const nodes = this.queue.splice(0, Math.max(16, Math.min(CHUNK, share))), tasks = nodes.map(/** @type {any} */ (this.taskOf));
      // A chunk has one control: nodes with another horizon wait.
      const control = tasks[0].control, isNow = (/** @type {Task} */ task) => task.control.horizon === control.horizon;
      this.queue.unshift(...nodes.filter((_, n) => !isNow(tasks[n])));
      this.pending += 1;
      const now = nodes.filter((_, n) => isNow(tasks[n]));
      const chunk = { generation: this.generation, nodes: now, sets: tasks.filter(isNow).map((task) => task.set), control };
      this.busy.set(worker, performance.now());
      worker.postMessage({ chunk });
    }
  }

  /** @param {Worker} worker @param {any} message */
  receive(worker, message) {
    this.busy.delete(worker);
    this.idle.push(worker);
    const { map } = this;
    if (map && message.generation === this.generation) {
      this.pending -= 1;
      const names = this.about.results, width = names.length;
      message.nodes.forEach((/** @type {number} */ node, /** @type {number} */ n) => {
        const found = Object.fromEntries(names.map((name, k) => [name, message.results[n * width + k]]));
        const { outcome, tau_align: tau } = /** @type {any} */ (this.taskOf)(node).judge(found);
        [map.outcome[node], map.tau[node], map.step[node]] = [outcome, tau, this.step];
      });
      const finished = map.outcome.some((each) => each >= 0 && each !== FAILED);
      if (!this.queue.length && !this.pending && finished) {
        if (this.step > 1) this.step /= 2;
        this.queue = nodesOf(map, this.step);
        if (!this.queue.length) fill(map);
      }
      this.changed(map, !this.queue.length && !this.pending);
    }
    this.feed();
  }
}

/** Return red, green and blue of a duration. @param {number} share */
function colour(share) {
  const at = Math.max(0, Math.min(1, share)) * (CIVIDIS.length - 1), n = Math.min(Math.floor(at), CIVIDIS.length - 2), part = at - n;
  return CIVIDIS[n].map((each, k) => Math.round(each + part * (CIVIDIS[n + 1][k] - each)));
}

/** Return the ends of the logarithmic colour scale; the longest 2 % of the durations have one colour. @param {MapData} map */
function durations(map) {
  const known = Array.from(map.tau).filter(Number.isFinite).sort((a, b) => a - b);
  if (!known.length) return [1, 2];
  const shortest = Math.max(known[0], 1e-9);
  return [shortest, Math.max(known[Math.floor(0.98 * (known.length - 1))], 1.001 * shortest)];
}

/** Return the conversions between the values of a map and pixels of its canvas. @param {MapData} map @param {number} width @param {number} height */
function mapPlaces(map, width, height) {
  const wide = width - INSET.left - INSET.right, tall = height - INSET.top - INSET.bottom;
  return {
    x: (/** @type {number} */ v) => INSET.left + (wide * (v - map.xs[0])) / (map.xs[1] - map.xs[0]),
    y: (/** @type {number} */ v) => INSET.top + tall - (tall * (v - map.ys[0])) / (map.ys[1] - map.ys[0]),
    valueX: (/** @type {number} */ p) => map.xs[0] + Math.max(0, Math.min(1, (p - INSET.left) / wide)) * (map.xs[1] - map.xs[0]),
    valueY: (/** @type {number} */ p) => map.ys[0] + Math.max(0, Math.min(1, (INSET.top + tall - p) / tall)) * (map.ys[1] - map.ys[0]),
    wide, tall,
  };
}

/** Draw a map with its axes and the chosen point. @param {CanvasRenderingContext2D} g @param {number} width @param {number} height @param {MapData} map @param {{x: MapAxis, y: MapAxis}} axes @param {[number, number]} point */
function drawMap(g, width, height, map, axes, point) {
  const { cells } = map, place = mapPlaces(map, width, height), [shortest, longest] = durations(map);
  g.clearRect(0, 0, width, height);
  g.save();
  g.beginPath();
  g.rect(INSET.left, INSET.top, place.wide, place.tall);
  g.clip();
  g.fillStyle = "#ffffff";
  g.fillRect(INSET.left, INSET.top, place.wide, place.tall);
  const hatch = hatching(g), size = [place.wide / (cells - 1), place.tall / (cells - 1)];
  for (const step of [8, 4, 2, 1]) {
    for (let node = 0; node < cells * cells; node += 1) {
      if (map.step[node] !== step) continue;
      const [x, y] = valuesAt(map, node);
      const left = Math.floor(place.x(x) - (size[0] * step) / 2), top = Math.floor(place.y(y) - (size[1] * step) / 2);
      const right = Math.ceil(place.x(x) + (size[0] * step) / 2), bottom = Math.ceil(place.y(y) + (size[1] * step) / 2);
      if (map.outcome[node] === ALIGNED) g.fillStyle = `rgb(${colour(Math.log(map.tau[node] / shortest) / Math.log(longest / shortest)).join(",")})`;
      else g.fillStyle = map.outcome[node] === FAILED ? "#bdbdbd" : hatch;
      if (map.outcome[node] !== ALIGNED) g.clearRect(left, top, right - left, bottom - top);
      g.fillRect(left, top, right - left, bottom - top);
    }
  }
  g.restore();
  drawAxes(g, height, map, axes, place);
  const [px, py] = [place.x(point[0]), place.y(point[1])];
  g.beginPath();
  g.arc(px, py, 7, 0, 7);
  g.moveTo(px - 12, py);
  g.lineTo(px + 12, py);
  g.moveTo(px, py - 12);
  g.lineTo(px, py + 12);
  strokeOnWhite(g, 5, 2.5, "#D55E00");
}

/** Stroke the path in a colour, over a broader white. @param {CanvasRenderingContext2D} g @param {number} broad @param {number} fine @param {string} ink */
function strokeOnWhite(g, broad, fine, ink) {
  for (const [width, style] of /** @type {[number, string][]} */ ([[broad, "#ffffff"], [fine, ink]])) {
    g.lineWidth = width;
    g.strokeStyle = style;
    g.stroke();
  }
}

let pattern = /** @type {CanvasPattern | null} */ (null);
/** Return the pattern of what does not align. @param {CanvasRenderingContext2D} g @returns {CanvasPattern} */
function hatching(g) {
  if (pattern) return pattern;
  const tile = document.createElement("canvas");
  tile.width = tile.height = 8;
  const t = /** @type {CanvasRenderingContext2D} */ (tile.getContext("2d"));
  t.fillStyle = "#f4f4f4";
  t.fillRect(0, 0, 8, 8);
  t.strokeStyle = "#8a8a8a";
  t.lineWidth = 1.2;
  t.beginPath();
  for (const shift of [-8, 0, 8]) { t.moveTo(shift - 1, 9); t.lineTo(shift + 9, -1); }
  t.stroke();
  pattern = /** @type {CanvasPattern} */ (g.createPattern(tile, "repeat"));
  return pattern;
}

/** @param {CanvasRenderingContext2D} g @param {number} height @param {MapData} map @param {{x: MapAxis, y: MapAxis}} axes @param {any} place */
function drawAxes(g, height, map, axes, place) {
  g.font = "12px system-ui, sans-serif";
  g.fillStyle = "#333333";
  g.strokeStyle = "#555555";
  g.lineWidth = 1;
  g.strokeRect(INSET.left, INSET.top, place.wide, place.tall);
  g.textAlign = "center";
  for (const tick of ticks(map.xs[0] / axes.x.one, map.xs[1] / axes.x.one, place.wide > 300 ? 5 : 3)) g.fillText(String(tick), place.x(tick * axes.x.one), height - INSET.bottom + 15);
  g.fillText(axes.x.label, INSET.left + place.wide / 2, height - 6, place.wide);
  g.textAlign = "right";
  for (const tick of ticks(map.ys[0] / axes.y.one, map.ys[1] / axes.y.one, 5)) g.fillText(String(tick), INSET.left - 4, place.y(tick * axes.y.one) + 4);
  g.save();
  g.translate(12, INSET.top + place.tall / 2);
  g.rotate(-Math.PI / 2);
  g.textAlign = "center";
  g.fillText(axes.y.label, 0, 0, place.tall);
  g.restore();
}
