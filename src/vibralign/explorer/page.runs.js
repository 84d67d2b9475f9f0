// Runs: short ones at once, long ones in a Worker, so that the page stays usable.

/** @typedef {{track: Track, results: Record<string, number>}} Run */

// Evaluations of a run on the page: a longer run is made in a Worker. Rows of a track at first, and at most: a longer one is cut.
const QUICK = 200000, FIRST_ROWS = 8192, MOST_ROWS = 120000;

/** Return a run from the numbers of an engine. @param {Found} found @param {Interface} about @returns {Run} */
function runOf(found, about) {
  const results = Object.fromEntries(about.results.map((name, n) => [name, found.results[n]]));
  return { track: trackOf(found.track, about.columns, Math.min(results.tracked, found.track.length / about.columns.length)), results };
}

/** Runs sets, dimensionless, on the page or in a Worker of its own. */
class Runner {
  /** @param {Engine} engine @param {ArrayBuffer} binary @param {any} model */
  constructor(engine, binary, model) {
    this.engine = engine;
    this.binary = binary;
    this.about = /** @type {Interface} */ (model.interface);
    this.control = /** @type {Record<string, number>} */ (model.control);
    this.code = URL.createObjectURL(new Blob([model.worker], { type: "text/javascript" }));
    this.long = /** @type {Record<string, Worker>} */ ({});
  }

  /** Return the run of a set, or null if it takes more than a few evaluations. @param {number[]} set @param {Record<string, number>} control @returns {Run | null} */
  quick(set, control) {
    const most = Math.min(QUICK, control.max_evaluations), few = { ...control, max_evaluations: most };
    let found = this.engine([set], few, FIRST_ROWS);
    const { tracked, rhs_evaluations: made } = runOf(found, this.about).results;
    if (made >= most && most < control.max_evaluations) return null;
    if (tracked > FIRST_ROWS) found = this.engine([set], few, Math.min(tracked, MOST_ROWS));
    return runOf(found, this.about);
  }

  /** Run a set; a later one of the same name replaces it. @param {string} name @param {number[]} set @param {Record<string, number>} control @param {(run: Run) => void} done @returns {boolean} it is done */
  start(name, set, control, done) {
    this.stop(name);
    const found = this.quick(set, control);
    if (found) { done(found); return true; }
    const worker = new Worker(this.code);
    this.long[name] = worker;
    worker.onmessage = ({ data }) => {
      if (data.ready) return;
      this.stop(name);
      done(runOf(data, this.about));
    };
    worker.postMessage({ binary: this.binary, about: this.about });
    worker.postMessage({ chunk: { sets: [set], control, rows: MOST_ROWS } });
    return false;
  }

  /** End a run that is under way. @param {string} name */
  stop(name) {
    this.long[name]?.terminate();
    delete this.long[name];
  }

  /** Return the tilt at which a part rests under a slow press; NaN without rest. @param {number[]} set */
  slowTilt(set) {
    const found = runOf(this.engine([set], { ...this.control, start: PRESSED, horizon: 1e-9 }, 4), this.about);
    return found.results.outcome === LEFT_SCENE ? NaN : found.track.columns.tilt[0];
  }
}
