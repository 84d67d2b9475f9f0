// Amounts: numbers with units, as a reader types them and as they are shown.

/**
 * @typedef {{powers: number[], si: string, unit: string, one: number}} Quantity the powers of the units of length, time and force, and a
 *   factor; the SI unit; the unit in which it is shown, and its size in the SI unit
 * @typedef {Quantity & {name: string, symbol: string, letter: string, index: string, words: string, rule: string,
 *   bound: string, derived: string | null, least: number, most: number, first: boolean}} Parameter
 */

const PREFIXES = /** @type {Record<string, number>} */ ({ "": 1, G: 1e9, M: 1e6, k: 1e3, c: 1e-2, m: 1e-3, µ: 1e-6, μ: 1e-6, u: 1e-6, n: 1e-9 });
// Size, and powers of kg, m and s. An angle has none.
const UNIT_SIZES = /** @type {Record<string, number[]>} */ ({
  N: [1, 1, 1, -2], m: [1, 0, 1, 0], s: [1, 0, 0, 1], g: [1e-3, 1, 0, 0], Hz: [1, 0, 0, -1], rpm: [1 / 60, 0, 0, -1], min: [60, 0, 0, 1],
  rad: [1, 0, 0, 0], deg: [Math.PI / 180, 0, 0, 0], "°": [Math.PI / 180, 0, 0, 0], "%": [0.01, 0, 0, 0], 1: [1, 0, 0, 0],
});
const UNIT = /^([GMkcmµμun]?)(N|m|s|g|Hz|rpm|min|rad|deg|°|%|1)\^?([23²³]?)$/;
const POWERS = /** @type {Record<string, number>} */ ({ "": 1, 2: 2, 3: 3, "²": 2, "³": 3 });

/** Return size and powers of a unit such as "N m/rad", or null if it is unknown. @param {string} text @returns {number[] | null} */
function unitOf(text) {
  const found = [1, 0, 0, 0];
  for (const [n, part] of text.split("/").entries()) {
    for (const word of part.split(/[\s·*]+/).filter(Boolean)) {
      const read = UNIT.exec(word);
      if (!read) return null;
      const power = POWERS[read[3]] * (n ? -1 : 1), [size, ...powers] = UNIT_SIZES[read[2]];
      found[0] *= (PREFIXES[read[1]] * size) ** power;
      powers.forEach((each, k) => { found[k + 1] += power * each; });
    }
  }
  return found;
}

/** Return the size of a unit in another one, null if it is unknown, NaN if it is of another quantity. @param {string} text @param {string} si */
function sizeOf(text, si) {
  const [own, wanted] = [unitOf(text), /** @type {number[]} */ (unitOf(si))];
  if (!own) return null;
  if (own.slice(1).some((each, k) => each !== wanted[k + 1])) return NaN;
  return own[0] / wanted[0] / (si === "Hz" && text.includes("rad") ? 2 * Math.PI : 1);
}

/** Return the message on a value that breaks its rule, else "". @param {Parameter} parameter @param {number} value */
function fault(parameter, value) {
  if (Number.isNaN(value) && parameter.derived) return "";
  const inside = Number.isFinite(value) && (parameter.bound === "> 0" ? value > 0 : parameter.bound === ">= 0" ? value >= 0 : true);
  return inside ? "" : parameter.rule;
}

/**
 * Return the value typed for a parameter, in the unit shown or with a unit of its own, or a message why it is refused.
 * @param {Parameter} parameter @param {string} text @returns {{value: number, message: string}}
 */
function readAmount(parameter, text) {
  const { name, si, derived } = parameter, given = text.trim();
  const refused = (/** @type {string} */ message) => ({ value: NaN, message: `${name} = ${given || "(empty)"}: ${message}` });
  if (derived && (given === "" || given === "none")) return { value: NaN, message: "" };
  if (/\d,\d/.test(given)) return refused(`write ${given.replace(",", ".")}`);
  const read = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/.exec(given.replace("−", "-"));
  if (!read) return refused(parameter.rule);
  let size = /** @type {number | null} */ (parameter.one);
  if (read[2] !== "") {
    size = sizeOf(read[2], si);
    const wanted = si ? `in ${si} or alike` : "a ratio, without a unit or in %";
    if (size === null) return refused(`unknown unit '${read[2]}'; must be ${wanted}`);
    if (Number.isNaN(size)) return refused(`must be ${wanted}, not in ${read[2]}`);
  }
  const value = inOne(Number(read[1]), /** @type {number} */ (size)), message = fault(parameter, value);
  return message ? refused(message) : { value, message };
}

/** Round off the last digits of a number of units: they are due to the conversion. @param {number} value @param {number} one */
const inOne = (value, one) => Number((value * one).toPrecision(15));

/** Return a value without its unit, with six digits at most. @param {Quantity} quantity @param {number} value */
const withoutUnit = (quantity, value) => shown(value / quantity.one);

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
