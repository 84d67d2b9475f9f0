// Words on a run: its outcome, its twin without vibration, and the moment that is shown.

/** Return an outcome in words. @param {Record<string, number>} results */
function outcomeWords(results) {
  const outcome = MODEL.outcomes[results.outcome], reason = MODEL.reasons[results.reason];
  return outcome + (reason ? `: ${reason}` : "");
}

/** @param {number} value in units of 1/p */
const inTime = (value) => (MODEL.time.unit ? `${rounded(value * MODEL.time.scale)} ${MODEL.time.unit}` : `τ = ${rounded(value)}`);

/** @param {number} value in units of 1/p */
const atTime = (value) => `${MODEL.time.unit ? "after" : "at"} ${inTime(value)}`;

/** Return a number with four digits. @param {number} value */
const rounded = (value) => shown(Number(value.toPrecision(4)));

/** @param {string} text */
const capital = (text) => text[0].toUpperCase() + text.slice(1);

/** @param {Record<string, number>} results */
const aligns = (results) => Number.isFinite(results.tau_align);

/** Return whether a part rests on the edge, as a run without vibration ends. @param {Record<string, number>} results */
const rests = (results) => results.outcome === SETTLED && results.end_on_edge === 1 && results.end_tilt > 0;

/** Return the end of a run without vibration. @param {Record<string, number>} results */
function stillWords(results) {
  if (aligns(results)) return `it aligns ${atTime(results.tau_align)}`;
  if (rests(results)) return `it comes to rest on the edge, tilted by ${rounded((180 / Math.PI) * results.end_tilt)}°, and stays there`;
  return `it does not align: ${outcomeWords(results)}`;
}

/** Return what vibration changes. @param {Record<string, number>} vibrated @param {Record<string, number>} still @param {boolean} vibration the first is shown */
function comparisonWords(vibrated, still, vibration) {
  const together = aligns(vibrated), alone = aligns(still);
  const first = vibration ? `Without vibration ${stillWords(still)}` : `With vibration ${together ? `it aligns ${atTime(vibrated.tau_align)}` : "it does not align"}`;
  const share = Math.round(100 * Math.abs(vibrated.tau_align / still.tau_align - 1));
  if (together && alone) return `${first}: vibration makes it ${share} % ${vibrated.tau_align < still.tau_align ? "faster" : "slower"}.`;
  if (together) return `${first}: only vibration brings it in.`;
  return `${first}${alone ? ": vibration keeps it out" : ""}.`;
}

/** Return the verdict on a run. @param {Record<string, number>} results */
function verdictWords(results) {
  if (!aligns(results)) return "Does not align";
  const aligned = `Aligned ${atTime(results.tau_align)}`;
  if (results.outcome === INSERTED) return `${aligned}, inserted ${atTime(results.tau_align + results.tau_inserted)}`;
  return results.outcome === ALIGNED ? aligned : `${aligned}, but does not go in`;
}

function writeOutcome() {
  const { results } = /** @type {any} */ (run), aligned = aligns(results), good = results.outcome === ALIGNED || results.outcome === INSERTED;
  element("outcome").dataset.outcome = good ? "aligned" : "not";
  element("verdict").textContent = verdictWords(results);
  const times = results.separations;
  const lifted = times === 0 ? "It never lifts off." : `It lifts off ${times === 1 ? "once" : `${times} times`}.`;
  const ended = state.vibration || aligned ? outcomeWords(results) : `without vibration ${stillWords(results)}`;
  element("words").textContent = `${capital(ended)}. ${aligned ? lifted : ""}`;
  element("remedy").textContent = good || !state.vibration ? "" : `What to do: ${MODEL.remedies[`${results.outcome},${results.reason}`]}.`;
  const both = other && (state.vibration ? [results, other.results] : [other.results, results]);
  element("beside").textContent = both ? comparisonWords(both[0], both[1], state.vibration) + (state.compared ? " It is dashed." : "") : "";
}

function writeMoment() {
  if (!run) return;
  const frame = frameAt(run.track, time);
  const event = run.track.columns.event[rowAt(run.track, time)];
  const just = event > 0 ? `event: ${MODEL.events[event - 1]}` : "";
  element("moment").textContent = `${inTime(time)} · ${contactWords(/** @type {any} */ (frame))}${just ? ` · ${just}` : ""}`;
  const scrub = element("scrub");
  scrub.value = String(Math.round((1000 * time) / lastTime()));
  scrub.setAttribute("aria-valuetext", element("moment").textContent);
}
