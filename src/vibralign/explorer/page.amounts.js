// Amounts: numbers with units, as a reader types them and as they are shown.

/**
 * @typedef {{powers: number[], si: string, unit: string, one: number}} Quantity the powers of the units of length, time and force, and a
 *   factor; the SI unit; the unit in which it is shown, and its size in the SI unit
 * @typedef {Quantity & {name: string, symbol: string, letter: string, index: string, words: string, rule: string,
 *   bound: string, derived: string | null, least: number, most: number, first: boolean}} Parameter
 */

const NUMBER = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;

/** Return the number that a text is, written as the commands take it; else null. @param {string} text */
function numberOf(text) {
  const read = NUMBER.exec(text.trim());
  return read && read[2] === "" ? Number(read[1]) : null;
}

/** Return the message on a value that breaks its rule, else "". @param {Parameter} parameter @param {number} value */
function fault(parameter, value) {
  if (Number.isNaN(value) && parameter.derived) return "";
  const inside = Number.isFinite(value) && (parameter.bound === "> 0" ? value > 0 : parameter.bound === ">= 0" ? value >= 0 : true);
  return inside ? "" : parameter.rule;
}

/**
 * Return the value typed for a parameter, in the unit that is shown, or a message why it is refused.
 * @param {Parameter} parameter @param {string} text @returns {{value: number, message: string}}
 */
function readAmount(parameter, text) {
  const { name, unit, derived } = parameter, given = text.trim().replace("−", "-");
  const refused = (/** @type {string} */ message) => ({ value: NaN, message: `${name} = ${given || "(empty)"}: ${message}` });
  if (derived && (given === "" || given === "none")) return { value: NaN, message: "" };
  const read = NUMBER.exec(given);
  if (!read) return refused(parameter.rule);
  if (read[2] !== "" && read[2] !== unit) return refused(unit ? `must be a number in ${unit}` : "must be a number without a unit");
  const value = inOne(Number(read[1]), parameter.one), message = fault(parameter, value);
  return message ? refused(message) : { value, message };
}

/** Round off the last digits of a number of units: they are due to the conversion. @param {number} value @param {number} one */
const inOne = (value, one) => Number((value * one).toPrecision(15));

/** Return a number with six digits at most. @param {number} value */
function shown(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(6))) : "–";
}

/** Return a number with four digits. @param {number} value */
const rounded = (value) => shown(Number(value.toPrecision(4)));

/** Return one dimensionless unit of a quantity in the page's unit. @param {Quantity} quantity @param {Record<string, number>} values those of a device */
function scaleOf({ powers: [length, time, force, factor] }, values) {
  const { mass, axial_stiffness: stiffness, amplitude } = values;
  return mass === undefined ? 1 : factor * amplitude ** length * Math.sqrt(mass / stiffness) ** time * (stiffness * amplitude) ** force;
}
