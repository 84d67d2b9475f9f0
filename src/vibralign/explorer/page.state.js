// What is shown: the parameters and the view, in the address after #, and as a file.

/**
 * @typedef {{figure: string, values: Record<string, number>, x: string, y: string, spans: Record<string, number[] | undefined>,
 *   vibration: boolean, time: number | null}} State
 */

/** Return the message on values that do not go together, else "". @param {Record<string, number>} values @param {boolean} isDevice */
function misplaced(values, isDevice) {
  const { misalignment, half_width: width, clearance, press_force: force } = values;
  if (!isDevice) return misalignment >= width * (2 + clearance) ? `misalignment = ${shown(misalignment)}: the part would start wholly beside the slot` : "";
  const cosine = Math.cos(values.gripper_tilt), given = `misalignment = ${shown(misalignment)} m`, chamfer = values.peg_chamfer ?? 0;
  if (chamfer >= width) return `peg_chamfer = ${shown(chamfer)} m: must be smaller than half_width, or no face is left`;
  const pair = pairOf(values), play = (/** @type {number} */ half, /** @type {number} */ ratio) => half * (1 + ratio - cosine);
  const wide = play(pair.half_width, pair.clearance) + 2 * pair.half_width * cosine;
  if (misalignment >= wide) return `${given}: must be smaller than ${shown(wide)} m, or the part touches down wholly beside the hole`;
  if (!(force > 0)) return `press_force = ${shown(force)} N: must be > 0, or nothing presses the part`;
  if (!(misalignment > play(width, clearance))) return `${given}: already inside at the start: needs no alignment, misalignment <= clearance * half_width = ${shown(play(width, clearance))} m`;
  if (!(misalignment > play(pair.half_width, pair.clearance))) return `${given}: the chamfers meet: no vibration needed`;
  return "";
}

/** Return whether a device states a chamfer. @param {Record<string, number>} values */
const isChamfered = (values) => "peg_chamfer" in values || "hole_chamfer" in values;

/** Return half-width and clearance of the pair that chamfers leave (mouth.py). @param {Record<string, number>} values */
function pairOf({ half_width: half, clearance, peg_chamfer: own = 0, hole_chamfer: mouth = 0 }) {
  const face = half - own;
  return own || mouth ? { half_width: face, clearance: (half * (1 + clearance) + mouth) / face - 1 } : { half_width: half, clearance };
}

/** Return a device's values with its start as the engine takes it (mouth.py): the mass centre is over the middle of the face, and the springs are relaxed there. @param {Record<string, number>} values @returns {Record<string, number>} */
function startOf(values) {
  const { misalignment, half_height: height, gripper_tilt: tilt } = values;
  if (tilt === undefined) return values;
  const start = { misalignment: misalignment - height * Math.sin(tilt), initial_tilt: tilt, rest_tilt: tilt, rest_x: NaN, rest_y: NaN };
  return { ...values, ...pairOf(values), ...start };
}

/** Return the parameters as the engine takes them, dimensionless, in their order. @param {Record<string, number>} values @param {any} model @returns {Record<string, number>} */
function asParameters(values, model) {
  const start = startOf(values), quantities = byName(model.parameters);
  // A parameter that is not shown is an angle, or is not given.
  const scale = (/** @type {string} */ name) => (quantities[name] ? scaleOf(quantities[name], values) : 1);
  return Object.fromEntries(model.interface.parameters.map((/** @type {string} */ name) => [name, start[name] / scale(name)]));
}

/** Return results of a run; an alignment of a chamfered part at which a flank or a side is met is not known (mouth.py). @param {Record<string, number>} results @param {Record<string, number>} values @returns {Record<string, number>} */
function judged(results, values) {
  if (!isChamfered(values) || !Number.isFinite(results.tau_align)) return results;
  const steepest = Math.acos(Math.SQRT1_2 / (1 + pairOf(values).clearance)) - Math.PI / 4;
  const tilt = Math.max(results.tilt_max, Math.abs(results.tilt_at_alignment));
  return tilt > steepest || results.side_force_max > 0 ? { ...results, outcome: LEFT_SCENE, reason: MODEL.on_flank, tau_align: NaN } : results;
}

/** Return the state that an address asks for, or the first one and why the address is not taken, in words. @param {string} hash @param {any} model @returns {{state: State, ignored: string[]}} */
function stateOf(hash, model) {
  const asked = new URLSearchParams(hash.replace(/^#/, ""));
  const ignored = /** @type {string[]} */ ([]);
  /** Return the choice of an address, or the usual one. @param {string} key @param {string[]} choices @param {string} usual */
  const choice = (key, choices, usual) => {
    const text = asked.get(key) ?? usual;
    if (choices.includes(text)) return text;
    ignored.push(`${key} = ${text}: must be one of ${choices.length > 6 ? "those to choose from" : choices.join(", ")}`);
    return usual;
  };
  const figure = choice("figure", Object.keys(model.presets), model.first), preset = model.presets[figure];
  const start = { ...model.baseline, ...preset.values }, values = { ...start };
  const names = model.parameters.map((/** @type {Parameter} */ each) => each.name);
  for (const parameter of model.parameters) {
    const text = asked.get(parameter.name);
    if (text === null) continue;
    const value = numberOf(text), message = value === null && text !== "none" ? "must be a number" : fault(parameter, value ?? NaN);
    if (message) ignored.push(`${parameter.name} = ${text || "(empty)"}: ${message}`);
    else values[parameter.name] = value ?? NaN;
  }
  const message = misplaced(values, model.units);
  if (message && !misplaced(start, model.units)) ignored.push(message);
  const view = ["figure", "x", "y", "vibration", "t"];
  for (const key of new Set(asked.keys())) {
    if (![...names, ...view].includes(key)) ignored.push(`${key}: is no parameter`);
    else if (asked.getAll(key).length > 1) ignored.push(`${key}: is given twice`);
  }
  const x = choice("x", names, preset.x), y = choice("y", names, preset.y), time = numberOf(asked.get("t") ?? "0");
  if (time === null) ignored.push(`t = ${asked.get("t")}: must be a number`);
  const state = {
    figure, values, x, y: y === x ? (x === preset.y ? preset.x : preset.y) : y,
    spans: { x: preset.spans?.[x], y: preset.spans?.[y] },
    vibration: choice("vibration", ["on", "off"], "on") === "on",
    time: asked.has("t") ? Math.max(0, (time ?? 0) / scaleOf(model.time, values)) : null,
  };
  return { state: ignored.length ? stateOf("", model).state : state, ignored };
}

/** Return the values of a state that differ from others. @param {Record<string, number>} values @param {Record<string, number>} others */
function changed(values, others) {
  return Object.entries(values).filter(([name, value]) => !Object.is(value, others[name]));
}

/** Return the address of a state. @param {State} state @param {any} model */
function hashOf(state, model) {
  const preset = model.presets[state.figure];
  const asked = new URLSearchParams({ figure: state.figure });
  for (const [name, value] of changed(state.values, { ...model.baseline, ...preset.values })) {
    asked.set(name, Number.isNaN(value) ? "none" : String(value));
  }
  if (state.x !== preset.x) asked.set("x", state.x);
  if (state.y !== preset.y) asked.set("y", state.y);
  if (!state.vibration) asked.set("vibration", "off");
  if (state.time !== null) asked.set("t", shown(state.time * scaleOf(model.time, state.values)));
  return `#${asked}`;
}

/** Return the values of a run. @param {State} state @param {boolean} vibration @returns {Record<string, number>} */
function valuesOf(state, vibration) {
  return vibration ? state.values : { ...state.values, frequency: 0, phase: 0 };
}

/** Return the file of a device in SI units. @param {State} state @param {any} model */
function deviceOf(state, model) {
  const lines = ["# Saved from the explorer; for vibralign simulate, assess and map --device."];
  lines.push(`shape: ${model.interface.shape}`);
  const { start } = model.control, lowered = start === RUNNING || start === STILL;
  lines.push(lowered ? `vibrator: ${start === STILL ? "still" : "running"}` : "approach_speed: sudden");
  const quantities = byName(model.parameters);
  for (const [name, value] of Object.entries(state.values)) {
    if (Number.isNaN(value)) continue;
    const { one, unit } = quantities[name];
    lines.push(`${name}: ${inOne(value, 1 / one)} ${unit}`.trimEnd());
  }
  return `${lines.join("\n")}\n`;
}

/** Return descriptions of parameters by name. @param {Parameter[]} described @returns {Record<string, Parameter>} */
const byName = (described) => Object.fromEntries(described.map((each) => [each.name, each]));

/** Return the name of a state's device file. @param {State} state @param {any} model */
const fileOf = (state, model) => `${model.name || state.figure}.yaml`;
