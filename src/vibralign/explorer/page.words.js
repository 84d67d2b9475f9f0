// Words on a run: its outcome, its unvibrated control, and the moment that is shown.

/** Return an outcome in words. @param {Record<string, number>} results */
function outcomeWords(results) {
  const outcome = MODEL.outcomes[results.outcome], reason = MODEL.reasons[results.reason];
  return outcome + (reason ? `: ${reason}` : "");
}

/** Return words with a hole in place of the slot for a round part. @param {string} words */
const inShape = (words) => (MODEL.interface.shape === "round" ? words.replace(/slot/g, "hole") : words);

/** Return the unit in which times up to one are shown, and its size in the page's unit. @param {number} time in the page's unit @returns {[string, number]} */
const timeUnit = (time) => (!MODEL.units ? ["", 1] : Math.abs(time) < 1 ? ["ms", 1e-3] : ["s", 1]);

/** Return a time of the drawn device in words. @param {number} value in units of 1/p */
function inTime(value) {
  const time = value * scaleOf(MODEL.time, run?.values ?? state.values), [unit, one] = timeUnit(time);
  return MODEL.units ? `${rounded(time / one)} ${unit}` : `τ = ${rounded(time)}`;
}

/** Return the largest force of a run in words, and until when it is known. @param {Record<string, number>} results */
function forceWords(results) {
  const one = scaleOf(MODEL.force, run?.values ?? state.values), unit = MODEL.units ? " N" : "";
  const tips = MODEL.interface.shape === "round" ? `, at each tip ${rounded(0.5 * results.edge_force_max * one)}${unit}` : "";
  return `Largest force at one place: ${rounded(results.contact_force_max * one)}${unit}${tips}, from this start, ${MODEL.forces_known}.`;
}

/** @param {number} value in units of 1/p */
const atTime = (value) => `${MODEL.units ? "after" : "at"} ${inTime(value)}`;

/** @param {Record<string, number>} results */
const aligns = (results) => Number.isFinite(results.tau_align);

/** @param {number} angle */
const degrees = (angle) => `${Number(((180 / Math.PI) * angle).toPrecision(2))}°`;

/** Return whether a part rests on the edge, as a run without vibration ends. @param {Record<string, number>} results */
const rests = (results) => results.outcome === SETTLED && results.end_on_edge === 1 && results.end_tilt > 0;

/** Return the end of a run without vibration, in the words of the commands. @param {Record<string, number>} results @param {number} slow tilt under a slow press */
function stillWords(results, slow) {
  const words = MODEL.unvibrated[aligns(results) ? 0 : rests(results) ? 1 : 2];
  if (aligns(results)) return `${words}, ${atTime(results.tau_align)}`;
  if (rests(results)) return `${words}, tilted by ${degrees(results.end_tilt)}`;
  return Number.isNaN(slow) ? words : `${words}; pressed slowly it rests, tilted by ${degrees(slow)}`;
}

/** Return what vibration changes. @param {Record<string, number>} vibrated @param {Record<string, number>} still @param {number} slow @param {boolean} vibration true if the vibrated run is shown */
function comparisonWords(vibrated, still, slow, vibration) {
  const together = aligns(vibrated), alone = aligns(still);
  const first = vibration ? `Without vibration it ${stillWords(still, slow)}` : `With vibration it ${together ? `aligns ${atTime(vibrated.tau_align)}` : "does not align"}`;
  const share = Math.round(100 * Math.abs(vibrated.tau_align / still.tau_align - 1));
  if (together && alone) return `${first}: vibration ${share > 0 ? `makes it ${share} % ${vibrated.tau_align < still.tau_align ? "faster" : "slower"}` : "changes nothing"}.`;
  if (together) return `${first}${rests(still) || !Number.isNaN(slow) ? ": only vibration brings it in" : ""}.`;
  return `${first}${alone ? ": vibration keeps it out" : ""}.`;
}

/** Return the verdict on a run. @param {Record<string, number>} results */
function verdictWords(results) {
  if (results.tau_align === 0) return "In from the start";
  if (!aligns(results)) return "Does not align";
  const aligned = `Aligned ${atTime(results.tau_align)}`;
  if (results.outcome === INSERTED) return `${aligned}, inserted ${atTime(results.tau_align + results.tau_inserted)}`;
  return results.outcome === ALIGNED ? aligned : `${aligned}, but does not go in`;
}

/** Show a message in place of the outcome: a value is refused, or a run is under way. @param {string} message @param {boolean} refused */
function writeInstead(message, refused) {
  element("outcome").dataset.outcome = refused ? "refused" : "computing";
  element("fault").textContent = refused ? message : "";
  element("verdict").textContent = refused ? "" : message;
  for (const name of ["words", "remedy", "beside"]) element(name).textContent = "";
  document.body.classList.add("stale");
}

function writeOutcome() {
  const { results } = /** @type {any} */ (run), aligned = aligns(results), good = results.outcome === ALIGNED || results.outcome === INSERTED;
  document.body.classList.remove("stale");
  element("fault").textContent = "";
  element("outcome").dataset.outcome = good ? "aligned" : "not";
  element("verdict").textContent = verdictWords(results);
  const slow = slowTilt, times = results.separations;
  const lifted = times === 0 ? "It never lifts off." : `It lifts off ${times === 1 ? "once" : `${times} times`}.`;
  const ended = state.vibration || aligned ? outcomeWords(results) : `without vibration it ${stillWords(results, slow)}`;
  const drawn = run && results.tracked > run.track.rows ? ` The drawing ends at ${inTime(run.track.time[run.track.rows - 1])}: the run is longer than the page keeps.` : "";
  const from = MODEL.control.start === STILL ? "the onset of the vibration" : "the first touch";
  const counted = run && run.track.zero > 0 ? ` Its times count from ${from}, ${inTime(run.track.zero)} after the picture begins.` : "";
  element("words").textContent = `${ended[0].toUpperCase()}${ended.slice(1)}. ${aligned ? `${lifted} ` : ""}${forceWords(results)}${drawn}${counted}`;
  element("remedy").textContent = good || !state.vibration ? "" : `What to do: ${MODEL.remedies_of_reasons[results.reason] ?? MODEL.remedies[results.outcome]}.`;
  const both = other && (state.vibration ? [results, other.results] : [other.results, results]);
  element("beside").textContent = both && results.tau_align !== 0 ? comparisonWords(both[0], both[1], slow, state.vibration) : "";
}

function writeMoment() {
  if (!run) return;
  const frame = frameAt(run.track, time);
  const event = run.track.columns.event[rowAt(run.track, time)];
  const just = event > 0 ? `event: ${MODEL.events[event - 1]}` : "";
  element("moment").textContent = `${inTime(time)} · ${inShape(contactWords(/** @type {any} */ (frame)))}${just ? ` · ${just}` : ""}`;
  const scrub = element("scrub");
  scrub.value = String(Math.round((1000 * time) / lastTime()));
  scrub.setAttribute("aria-valuetext", element("moment").textContent);
}
