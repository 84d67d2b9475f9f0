// The controls: sliders and fields of the parameters, buttons, keys, and what they change.

/** Make the controls of the parameters. */
function makeControls() {
  for (const each of Object.values(parameters)) {
    const row = document.createElement("div");
    row.className = "parameter";
    const step = (each.most - each.least) / 200;
    row.innerHTML = `<label for="p-${each.name}"><i>${each.letter}</i><sub>${each.index}</sub> ${each.words}</label>
      <input type="range" id="s-${each.name}" min="${each.least}" max="${each.most}" step="${step}" aria-label="${each.words}">
      <input type="text" id="p-${each.name}" autocomplete="off" aria-describedby="fault"><span class="unit">${each.unit}</span>`;
    element(each.first ? "first" : "more").append(row);
    const [slider, box] = [element(`s-${each.name}`), element(`p-${each.name}`)];
    if (each.derived) box.placeholder = `as ${parameters[each.derived].symbol}`;
    let held = { state, entered, refusal };
    slider.addEventListener("pointerdown", () => { held = { state, entered, refusal }; });
    // A finger that scrolls from here has moved the slider.
    slider.addEventListener("pointercancel", () => { ({ state, entered, refusal } = held); follow(); });
    slider.addEventListener("input", () => take({ [each.name]: textOf(each, Number(slider.value)) }));
    box.addEventListener("change", () => take({ [each.name]: box.value }));
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

/** Return a value of a slider or the map as text for its field, with four digits. @param {Parameter} parameter @param {number} value */
const textOf = (parameter, value) => String(Number((value / parameter.one).toPrecision(4)));

/** Show the state in the controls and the address. */
function writeControls() {
  for (const { name, derived } of Object.values(parameters)) {
    const value = state.values[name], box = element(`p-${name}`), slider = element(`s-${name}`);
    if (document.activeElement !== slider) slider.value = String(Number.isNaN(value) && derived ? state.values[derived] : value);
    box.value = entered[name] ?? (Number.isNaN(value) ? "" : shown(value / parameters[name].one));
    box.setAttribute("aria-invalid", String(name in entered));
  }
  element("preset").value = state.figure;
  element("x").value = state.x;
  element("y").value = state.y;
  element("vibration").textContent = state.vibration ? "Without vibration" : "With vibration";
  element("map-title").textContent = state.vibration ? "Where it aligns" : "Where it aligns without vibration";
  element("about").textContent = MODEL.presets[state.figure].words ?? "";
  element("ignored").textContent = ignored.length ? `The address is not taken: ${ignored.join("; ")}.` : "";
}

const ADDRESS_PAUSE = 400; // ms
let addressed = -ADDRESS_PAUSE, addressTimer = 0;
/** Write the state into the address, not too often: browsers allow some three changes a second, and throw beyond. */
function writeAddress() {
  clearTimeout(addressTimer);
  const pause = addressed + ADDRESS_PAUSE - performance.now();
  if (pause > 0) { addressTimer = setTimeout(writeAddress, pause); return; }
  addressed = performance.now();
  try { history.replaceState(null, "", hashOf(state, MODEL)); } catch { addressTimer = setTimeout(writeAddress, 10 * ADDRESS_PAUSE); }
}

/** Follow a change of the state: the answer first, the address last. */
function follow() {
  writeControls();
  rerun();
  remap();
  writeAddress();
}

/** Take what fields say. What breaks a rule stays in its field with a message, and nothing is run. @param {Record<string, string>} texts */
function take(texts) {
  const values = { ...state.values }, asked = { ...entered, ...texts };
  const refused = /** @type {Record<string, string>} */ ({});
  refusal = "";
  for (const [name, text] of Object.entries(asked)) {
    const { value, message } = readAmount(parameters[name], text);
    if (message) { refused[name] = text; refusal ||= message; } else values[name] = value;
  }
  const message = misplaced(values, MODEL.units);
  entered = message ? asked : refused;
  refusal ||= message;
  if (!message) state = { ...state, values };
  state.time = null;
  ignored = [];
  follow();
}

/** Take the state of an address; one that is refused changes nothing. @param {string} hash */
function open(hash) {
  const asked = stateOf(hash, MODEL);
  ignored = asked.ignored;
  if (!ignored.length) [state, entered, refusal] = [asked.state, {}, ""];
  follow();
}

/** Choose a point of the map. @param {number} x @param {number} y */
const choose = (x, y) => take({ [state.x]: textOf(parameters[state.x], x), [state.y]: textOf(parameters[state.y], y) });

/** @param {string} text @param {string} said */
async function copy(text, said) {
  if (refusal) { element("said").textContent = `Not copied: ${refusal}`; element("copied").textContent = ""; return; }
  element("copied").textContent = text;
  try { await navigator.clipboard.writeText(text); element("said").textContent = said; } catch { element("said").textContent = "Copy it from here:"; }
}

/** Save the device as a file. */
function save() {
  if (refusal) { element("said").textContent = `Not saved: ${refusal}`; return; }
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([deviceOf(state, MODEL)], { type: "text/yaml" }));
  link.download = fileOf(state, MODEL);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

/** Follow the pointer while it is pressed; a finger taps, since it scrolls where it is moved. @param {any} canvas @param {(event: PointerEvent) => void} point */
function drag(canvas, point) {
  let finger = false;
  canvas.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => {
    finger = event.pointerType === "touch";
    if (!finger) { canvas.setPointerCapture(event.pointerId); point(event); }
  });
  canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => { if (!finger && event.buttons) point(event); });
  canvas.addEventListener("click", (/** @type {PointerEvent} */ event) => { if (finger) point(event); });
}

function listen() {
  element("play").addEventListener("click", () => play(!playing));
  element("before").addEventListener("click", () => stepEvent(-1));
  element("next").addEventListener("click", () => stepEvent(1));
  element("speed").addEventListener("change", writePace);
  element("scrub").addEventListener("input", () => { play(false); seek((Number(element("scrub").value) / 1000) * lastTime()); });
  element("exaggerate").addEventListener("change", drawRun);
  element("vibration").addEventListener("click", () => { state.vibration = !state.vibration; follow(); });
  element("preset").addEventListener("change", () => { time = 0; open(`#figure=${element("preset").value}`); });
  element("link").addEventListener("click", () => copy(`${location.href.split("#")[0]}${hashOf(state, MODEL)}`, "Link copied:"));
  element("save").addEventListener("click", save);
  const plots = element("plots"), canvas = element("map");
  drag(plots, (event) => { play(false); seek(timeAxis(plots.clientWidth, lastTime()).back(event.offsetX)); });
  drag(canvas, (event) => {
    if (!map) return;
    const place = mapPlaces(map, canvas.clientWidth, canvas.clientHeight);
    choose(place.valueX(event.offsetX), place.valueY(event.offsetY));
  });
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
  addEventListener("hashchange", (event) => open(new URL(event.newURL).hash)); // the page may have written another since
  addEventListener("resize", () => { drawRun(); drawWholeMap(); });
}
