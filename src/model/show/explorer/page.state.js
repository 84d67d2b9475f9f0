// What is shown: the parameters and the view, in the address after #; as a command, and as a file.

/**
 * @typedef {{name: string, symbol: string, letter: string, index: string, words: string, unit: string, scale: number, rule: string,
 *   bound: string, derived: string | null, least: number, most: number, first: boolean}} Parameter
 * @typedef {{figure: string, values: Record<string, number>, x: string, y: string, spans: Record<string, number[] | undefined>,
 *   vibration: boolean, compared: boolean, time: number | null}} State
 */

/** Return a number with six digits at most. @param {number} value */
function shown(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(6))) : "–";
}

/** Return the message on a value that breaks its rule, else "". @param {Parameter} parameter @param {number} value */
function fault(parameter, value) {
  if (Number.isNaN(value) && parameter.derived) return "";
  const inside = Number.isFinite(value) && (parameter.bound === "> 0" ? value > 0 : parameter.bound === ">= 0" ? value >= 0 : true);
  return inside ? "" : `${parameter.name} ${parameter.rule}`;
}

/** Return the message on values that do not go together, else "". @param {Record<string, number>} values */
function misplaced(values) {
  const most = values.half_width * (2 + values.clearance);
  return values.misalignment >= most ? "misalignment: the part would start wholly beside the slot" : "";
}

/** Return the state that an address asks for. @param {string} hash @param {any} model @returns {State} */
function stateOf(hash, model) {
  const asked = new URLSearchParams(hash.replace(/^#/, ""));
  const figure = asked.get("figure") ?? "";
  const preset = model.presets[figure] ?? model.presets[model.first];
  const values = { ...model.baseline, ...preset.values };
  for (const parameter of model.parameters) {
    const text = asked.get(parameter.name);
    if (text === null) continue;
    const value = text === "none" ? NaN : Number(text);
    if (!fault(parameter, value)) values[parameter.name] = value;
  }
  const names = model.parameters.map((/** @type {Parameter} */ each) => each.name);
  const axis = (/** @type {string} */ side) => (names.includes(asked.get(side) ?? "") ? String(asked.get(side)) : preset[side]);
  const [x, y] = [axis("x"), axis("y")];
  const spans = { x: preset.spans?.[x], y: preset.spans?.[y] };
  const time = asked.get("t") === null ? NaN : Number(asked.get("t"));
  return {
    figure: model.presets[figure] ? figure : model.first, values, x, y: y === x ? preset.y : y, spans,
    vibration: asked.get("vibration") !== "off", compared: asked.get("compared") === "on",
    time: Number.isFinite(time) ? time / model.time.scale : null,
  };
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
  if (state.compared) asked.set("compared", "on");
  if (state.time !== null) asked.set("t", shown(state.time * model.time.scale));
  return `#${asked}`;
}

/** Return the values of a run. @param {State} state @param {boolean} vibration @returns {Record<string, number>} */
function valuesOf(state, vibration) {
  return vibration ? state.values : { ...state.values, frequency: 0, phase: 0 };
}

/** Return the command of a state's run. @param {State} state @param {any} model */
function commandOf(state, model) {
  const values = valuesOf(state, state.vibration);
  const sets = changed(values, model.baseline).map(([name, value]) => `--set ${name}=${Number.isNaN(value) ? "none" : value}`);
  return ["vibralign simulate --scene insertion", ...(model.device ? [`--device ${model.device}`] : []), ...sets].join(" ");
}

/** Return a state's device file, in SI units. @param {State} state @param {any} model */
function deviceOf(state, model) {
  const lines = ["# Saved from the explorer; for vibralign simulate, assess and map --device."];
  if (!model.units) lines.push("# The device has no units: mass, axial stiffness and amplitude are 1, so that its other numbers are dimensionless,", "# except the frequency, which is in Hz.");
  for (const [name, value] of Object.entries(model.units || { mass: 1, axial_stiffness: 1, amplitude: 1 })) lines.push(`${name}: ${value}`);
  for (const { name, si } of model.parameters) {
    const value = state.values[name];
    if (!Number.isNaN(value)) lines.push(`${name}: ${value * si}`);
  }
  return `${lines.join("\n")}\n`;
}
