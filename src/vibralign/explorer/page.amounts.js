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
  N: [1, 1, 1, -2], m: [1, 0, 1, 0], s: [1, 0, 0, 1], g: [1e-3, 1, 0, 0], Hz: [1, 0, 0, -1], rpm: [1 / 60, 0, 0, -1], rev: [1, 0, 0, 0], min: [60, 0, 0, 1],
  in: [0.0254, 0, 1, 0], mil: [2.54e-5, 0, 1, 0], thou: [2.54e-5, 0, 1, 0], lb: [0.45359237, 1, 0, 0], lbf: [4.4482216152605, 1, 1, -2],
  rad: [1, 0, 0, 0], deg: [Math.PI / 180, 0, 0, 0], "°": [Math.PI / 180, 0, 0, 0], "%": [0.01, 0, 0, 0], 1: [1, 0, 0, 0],
});
const UNIT = /^([GMkcmµμun]?)(N|m|s|g|Hz|rad)$/; // with a prefix
const POWER = /(?:\^|\*\*)?(-?[123]|[²³])$/, POWERS = /** @type {Record<string, number>} */ ({ "²": 2, "³": 3 });
// Spellings as in a device file (spelling.py): names of one meaning in whatever case, names run together, grouped digits.
const CASES = new Map(["Hz", "kHz", "kg", "kN", "rpm", "rad", "deg"].map((name) => [name.toLowerCase(), name]));
const TOGETHER = /^([kMmuµμ]?N|k?g)([mcuµμ]?m)?(m?s)?$/, LETTER = "[A-Za-zµμ]";
const GROUPED = /(?<![\d.,])[1-9]\d{0,2}(?:[ ,'’_]\d{3})+(?![\d.]*,)(?!\d)/;

/** Return a unit as `unitOf` reads it, for a quantity in a unit. @param {string} text @param {string} si */
function spelled(text, si) {
  const names = text.replace(new RegExp(`(?<=${LETTER})-(?=${LETTER})`, "g"), " ").replace(/\*\*/g, "^");
  return names.replace(new RegExp(`${LETTER}+`, "g"), (name) => {
    if (si.includes("N") && (name === "lb" || name === "lbs")) return "lbf";
    const together = TOGETHER.exec(name);
    return together ? together.slice(1).filter(Boolean).join(" ") : name === "mils" ? "mil" : (CASES.get(name.toLowerCase()) ?? name);
  });
}

/** Return what to write in place of a number with a comma or grouped digits, "" without. @param {string} text */
function clearer(text) {
  const grouped = GROUPED.exec(text), decimal = text.replace(/(?<=\d),(?=\d)/g, ".");
  if (!grouped) return decimal === text ? "" : text.replace(/(?<=\d)\.(?=\d+[.,])/g, "").replace(/(?<=\d),(?=\d)/g, ".");
  const whole = text.replace(grouped[0], grouped[0].replace(/\D/g, ""));
  const isOneComma = /^\d+,\d+$/.test(grouped[0]) && text[grouped.index + grouped[0].length] !== ".";
  return isOneComma ? `${whole} if the comma groups thousands, ${decimal} if it is decimal` : whole;
}

/** Return size and powers of a unit such as "N m/rad", or null if it is unknown. @param {string} text @returns {number[] | null} */
function unitOf(text) {
  const found = [1, 0, 0, 0];
  for (const [n, part] of text.split("/").entries()) {
    for (const word of part.split(/[\s·*]+/).filter(Boolean)) {
      const raised = word === "1" ? null : POWER.exec(word), name = raised ? word.slice(0, raised.index) : word;
      const read = Object.hasOwn(UNIT_SIZES, name) ? ["", "", name] : UNIT.exec(name);
      if (!read) return null;
      const power = (raised ? (POWERS[raised[1]] ?? Number(raised[1])) : 1) * (n ? -1 : 1), [size, ...powers] = UNIT_SIZES[read[2]];
      found[0] *= (PREFIXES[read[1]] * size) ** power;
      powers.forEach((each, k) => { found[k + 1] += power * each; });
    }
  }
  return found;
}

/** Return the size of a unit in another one, null if it is unknown, NaN if it is of another quantity. @param {string} text @param {string} si */
function sizeOf(text, si) {
  const [own, wanted] = [unitOf(spelled(text, si)), /** @type {number[]} */ (unitOf(si))];
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
  const { name, si, derived } = parameter, given = text.trim().replace(/[\u00a0\u2009\u202f]/g, " ").replace("−", "-");
  const refused = (/** @type {string} */ message) => ({ value: NaN, message: `${name} = ${given || "(empty)"}: ${message}` });
  if (derived && (given === "" || given === "none")) return { value: NaN, message: "" };
  const instead = clearer(given);
  if (instead) return refused(`write ${instead}`);
  const read = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/.exec(given);
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
