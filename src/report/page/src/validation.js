// The probability that each model's prediction represents the measurement, on held-out frames.
import { chart } from './chart.js';
import { unpack } from './decode.js';
import { h } from './dom.js';
import { isNumber, millimetres, number, percent } from './format.js';
import { following, name, section, table } from './section.js';
import { COVERAGE, METRIC_OF_NOISE, SHARE_OF_NOISE, validationMetric } from './validation_metric.js';

const LARGEST_ROUNDING = 0.3;  // of the stored positions, in σ

// The errors of all numbers in each held-out frame. For points they are displacement components; for
// scans the distances of the patches, which lie along the normal. `sigmas` is null where all numbers have
// the same σ.
async function heldOutErrors(scene) {
  const source = scene.points_series ?? (scene.points ? { ...scene.points, time_s: scene.times } : null);
  const fitted = scene.points_series ? scene.series?.fitted : scene.fitted;
  const sigma = scene.points?.sigma ?? scene.series?.sigma_m;
  if (!source?.measured || !source.model || !fitted?.includes(false) || !(sigma > 0)) return null;
  const [measured, model, own] = await Promise.all([unpack(source.measured), unpack(source.model), unpack(source.sigmas)]);
  const isScan = Boolean(scene.points?.is_scan);
  const first = measured.frame(0);
  const frames = [], sigmas = [];
  let largest = 0, smallestSigma = Infinity;
  for (let f = 0; f < Math.min(fitted.length, measured.frames, model.frames); ++f) {
    if (fitted[f] !== false) continue;
    const [seen, predicted] = [measured.frame(f), model.frame(f)];
    const deviations = own?.frame(f);
    const errors = [], ofErrors = [];
    for (let k = 0; k < seen.length; ++k) {
      largest = Math.max(largest, Math.abs(seen[k] - first[k]) || 0);
      if (isScan && k % 3 > 0) continue;
      const error = isScan ? Math.hypot(predicted[k] - seen[k], predicted[k + 1] - seen[k + 1], predicted[k + 2] - seen[k + 2]) : Math.abs(predicted[k] - seen[k]);
      const deviation = deviations ? deviations[Math.floor(k / 3)] : sigma;
      if (Number.isNaN(error / deviation)) continue;
      errors.push(error);
      ofErrors.push(deviation);
      smallestSigma = Math.min(smallestSigma, deviation);
    }
    frames.push(errors);
    sigmas.push(ofErrors);
  }
  const rounding = Math.max(measured.step, model.step);
  return { frames, largest, sigma, sigmas: own ? sigmas : null, smallestSigma, rounding, isCoarse: rounding > LARGEST_ROUNDING * smallestSigma };
}

async function assess(choices, recording) {
  const results = [];
  for (const choice of choices) {
    const scenes = (choice.model.scenes ?? []).filter((scene) => scene.recording === recording);
    for (const scene of scenes) {
      const data = await heldOutErrors(scene);
      if (data?.isCoarse) results.push({ choice, data });
      const result = data && !data.isCoarse ? validationMetric(data.frames, data.largest, data.sigma, data.sigmas) : null;
      if (result) results.push({ choice, data, result });
    }
  }
  return results;
}

const hasOwnSigmas = ({ data }) => data.sigmas !== null;

function figure(results) {
  const { threshold } = results[0].result;
  // Errors in mm, or, where numbers have uncertainties of their own, in units of these.
  const isOwn = results.some(hasOwnSigmas);
  const factor = (data) => (isOwn ? 1 / data.sigma : 1e3);
  const uncertainty = isOwn ? `${COVERAGE} σ` : millimetres(threshold);
  return chart({
    title: 'Weighted errors, cumulative', height: 300, x: isOwn ? 'error of a number over its own σ' : 'error of a number, mm', y: 'share of the sum of all errors, %', yRange: [0, 100], lines: [{ x: isOwn ? COVERAGE : 1e3 * threshold }],
    explain: `The share of the summed error that comes from errors smaller than the value on the horizontal axis. The dashed line is the expanded uncertainty of the measurement, ${uncertainty}: the metric is the height of a curve there. The tint is a 95 % band.`,
    series: results.map(({ choice, data, result }) => ({ label: choice.label, x: result.grid.map((value) => factor(data) * value), y: result.curve.map((value) => 100 * value), colour: choice.colour })),
    areas: results.map(({ choice, data, result }) => ({ x: result.grid.map((value) => factor(data) * value), low: result.curveLow.map((value) => 100 * value), high: result.curveHigh.map((value) => 100 * value), colour: choice.colour })),
  });
}

function summary(results) {
  return table(null, [['model'], ['metric: probability', true], ['95 % band', true], ['within the uncertainty', true, 'share of the numbers, each counted once'], ['uncertainty, relative', true, `expanded uncertainty${results.some(hasOwnSigmas) ? ' of a typical point' : ''} over the largest displacement`], ['largest error, relative', true], ['numbers', true], ['frames', true]],
    results.map(({ choice, result }) => [name(choice.label), h('strong', {}, percent(result.metric)), `${percent(result.low)} … ${percent(result.high)}`, percent(result.withinShare),
      isNumber(result.thresholdShare) ? `${number(100 * result.thresholdShare, 2)} %` : '–', isNumber(result.largestErrorShare) ? `${number(100 * result.largestErrorShare, 2)} %` : '–', String(result.count), String(result.frames)]));
}

// The metric of the best model in words, as the paper puts it.
function statement(results) {
  const best = results.reduce((a, b) => (b.result.metric > a.result.metric ? b : a));
  const { metric, low, high, thresholdShare } = best.result;
  const band = percent(low) === percent(high) ? '' : ` (${percent(low)} to ${percent(high)})`;
  return h('p', {}, h('strong', {}, `${percent(metric)}${band}`),
    ` is the probability that the prediction of the ${/model$/.test(best.choice.label) ? '' : 'model '}${best.choice.label.slice(0, 120)} represents the measurement, for these conditions and a measurement uncertainty of ${number(100 * thresholdShare, 2)} % of the largest displacement${hasOwnSigmas(best) ? ' for a typical point' : ''}. A perfect model would reach ${percent(METRIC_OF_NOISE)}.`);
}

function method() {
  return h('details', { class: 'method' }, h('summary', {}, 'How it is computed, and what it means'),
    h('ol', {},
      h('li', {}, 'Every displacement component of every point in every held-out frame is one number, measured M and predicted P (for scans: the distance of each patch along its normal).'),
      h('li', {}, 'Its relative error is e = |P − M| / max |M|, where max |M| is the largest measured displacement. Its weight is w = e / Σ e, its share of the sum of all errors.'),
      h('li', {}, `The expanded uncertainty of the measurement is U = ${COVERAGE} σ (95 % coverage). Relative to max |M| it is the threshold. Where points have noise of their own, σ and the threshold are those of the number’s point.`),
      h('li', {}, 'The metric is the sum of the weights of all errors below the threshold. A few large errors weigh more than many small ones.'),
      h('li', {}, 'The 95 % band comes from repeating the computation with blocks of neighbouring frames drawn at random.')),
    h('p', {}, `The metric is read as the probability that the prediction represents the measurement, for these conditions and this uncertainty. Errors that are normally distributed noise alone give ${percent(METRIC_OF_NOISE)}, not 100 %, and ${number(100 * SHARE_OF_NOISE, 2)} % of the numbers within the uncertainty; a model that reaches these is as good as the measurement can show.`),
    h('p', {}, 'After K. Dvurecenska, S. Graham, E. Patelli and E. A. Patterson, A probabilistic metric for the validation of computational models, Royal Society Open Science 5:180687, 2018: the normalised relative error, the weights, the threshold from the uncertainty and their sum. As in CWA 16799:2014, a prediction is acceptable where it differs from the measurement by no more than the expanded uncertainty. Both compare coefficients of an orthogonal decomposition of a field; tracked points are few enough to be compared directly. The band is an addition.'));
}

export async function validationSection({ choices, store, recordings }) {
  const able = [];
  for (const recording of recordings) {
    for (const choice of choices) {
      if ((await assess([choice], recording)).length === 0) continue;
      able.push(recording);
      break;
    }
  }
  if (able.length === 0) return null;
  return section('validation', 'Validation', 'Does the prediction represent the measurement?',
    'A validation metric on frames that were not fitted, against the uncertainty of the measurement.',
    following(store, ['recording'], async (state) => {
      const results = await assess(choices, state.recording);
      const judged = results.filter(({ result }) => result);
      if (judged.length > 0) return [statement(judged), summary(judged), figure(judged)];
      if (results.length > 0) return h('p', { class: 'explain' }, `The positions in this file are rounded to ${millimetres(results[0].data.rounding)}, too coarse for a noise of ${millimetres(results[0].data.smallestSigma)}: no metric is computed.`);
      return h('p', { class: 'explain' }, `${String(state.recording).slice(0, 80)} has no held-out frames.`);
    }), method());
}
