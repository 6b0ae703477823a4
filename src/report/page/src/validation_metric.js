// A relative error metric for the validation of a model, after Dvurecenska, Graham, Patelli and
// Patterson (Royal Society Open Science 5:180687, 2018).
//
// Each measured number is compared with its prediction. Its error is divided by the largest
// measured displacement; its weight is its share of the sum of all errors. The metric is the sum of
// the weights of those errors that are below the expanded uncertainty of the measurement. The paper
// takes the coefficients of an orthogonal decomposition of a field as numbers; here they are the
// displacement components of tracked points in held-out frames, which need no decomposition.

export const COVERAGE = 2;  // factor from the standard to the expanded uncertainty, about 95 %
const REPLICATES = 300;
const SEED = 12345;

// What the metric and the share within the uncertainty would be for errors that are normally
// distributed with the standard uncertainty alone: 1 − exp(−k²/2), and erf(k/√2) for k = 2.
export const METRIC_OF_NOISE = 1 - Math.exp(-(COVERAGE ** 2) / 2);
export const SHARE_OF_NOISE = 0.9545;

function makeRandom(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 4294967296;
  };
}

// `frames` holds for each frame the list of errors, m; `largest` is the largest measured
// displacement, m; `sigma` the standard uncertainty of one number, m. Where numbers have uncertainties
// of their own, `sigmas` holds them like `frames`, and `sigma` is that of a typical number: the error of
// each number is then compared with its own expanded uncertainty. The thresholds of the curve are for a
// typical number, and scaled for the others.
export function validationMetric(frames, largest, sigma, sigmas = null) {
  const scale = (errors, f) => (sigmas ? errors.map((error, k) => (error * sigma) / sigmas[f][k]) : errors);
  const used = frames.map((errors, f) => ({ errors, scaled: scale(errors, f) })).filter(({ errors }) => errors.length > 0);
  const count = used.reduce((sum, { errors }) => sum + errors.length, 0);
  if (count === 0 || !(sigma > 0)) return null;
  const threshold = COVERAGE * sigma;
  const biggestOf = (which) => used.reduce((most, frame) => frame[which].reduce((a, b) => Math.max(a, b), most), 0);
  const grid = thresholds(threshold, biggestOf('scaled'));
  // Per frame: the sum of the errors, and the sum of those below each threshold.
  const sums = used.map(({ errors }) => errors.reduce((a, b) => a + b, 0));
  const below = used.map(({ errors, scaled }) => grid.map((limit) => errors.reduce((sum, error, k) => (scaled[k] < limit ? sum + error : sum), 0)));
  const within = used.map(({ scaled }) => scaled.filter((error) => error < threshold).length);
  const at = grid.indexOf(threshold);
  const curveOf = (chosen) => {
    let total = 0;
    const parts = new Float64Array(grid.length);
    for (const f of chosen) {
      total += sums[f];
      for (let k = 0; k < grid.length; ++k) parts[k] += below[f][k];
    }
    return Array.from(parts, (part) => (total > 0 ? part / total : 1));
  };
  const curve = curveOf(used.map((_, f) => f));
  const band = bootstrap(used.length, curveOf, grid.length);
  return {
    count, frames: used.length, threshold, largest, thresholdShare: largest > 0 ? threshold / largest : null,
    metric: curve[at], low: band.low[at], high: band.high[at], withinShare: within.reduce((a, b) => a + b, 0) / count,
    largestErrorShare: largest > 0 ? biggestOf('errors') / largest : null, grid, curve, curveLow: band.low, curveHigh: band.high,
  };
}

function thresholds(threshold, biggest) {
  const top = Math.max(1.2 * biggest, 2 * threshold);
  const list = Array.from({ length: 81 }, (_, k) => (top * k) / 80);
  list.push(threshold);
  return [...new Set(list)].sort((a, b) => a - b);
}

// A 95 % band from drawing blocks of neighbouring frames, because their errors are correlated.
function bootstrap(count, curveOf, size) {
  const random = makeRandom(SEED);
  const block = Math.max(1, Math.round(count ** (1 / 3)));
  const curves = [];
  for (let r = 0; r < REPLICATES; ++r) {
    const chosen = [];
    while (chosen.length < count) {
      const start = Math.floor(random() * count);
      for (let k = 0; k < block && chosen.length < count; ++k) chosen.push((start + k) % count);
    }
    curves.push(curveOf(chosen));
  }
  const quantile = (k, share) => {
    const sorted = curves.map((curve) => curve[k]).sort((a, b) => a - b);
    return sorted[Math.round(share * (sorted.length - 1))];
  };
  const all = Array.from({ length: size }, (_, k) => k);
  return { low: all.map((k) => quantile(k, 0.025)), high: all.map((k) => quantile(k, 0.975)) };
}
