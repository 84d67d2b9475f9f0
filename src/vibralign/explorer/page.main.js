// The page: reads the address, runs the engine, draws, and follows what the reader does.

// A number that is not given is null in JSON.
const MODEL = JSON.parse(
  /** @type {HTMLElement} */ (document.getElementById("model")).textContent ?? "",
  (_, value) => (value === null ? NaN : value),
);
const CELLS = 65, SLOW_MAP = 150, SLOW_OTHER = 80, MAP_EVALUATIONS = 1e6;
const MAP_TOLERANCE = 1e-8; // colours differ by two per cent; at 1e-10 a map takes 1.4 to 2.3 times as long

/** @param {string} id @returns {any} */
const element = (id) => document.getElementById(id);
const parameters = byName(MODEL.parameters);
let { state, ignored } = stateOf(location.hash, MODEL);
/** Texts of the fields that break a rule: nothing is run until they are mended. @type {Record<string, string>} */
let entered = {};
let refusal = "";
let runner = /** @type {Runner | null} */ (null), mapper = /** @type {Mapper | null} */ (null);
/** @typedef {Run & {device: any, values: Record<string, number>}} DrawnRun */
let run = /** @type {DrawnRun | null} */ (null), other = /** @type {Run | null} */ (null);
let map = /** @type {MapData | null} */ (null);
let time = 0, slowTilt = NaN, playing = false, lastFrame = 0, mapTimer = 0, otherTimer = 0, mapStarted = 0, mapFrame = 0;
const measured = { map: 0 };

// ---------------------------------------------------------------- running

/** Return a set as the engine takes it. @param {Record<string, number>} values @returns {number[]} */
const setOf = (values) => Object.values(asParameters(values, MODEL));

/** Return the control of a run; a horizon in seconds is the same for all units. @param {Record<string, number>} values @returns {Record<string, number>} */
function controlOf(values) {
  const horizon = MODEL.horizon / scaleOf(MODEL.time, values);
  return Number.isNaN(horizon) ? MODEL.control : { ...MODEL.control, horizon };
}

/** Return all values, dimensionless, as the drawing takes them. @param {Record<string, number>} values */
function drawnDevice(values) {
  const device = asParameters(values, MODEL);
  const [peg, hole] = ["peg_chamfer", "hole_chamfer"].map((name) => (values[name] ? values[name] / scaleOf(parameters[name], values) : 0));
  return { ...device, slot_half_width: device.half_width * (1 + device.clearance), peg_chamfer: peg, hole_chamfer: hole, force_shown: 1 };
}

/** Run what the state says, and draw it. */
function rerun() {
  clearTimeout(otherTimer);
  runner?.stop("other");
  if (refusal) { runner?.stop("run"); writeInstead(`Not run: ${refusal}`, true); return; }
  if (!runner) return;
  const values = valuesOf(state, state.vibration);
  const done = runner.start("run", setOf(values), controlOf(values), (found) => {
    show({ ...found, results: judged(found.results, values), device: drawnDevice(values), values });
    otherTimer = setTimeout(compare, SLOW_OTHER);
  });
  if (!done) writeInstead("Computing … this run has very many steps; the page stays usable.", false);
}

/** Show a run. @param {DrawnRun} found */
function show(found) {
  run = found;
  other = null;
  slowTilt = state.vibration ? NaN : slowTiltOf(found);
  found.device.force_shown = Math.max(1, quantile(found.track.columns.contact_force));
  time = Math.min(state.time ?? time, lastTime());
  writeOutcome();
  writePace();
  drawRun();
}

/** Run the same set with or without vibration. */
function compare() {
  const values = valuesOf(state, !state.vibration);
  runner?.start("other", setOf(values), controlOf(values), (found) => {
    other = { ...found, results: judged(found.results, values) };
    if (state.vibration) slowTilt = slowTiltOf(other);
    writeOutcome();
  });
}

/** Return the tilt at which the part rests under a slow press, for a run without vibration that neither aligns nor rests; else NaN. @param {Run} still */
const slowTiltOf = ({ results }) => (!runner || aligns(results) || rests(results) ? NaN : runner.slowTilt(setOf(state.values)));

/** Return the 95 % quantile of values. @param {Float64Array} values */
const quantile = (values) => Float64Array.from(values).sort()[Math.floor(0.95 * (values.length - 1))];

/** Return the end of the time axis. */
const lastTime = () => (run ? run.track.time[run.track.rows - 1] || 1 : 1);

// ---------------------------------------------------------------- drawing

/** Return the context of a canvas at the resolution of the screen. @param {string} id */
function contextOf(id) {
  const canvas = element(id), ratio = devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { context, width, height };
}

function drawRun() {
  if (!run) return;
  const scene = contextOf("scene");
  const exaggeration = element("exaggerate").checked ? 5 : 1, { values } = run;
  const holder = holderOf(run.track, run.device, MODEL.control.start);
  drawScene(scene.context, scene.width, scene.height, frameAt(run.track, time), { ...run.device, holder }, exaggeration);
  const plots = contextOf("plots"), scaled = (/** @type {Quantity} */ panel) => scaleOf(panel, values) / panel.one;
  const second = scaleOf(MODEL.time, values), [unit, one] = timeUnit(lastTime() * second);
  const axis = { time, end: lastTime(), label: unit ? `time, ${unit}` : "τ, in units of 1/p", scale: second / one };
  drawPlots(plots.context, plots.width, plots.height, run.track, MODEL.panels, scaled, axis);
  writeMoment();
}

function drawWholeMap() {
  if (!map) return;
  const { context, width, height } = contextOf("map");
  const axis = (/** @type {Parameter} */ each) => ({ label: `${each.words}, ${each.symbol}${each.unit ? ` (${each.unit})` : ""}`, one: each.one });
  drawMap(context, width, height, map, { x: axis(parameters[map.x]), y: axis(parameters[map.y]) }, [state.values[map.x], state.values[map.y]]);
  const [shortest, longest] = durations(map);
  element("durations").hidden = !map.outcome.includes(ALIGNED);
  element("shortest").textContent = inTime(shortest);
  element("longest").textContent = `${inTime(longest)} and longer`;
  const count = (/** @type {(outcome: number) => boolean} */ is) => /** @type {MapData} */ (map).outcome.reduce((n, each) => n + Number(is(each)), 0);
  const known = count((each) => each >= 0), share = (/** @type {number} */ of) => Math.round((100 * count((each) => each === of)) / known);
  const more = known < map.outcome.length ? "; more is being computed" : "";
  const open = known && count((each) => each === FAILED) ? ` Grey, ${share(FAILED)} %: too many steps for the map.` : "";
  const filled = map.step.some((step, node) => !step && /** @type {MapData} */ (map).outcome[node] >= 0) ? " Away from what aligns, every second node is computed." : "";
  element("share").textContent = known ? `${share(ALIGNED)} % of it aligns${more}.${open}${filled}` : "";
}

// ---------------------------------------------------------------- the map

/** Return the range of a map's axis. @param {"x" | "y"} side @returns {[number, number]} */
function span(side) {
  const { least, most } = parameters[state[side]];
  return /** @type {any} */ (state.spans[side]) ?? [least, most];
}

/** Compute the map, a moment after the last change, unless it is this one. */
function remap() {
  clearTimeout(mapTimer);
  if (map && sameMap === mapKey()) { drawWholeMap(); return; }
  mapTimer = setTimeout(computeMap, SLOW_MAP);
}

let sameMap = "";
/** Return the key of a map: all values on which it depends. */
function mapKey() {
  const fixed = Object.entries(valuesOf(state, state.vibration)).filter(([name]) => name !== state.x && name !== state.y);
  return JSON.stringify([state.x, state.y, span("x"), span("y"), fixed.map(([, value]) => String(value))]);
}

function computeMap() {
  if (!mapper || refusal) return;
  sameMap = mapKey();
  mapStarted = performance.now();
  const values = valuesOf(state, state.vibration), limit = Math.min(MAP_EVALUATIONS, MODEL.control.max_evaluations);
  mapper.compute(emptyMap(state.x, state.y, span("x"), span("y"), CELLS), (changes) => {
    const here = { ...values, ...changes };
    const own = controlOf(here), tolerance = Math.max(own.tolerance, MAP_TOLERANCE);
    const control = { ...own, tolerance, alignment_only: isChamfered(here) ? 0 : 1, max_evaluations: limit };
    return { set: setOf(here), control, judge: (/** @type {Record<string, number>} */ results) => judged(results, here) };
  });
}

// ---------------------------------------------------------------- time

/** Move the cursor. @param {number} to */
function seek(to) {
  if (!run) return;
  time = Math.max(0, Math.min(lastTime(), to));
  drawRun();
}

/** @param {boolean} on */
function play(on) {
  playing = on && run !== null;
  element("play").textContent = playing ? "Pause" : "Play";
  if (!playing) { state.time = time > 0 ? time : null; writeAddress(); return; }
  if (time >= lastTime()) time = 0;
  lastFrame = 0;
  requestAnimationFrame(advance);
}

/** Return the time of the run that is played in a second. */
const pace = () => Number(element("speed").value) * Math.max(lastTime() / 60, Math.min(lastTime(), 30) / 10);

function writePace() {
  const shown = rounded(Number((pace() * scaleOf(MODEL.time, run?.values ?? state.values)).toPrecision(2)));
  element("pace").textContent = MODEL.units ? `${shown} × real time` : `τ advances by ${shown} a second`;
}

/** @param {number} now */
function advance(now) {
  if (!playing) return;
  if (lastFrame) seek(time + (pace() * (now - lastFrame)) / 1000);
  lastFrame = now;
  if (time >= lastTime()) play(false); else requestAnimationFrame(advance);
}

/** Step to the next event, or the one before. @param {number} way */
function stepEvent(way) {
  if (!run) return;
  play(false);
  const { track } = run, row = rowAt(track, time), small = 1e-9 * (1 + time);
  for (let n = row + (way > 0 ? 1 : 0); n >= 0 && n < track.rows; n += way) {
    if (track.columns.event[n] > 0 && (track.time[n] - time) * way > small) { seek(track.time[n]); return; }
  }
  seek(way > 0 ? lastTime() : 0);
}

// ---------------------------------------------------------------- start

/** Say what does not work here. @param {string} what @param {unknown} error */
function stuck(what, error) {
  element("stuck").textContent = `${what} (${error instanceof Error ? error.message : "blocked"}). The command vibralign computes them.`;
}

async function start() {
  element("gradient").style.background = `linear-gradient(90deg, ${CIVIDIS.map((each) => `rgb(${each.join(",")})`).join(", ")})`;
  makeControls();
  element("save").hidden = !MODEL.units;
  listen();
  writeControls();
  const about = MODEL.interface;
  try {
    const binary = await unpacked(MODEL.engine);
    runner = new Runner(await engineOf(binary, about), binary, MODEL);
    rerun();
    mapper = new Mapper(binary, about, MODEL.worker, (found, done) => {
      map = found;
      if (done && !measured.map) measured.map = performance.now() - mapStarted;
      if (!mapFrame) mapFrame = requestAnimationFrame(() => { mapFrame = 0; drawWholeMap(); });
    });
  } catch (error) {
    stuck(`This browser ${runner ? "starts no Worker: no map is" : "runs no WebAssembly here: no runs are"} computed`, error);
  }
  remap();
  writeAddress();
  Object.assign(window, { explorer: { measured, get state() { return state; }, get run() { return run; }, get map() { return map; }, seek } });
  if (!state.time && !matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
}

start().catch((error) => stuck("The page cannot show all that it holds", error));
