// x, y, tilt and contact force over time, with a cursor and a band that shows how the part is supported.

/**
 * @typedef {{time: Float64Array, columns: Record<string, Float64Array>, rows: number, zero: number}} Track ``zero`` is the time from which results count
 * @typedef {Quantity & {curves: {name: string, label: string}[]}} Panel
 */

const KINDS = { sticks: "#E69F00", slides: "#56B4E9", flies: "#ffffff" };
const CURVES = ["#0072B2", "#CC79A7", "#009E73"];
const MARGIN = { left: 62, right: 10, top: 6, bottom: 34 }, BAND = 10;

/** Return a track by columns. @param {Float64Array} numbers @param {string[]} names @param {number} rows @returns {Track} */
function trackOf(numbers, names, rows) {
  const columns = /** @type {Record<string, Float64Array>} */ ({});
  names.forEach((name, n) => {
    columns[name] = new Float64Array(rows);
    for (let row = 0; row < rows; row += 1) columns[name][row] = numbers[row * names.length + n];
  });
  // An engine counts anew from the first touch, and from the onset of the vibration (lifecycle.py).
  let zero = 0;
  for (let row = 1, last = columns.time[0]; row < rows; row += 1) {
    const own = columns.time[row];
    if (own < last) zero += last;
    last = own;
    columns.time[row] = own + zero;
  }
  return { time: columns.time, columns, rows, zero };
}

/** Return the last row at or before a time. @param {Track} track @param {number} time */
function rowAt(track, time) {
  let low = 0, high = track.rows - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (track.time[middle] <= time) low = middle; else high = middle - 1;
  }
  return low;
}

/** Return the frame at a time; between two rows of the same mode it is interpolated. @param {Track} track @param {number} time @returns {any} */
function frameAt(track, time) {
  const row = rowAt(track, time), next = Math.min(row + 1, track.rows - 1);
  const span = track.time[next] - track.time[row], part = span > 0 ? Math.max(0, Math.min(1, (time - track.time[row]) / span)) : 0;
  const frame = /** @type {Record<string, number>} */ ({});
  for (const [name, values] of Object.entries(track.columns)) {
    const whole = name.startsWith("mode_") || name === "event";
    frame[name] = whole ? values[row] : values[row] + part * (values[next] - values[row]);
  }
  frame.time = Math.min(time, track.time[track.rows - 1]);
  return frame;
}

/** Return round numbers between two: at least a count, and as few as possible. @param {number} low @param {number} high @param {number} count */
function ticks(low, high, count) {
  const power = 10 ** Math.floor(Math.log10((high - low) / count));
  for (const part of [10, 5, 2.5, 2, 1, 0.5]) {
    const step = part * power, first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
    if (last - first + 1 >= count) return Array.from({ length: last - first + 1 }, (_, n) => Number(((first + n) * step).toPrecision(9)));
  }
  return [low, high];
}

/** Draw a curve by its lowest and highest value at every pixel. @param {CanvasRenderingContext2D} g @param {Track} track @param {string} name @param {(t: number) => number} across @param {(v: number) => number} down */
function drawCurve(g, track, name, across, down) {
  const values = track.columns[name];
  g.beginPath();
  let column = -1, low = 0, high = 0;
  for (let row = 0; row < track.rows; row += 1) {
    const x = across(track.time[row]), y = down(values[row]);
    if (Math.floor(x) === column) {
      if (y < low || y > high) g.lineTo(x, y);
      low = Math.min(low, y);
      high = Math.max(high, y);
    } else {
      g.lineTo(x, y);
      column = Math.floor(x);
      low = high = y;
    }
  }
  g.stroke();
}

/** Return the function from time to pixels, and its inverse. @param {number} width @param {number} end */
function timeAxis(width, end) {
  const span = width - MARGIN.left - MARGIN.right;
  return {
    across: (/** @type {number} */ time) => MARGIN.left + (span * time) / end,
    back: (/** @type {number} */ x) => Math.max(0, Math.min(end, (end * (x - MARGIN.left)) / span)),
  };
}

/**
 * Draw the panels of a run.
 * @param {CanvasRenderingContext2D} g @param {number} width @param {number} height @param {Track} track
 * @param {Panel[]} panels @param {(panel: Quantity) => number} scaled one of the model in the unit shown
 * @param {{time: number, end: number, label: string, scale: number}} axis
 */
function drawPlots(g, width, height, track, panels, scaled, axis) {
  g.clearRect(0, 0, width, height);
  g.font = "12px system-ui, sans-serif";
  const { across } = timeAxis(width, axis.end), inner = height - MARGIN.top - MARGIN.bottom - BAND - 4;
  const tall = inner / panels.length;
  panels.forEach((panel, n) => {
    const curves = panel.curves.map((curve, k) => ({ ...curve, colour: CURVES[k] })).filter(({ name }, k) => k === 0 || track.columns[name].some((each) => each !== 0)), scale = scaled(panel);
    let [low, high] = [Infinity, -Infinity];
    for (const { name } of curves) {
      for (const value of track.columns[name]) [low, high] = [Math.min(low, value), Math.max(high, value)];
    }
    if (!(high - low > 1e-9)) [low, high] = [low - 0.5, high + 0.5];
    const top = MARGIN.top + n * tall, gap = 7;
    const down = (/** @type {number} */ v) => top + tall - gap - ((v - low) / (high - low)) * (tall - 2 * gap);
    g.strokeStyle = "#d8d8d8";
    g.lineWidth = 1;
    g.strokeRect(MARGIN.left, top + 2, width - MARGIN.left - MARGIN.right, tall - 4);
    g.fillStyle = "#444444";
    g.textAlign = "right";
    for (const tick of ticks(low * scale, high * scale, 3)) {
      const y = down(tick / scale);
      g.fillText(String(tick), MARGIN.left - 4, y + 4);
      line(g, [MARGIN.left, y], [width - MARGIN.right, y]);
    }
    g.save();
    g.beginPath();
    g.rect(MARGIN.left, top, width - MARGIN.left - MARGIN.right, tall);
    g.clip();
    g.lineWidth = 1.5;
    curves.forEach(({ name, colour }) => { g.strokeStyle = colour; drawCurve(g, track, name, across, down); });
    g.restore();
    g.textAlign = "left";
    let left = MARGIN.left + 3;
    curves.forEach(({ label, colour }, k) => {
      const text = k === 0 && panel.unit ? `${label}, ${panel.unit}` : label, wide = g.measureText(text).width + 8;
      g.fillStyle = "rgba(255,255,255,0.7)";
      g.fillRect(left, top + 4, wide, 15);
      g.fillStyle = curves.length > 1 ? colour : "#1b1b1b";
      g.fillText(text, left + 3, top + 16);
      left += wide + 4;
    });
  });
  drawBand(g, track, across, MARGIN.top + inner + 2, width);
  g.fillStyle = "#444444";
  g.textAlign = "center";
  for (const tick of ticks(0, axis.end * axis.scale, Math.max(3, width / 110))) g.fillText(String(tick), across(tick / axis.scale), height - MARGIN.bottom + 14);
  g.textAlign = "right";
  g.fillText(axis.label, width - MARGIN.right, height - 4);
  g.strokeStyle = "#D55E00";
  g.lineWidth = 1.5;
  line(g, [across(axis.time), MARGIN.top], [across(axis.time), height - MARGIN.bottom]);
}

/** Draw how the part is supported over time, and a mark at every event. @param {CanvasRenderingContext2D} g @param {Track} track @param {(t: number) => number} across @param {number} top @param {number} width */
function drawBand(g, track, across, top, width) {
  let from = 0;
  const seen = ["face", "corner", "side", "wall", "support_slip", "side_slip"].map((name) => `mode_${name}`);
  const kindOf = (/** @type {number} */ row) => contactKind(/** @type {any} */ (Object.fromEntries(seen.map((name) => [name, track.columns[name][row]]))));
  for (let row = 1; row <= track.rows; row += 1) {
    const kind = kindOf(from);
    if (row < track.rows && kindOf(row) === kind) continue;
    const right = Math.min(across(track.time[Math.min(row, track.rows - 1)]), width - MARGIN.right), left = across(track.time[from]);
    g.fillStyle = KINDS[kind];
    g.fillRect(left, top, Math.max(right - left, 0.5), BAND);
    from = row;
  }
  g.fillStyle = "#1b1b1b";
  for (let row = 0; row < track.rows; row += 1) if (track.columns.event[row] > 0) g.fillRect(across(track.time[row]) - 0.4, top + BAND - 4, 0.8, 4);
  g.strokeStyle = "#6e6e6e";
  g.lineWidth = 1;
  g.strokeRect(MARGIN.left, top, width - MARGIN.left - MARGIN.right, BAND);
}
