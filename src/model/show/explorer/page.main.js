// The page: reads the address, runs the engines, draws, and follows what the reader does.

// A number that is not given is null in JSON.
const MODEL = JSON.parse(
  /** @type {HTMLElement} */ (document.getElementById("model")).textContent ?? "",
  (_, value) => (value === null ? NaN : value),
);
const CELLS = 65, FIRST_ROWS = 8192, SLOW_MAP = 150, SLOW_OTHER = 80;

/** @param {string} id @returns {any} */
const element = (id) => document.getElementById(id);
/** @type {Record<string, Parameter>} */
const parameters = Object.fromEntries(MODEL.parameters.map((/** @type {Parameter} */ each) => [each.name, each]));
const panels = MODEL.panels;
let state = stateOf(location.hash, MODEL);
/** @type {Engine | null} */
let runOne = null;
/** @type {Mapper | null} */
let mapper = null;
/** @type {{track: Track, results: Record<string, number>, device: any} | null} */
let run = null;
/** @type {{track: Track, results: Record<string, number>} | null} */
let other = null;
/** @type {MapData | null} */
let map = null;
/** @type {Record<string, MapData>} */
const stored = {};
let time = 0, playing = false, lastFrame = 0, mapTimer = 0, otherTimer = 0, mapStarted = 0, mapFrame = 0;
const measured = { runs: /** @type {number[]} */ ([]), map: 0, first: 0 };

// ---------------------------------------------------------------- running

/** Return a parameter as the engines take it, dimensionless. @param {string} name @param {number} value */
const converted = (name, value) => value / parameters[name].scale;

/** Return all values, dimensionless, as the drawing takes them. @param {Record<string, number>} values */
function drawnDevice(values) {
  const device = Object.fromEntries(Object.entries(values).map(([name, value]) => [name, converted(name, value)]));
  return { ...device, slot_half_width: device.half_width * (1 + device.clearance), force_shown: 1 };
}

/** Run one set and return its track and results. @param {Record<string, number>} values */
function integrated(values) {
  const set = MODEL.interface.parameters.map((/** @type {string} */ name) => converted(name, values[name]));
  let rows = FIRST_ROWS;
  for (;;) {
    const found = /** @type {Engine} */ (runOne)([set], MODEL.control, rows);
    const results = Object.fromEntries(MODEL.interface.results.map((/** @type {string} */ name, /** @type {number} */ n) => [name, found.results[n]]));
    if (results.tracked <= rows) return { track: trackOf(found.track, MODEL.interface.columns, results.tracked), results };
    rows = results.tracked;
  }
}

/** Run what the state says, and draw it. */
function rerun() {
  const message = Object.values(parameters).map((each) => fault(each, state.values[each.name])).find(Boolean) || misplaced(state.values);
  element("fault").textContent = message ? `Not run: ${message}` : "";
  if (message) return;
  if (runOne) {
    const begun = performance.now();
    run = { ...integrated(valuesOf(state, state.vibration)), device: drawnDevice(state.values) };
    measured.runs.push(performance.now() - begun);
    other = null;
    clearTimeout(otherTimer);
    if (state.compared) compare(); else otherTimer = setTimeout(() => { compare(); writeOutcome(); }, SLOW_OTHER);
  }
  if (!run) return;
  if (!state.vibration) run.device = { ...run.device, frequency: 0, phase: 0 };
  run.device.force_shown = Math.max(1, ...quantile(run.track.columns.contact_force));
  time = Math.min(state.time ?? time, lastTime());
  writeOutcome();
  drawRun();
}

/** Run the same set with or without vibration. */
function compare() { other = integrated(valuesOf(state, !state.vibration)); }

/** Return the other run if it is drawn, too. */
const drawnOther = () => (state.compared ? other : null);

/** Return the 95 % quantile of values, in a list. @param {Float64Array} values */
const quantile = (values) => [Float64Array.from(values).sort()[Math.floor(0.95 * (values.length - 1))]];

/** Return the end of the time axis: a settled motion is shown for its last periods only. */
function lastTime() {
  const track = /** @type {any} */ (run).track, ends = [track.time[track.rows - 1]];
  const beside = drawnOther();
  if (beside) ends.push(beside.track.time[beside.track.rows - 1]);
  return Math.min(Math.max(...ends), Math.max(ends[0], 20));
}

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
  const scene = contextOf("scene"), beside = drawnOther(), ghost = beside ? frameAt(beside.track, time) : null;
  const exaggeration = element("exaggerate").checked ? 5 : 1;
  drawScene(scene.context, scene.width, scene.height, frameAt(run.track, time), run.device, { exaggeration, ghost, colours: COLOURS });
  const plots = contextOf("plots");
  drawPlots(plots.context, plots.width, plots.height, run.track, beside?.track ?? null, panels, { time, end: lastTime(), label: MODEL.time.label, scale: MODEL.time.scale });
  writeMoment();
}

function drawWholeMap() {
  if (!map) return;
  const { context, width, height } = contextOf("map");
  const label = (/** @type {Parameter} */ each) => `${each.words}, ${each.symbol}${each.unit ? ` (${each.unit})` : ""}`;
  drawMap(context, width, height, map, { x: label(parameters[map.x]), y: label(parameters[map.y]) }, [state.values[map.x], state.values[map.y]], true);
  const [shortest, longest] = durations(map);
  element("shortest").textContent = inTime(shortest);
  element("longest").textContent = `${inTime(longest)} and longer`;
  const known = map.outcome.reduce((n, each) => n + Number(each >= 0), 0), aligned = map.outcome.reduce((n, each) => n + Number(each === 0), 0);
  const origin = map.stored ? " (stored by the study)" : known < map.outcome.length ? "; more is being computed" : "";
  const outlined = map.reliable ? " Black outline: aligns from every start that was tried." : "";
  element("share").textContent = known ? `${Math.round((100 * aligned) / known)} % of it aligns${origin}.${outlined}` : "";
}

/** Return the range of a map's axis. @param {"x" | "y"} side @returns {[number, number]} */
function span(side) {
  const { least, most } = parameters[state[side]];
  return /** @type {any} */ (state.spans[side]) ?? [least, most];
}

/** Show the stored map if it is this one, else compute it, a moment after the last change. */
function remap() {
  clearTimeout(mapTimer);
  const match = Object.values(stored).find((each) => each.x === state.x && each.y === state.y && sameElsewhere(/** @type {any} */ (each)));
  if (match && state.vibration) {
    mapper?.stop();
    map = match;
    drawWholeMap();
    return;
  }
  if (map && !map.stored && sameMap === mapKey()) { drawWholeMap(); return; }
  mapTimer = setTimeout(computeMap, SLOW_MAP);
}

/** @param {MapData & {values: Record<string, number>}} each */
const sameElsewhere = (each) => Object.entries(each.values).every(([name, value]) => name === state.x || name === state.y || Object.is(value, state.values[name]));

let sameMap = "";
/** Return what a map depends on. */
function mapKey() {
  const fixed = Object.entries(valuesOf(state, state.vibration)).filter(([name]) => name !== state.x && name !== state.y);
  return JSON.stringify([state.x, state.y, span("x"), span("y"), fixed.map(([, value]) => String(value))]);
}

function computeMap() {
  if (!mapper || element("fault").textContent) return;
  sameMap = mapKey();
  mapStarted = performance.now();
  mapper.compute(emptyMap(state.x, state.y, span("x"), span("y"), CELLS), valuesOf(state, state.vibration), converted, { ...MODEL.control, alignment_only: 1 });
}

// ---------------------------------------------------------------- controls

/** Make the controls of the parameters. */
function makeControls() {
  for (const each of Object.values(parameters)) {
    const row = document.createElement("div");
    row.className = "parameter";
    const step = (each.most - each.least) / 200;
    row.innerHTML = `<label for="p-${each.name}"><i>${each.letter}</i><sub>${each.index}</sub> ${each.words}</label>
      <input type="range" id="s-${each.name}" min="${each.least}" max="${each.most}" step="${step}" aria-label="${each.words}">
      <input type="text" inputmode="decimal" id="p-${each.name}" autocomplete="off"><span class="unit">${each.unit}</span>`;
    element(each.first ? "first" : "more").append(row);
    const [slider, box] = [element(`s-${each.name}`), element(`p-${each.name}`)];
    if (each.derived) box.placeholder = `as ${parameters[each.derived].symbol}`;
    slider.addEventListener("input", () => change(each.name, Number(Number(slider.value).toPrecision(4))));
    box.addEventListener("change", () => change(each.name, box.value.trim() === "" && each.derived ? NaN : Number(box.value.replace(",", ".") || NaN)));
  }
  for (const side of ["x", "y"]) {
    for (const each of Object.values(parameters)) element(side).append(new Option(`${each.symbol} ${each.words}`, each.name));
    element(side).addEventListener("change", () => {
      const before = state[/** @type {"x"} */ (side)], opposite = side === "x" ? "y" : "x";
      state[/** @type {"x"} */ (side)] = element(side).value;
      if (state.x === state.y) state[/** @type {"x"} */ (opposite)] = before;
      state.spans = { x: undefined, y: undefined };
      follow();
    });
  }
  const groups = /** @type {Record<string, HTMLOptGroupElement>} */ ({});
  for (const [name, preset] of Object.entries(MODEL.presets)) {
    const { group, title } = /** @type {any} */ (preset);
    groups[group] ??= element("preset").appendChild(Object.assign(document.createElement("optgroup"), { label: group }));
    groups[group].append(new Option(title, name));
  }
}

/** Show the state in the controls and the address. */
function writeControls() {
  for (const { name, derived } of Object.values(parameters)) {
    const value = state.values[name], box = element(`p-${name}`), slider = element(`s-${name}`);
    if (document.activeElement !== slider) slider.value = String(Number.isNaN(value) && derived ? state.values[derived] : value);
    box.value = Number.isNaN(value) ? "" : shown(value);
    box.setAttribute("aria-invalid", String(Boolean(fault(parameters[name], value))));
  }
  element("preset").value = state.figure;
  element("x").value = state.x;
  element("y").value = state.y;
  element("vibration").setAttribute("aria-pressed", String(!state.vibration));
  element("compare").setAttribute("aria-pressed", String(state.compared));
  element("about").textContent = MODEL.presets[state.figure].words ?? "";
  history.replaceState(null, "", hashOf(state, MODEL));
}

/** Follow a change of the state. */
function follow() {
  writeControls();
  rerun();
  remap();
}

/** @param {string} name @param {number} value */
function change(name, value) {
  state.values = { ...state.values, [name]: value };
  state.time = null;
  follow();
}

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
  element("play").setAttribute("aria-pressed", String(playing));
  if (!playing) { state.time = time > 0 ? time : null; history.replaceState(null, "", hashOf(state, MODEL)); return; }
  if (time >= lastTime()) time = 0;
  lastFrame = 0;
  requestAnimationFrame(advance);
}

/** @param {number} now */
function advance(now) {
  if (!playing) return;
  const speed = Number(element("speed").value) * Math.max(lastTime() / 60, Math.min(lastTime(), 30) / 10);
  if (lastFrame) seek(time + (speed * (now - lastFrame)) / 1000);
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

/** Choose a point of the map. @param {number} x @param {number} y */
function choose(x, y) {
  state.values = { ...state.values, [state.x]: Number(x.toPrecision(4)), [state.y]: Number(y.toPrecision(4)) };
  state.time = null;
  follow();
}

/** @param {string} text @param {string} said */
async function copy(text, said) {
  element("copied").textContent = text;
  try { await navigator.clipboard.writeText(text); element("said").textContent = said; } catch { element("said").textContent = "Copy it from here:"; }
}

function listen() {
  element("play").addEventListener("click", () => play(!playing));
  element("before").addEventListener("click", () => stepEvent(-1));
  element("next").addEventListener("click", () => stepEvent(1));
  element("scrub").addEventListener("input", () => { play(false); seek((Number(element("scrub").value) / 1000) * lastTime()); });
  element("exaggerate").addEventListener("change", drawRun);
  element("vibration").addEventListener("click", () => { state.vibration = !state.vibration; follow(); });
  element("compare").addEventListener("click", () => { state.compared = !state.compared; follow(); });
  element("preset").addEventListener("change", () => { state = stateOf(`#figure=${element("preset").value}`, MODEL); time = 0; follow(); });
  element("link").addEventListener("click", () => copy(location.href, "Link copied:"));
  element("command").addEventListener("click", () => copy(commandOf(state, MODEL), "Command copied:"));
  element("save").addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([deviceOf(state, MODEL)], { type: "text/yaml" }));
    link.download = "device.yaml";
    link.click();
  });
  const plots = element("plots");
  const point = (/** @type {PointerEvent} */ event) => { play(false); seek(timeAxis(plots.clientWidth, lastTime()).back(event.offsetX)); };
  plots.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => { plots.setPointerCapture(event.pointerId); point(event); });
  plots.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => { if (event.buttons) point(event); });
  const canvas = element("map");
  const pick = (/** @type {PointerEvent} */ event) => {
    if (!map) return;
    const place = mapPlaces(map, canvas.clientWidth, canvas.clientHeight);
    choose(place.valueX(event.offsetX), place.valueY(event.offsetY));
  };
  canvas.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => { canvas.setPointerCapture(event.pointerId); pick(event); });
  canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => { if (event.buttons) pick(event); });
  canvas.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!way || !map) return;
    event.preventDefault();
    const size = event.shiftKey ? 0.05 : 1 / (CELLS - 1), inside = (/** @type {number} */ v, /** @type {[number, number]} */ of) => Math.max(of[0], Math.min(of[1], v));
    choose(inside(state.values[state.x] + way[0] * size * (map.xs[1] - map.xs[0]), map.xs), inside(state.values[state.y] + way[1] * size * (map.ys[1] - map.ys[0]), map.ys));
  });
  document.addEventListener("keydown", (event) => {
    if (/** @type {HTMLElement} */ (event.target).matches?.("input, select, button, summary, canvas#map")) return;
    if (event.key === " ") { event.preventDefault(); play(!playing); }
    if (event.key === "ArrowRight") stepEvent(1);
    if (event.key === "ArrowLeft") stepEvent(-1);
  });
  addEventListener("hashchange", () => { state = stateOf(location.hash, MODEL); follow(); });
  addEventListener("resize", () => { drawRun(); drawWholeMap(); });
}

/** Return pictures of the drawing, over the whole run, as data URLs. @param {number} count */
function pictures(count) {
  play(false);
  return Array.from({ length: count }, (_, n) => {
    seek((lastTime() * n) / (count - 1));
    return element("scene").toDataURL("image/png");
  });
}

async function start() {
  element("gradient").style.background = gradient();
  makeControls();
  listen();
  writeControls();
  const about = MODEL.interface;
  if (MODEL.run) {
    const numbers = new Float64Array(await unpacked(MODEL.run.track));
    run = { track: trackOf(numbers, about.columns, MODEL.run.results.tracked), results: MODEL.run.results, device: drawnDevice(state.values) };
    document.body.classList.add("only-run");
    rerun();
  } else {
    for (const [name, each] of Object.entries(MODEL.maps)) stored[name] = Object.assign(await storedMap(each), { values: /** @type {any} */ (each).values });
    runOne = await engineOf(await unpacked(MODEL.modules.run_one), "run_one", about);
    rerun();
    measured.first = performance.now();
    const binary = await unpacked(MODEL.modules.run_many);
    mapper = new Mapper(binary, about, MODEL.worker, (found, done) => {
      map = found;
      if (done && !measured.map) measured.map = performance.now() - mapStarted;
      if (!mapFrame) mapFrame = requestAnimationFrame(() => { mapFrame = 0; drawWholeMap(); });
    });
    remap();
  }
  Object.assign(window, { explorer: { measured, get state() { return state; }, get run() { return run; }, get map() { return map; }, seek, pictures } });
  if (!state.time && !matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
}

start();
