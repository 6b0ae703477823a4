// Makes reports from formulas: a bar that swings after a release, and a model that damps it wrongly.
//
//   node fixture.mjs KIND FILE     writes one of the reports of `kinds` below
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const here = dirname(fileURLToPath(import.meta.url));
const templateFile = join(here, '../../../src/report/page/template.html');
const PLACEHOLDER = '<script type="application/json" id="report-data">{}</script>';

// A repeatable stream of numbers between 0 and 1 (a linear congruential generator).
function makeRandom(seed) {
  let state = BigInt(seed) + 88172645463325252n;
  return () => {
    state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    return Number(state >> 11n) / 2 ** 53;
  };
}
function makeNormal(seed) {
  const random = makeRandom(seed);
  return () => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());
}

const base64 = (array) => gzipSync(Buffer.from(array.buffer, array.byteOffset, array.byteLength), { level: 6 }).toString('base64');

export const packFloats = (shape, values) => ({ shape, type: 'float32', base64: base64(Float32Array.from(values)) });
export const packIndices = (shape, values) => ({ shape, type: 'uint32', base64: base64(Uint32Array.from(values)) });
// 16-bit numbers, as differences along the first axis.
export function packQuantised(shape, values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  const stride = shape.slice(1).reduce((a, b) => a * b, 1);
  const span = high - low || 1;
  const numbers = new Int16Array(values.length);
  for (let k = 0; k < values.length; ++k) numbers[k] = Number.isNaN(values[k]) ? -32768 : Math.round(((values[k] - low) / span) * 65534) - 32767;
  for (let k = values.length - 1; k >= stride; --k) numbers[k] -= numbers[k - stride];
  return { shape, type: 'int16', low, high: low + span, delta: true, base64: base64(numbers) };
}

// ---- The bar: 71 × 20 × 19 mm along x, clamped at x = 0 ----

const SIZE = [0.0714, 0.0199, 0.0187];

// The surface of the bar with about the wanted number of vertices.
function barSurface(wanted) {
  const spacing = Math.sqrt((2 * (SIZE[0] * SIZE[1] + SIZE[0] * SIZE[2] + SIZE[1] * SIZE[2])) / wanted);
  const counts = SIZE.map((length) => Math.max(2, Math.round(length / spacing)));
  const vertices = [], triangles = [], index = new Map();
  const vertex = (place) => {
    const key = place.join();
    if (!index.has(key)) {
      index.set(key, vertices.length);
      vertices.push(place.map((k, axis) => (k / counts[axis] - (axis === 0 ? 0 : 0.5)) * SIZE[axis]));
    }
    return index.get(key);
  };
  for (let axis = 0; axis < 3; ++axis) {
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    for (const side of [0, counts[axis]]) {
      for (let a = 0; a < counts[u]; ++a) {
        for (let b = 0; b < counts[v]; ++b) {
          const corner = (da, db) => {
            const place = [0, 0, 0];
            place[axis] = side;
            place[u] = a + da;
            place[v] = b + db;
            return vertex(place);
          };
          const [p, q, r, s] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
          if (side > 0) triangles.push([p, q, r], [p, r, s]);
          else triangles.push([p, r, q], [p, s, r]);
        }
      }
    }
  }
  return { vertices, triangles };
}

// The deflection of the tip at a time: held until 0.1037 s, then a damped swing.
function tip(time, decay, frequency) {
  const since = Math.max(0, time - 0.1037);
  const swing = Math.exp(-decay * since) * Math.cos(2 * Math.PI * frequency * since);
  return [0.009 * swing, 0.015 * swing - 0.0035];
}

function bend([x, y, z], time, { decay, frequency }) {
  const share = x / SIZE[0];
  const shape = (share * share * (3 - share)) / 2;
  const slope = (3 * share - 1.5 * share * share) / SIZE[0];
  const [ty, tz] = tip(time, decay, frequency);
  return [x - slope * (ty * y + tz * z), y + ty * shape, z + tz * shape];
}

const TRUTH = { decay: 6.5, frequency: 7.6 };
export const FIRST = { decay: 11, frequency: 8.25 };
export const SECOND = { decay: 6.55, frequency: 7.605 };
const NOISE = 0.0000992;

function frameTimes(count, last = 0.59) {
  // Not evenly spaced: every seventh frame is late.
  return Array.from({ length: count }, (_, k) => (last * k) / (count - 1 || 1) + (k % 7 === 3 ? 0.002 : 0));
}

const MARKERS = Array.from({ length: 8 }, (_, k) => [0.011 + 0.0086 * k, k % 2 ? 0.00995 : -0.00995, 0.0093]);
const MARKER_NAMES = MARKERS.map((_, k) => `m${k}`);

function makePoints(times, motion, seed) {
  const normal = makeNormal(seed);
  const measured = [], model = [], residual = [];
  times.forEach((time, f) => MARKERS.forEach((place, p) => {
    const truth = bend(place, time, TRUTH).map((value) => value + NOISE * normal());
    const isHidden = p === 2 && f % 9 === 4;
    const predicted = bend(place, time, motion);
    for (let c = 0; c < 3; ++c) {
      measured.push(isHidden ? NaN : truth[c]);
      model.push(predicted[c]);
      residual.push(isHidden ? NaN : predicted[c] - truth[c]);
    }
  }));
  return { measured, model, residual };
}

const rms = (values) => {
  const known = values.filter((value) => !Number.isNaN(value));
  return Math.sqrt(known.reduce((sum, value) => sum + value * value, 0) / (known.length || 1));
};

// A grip that pulls along x, goes back and turns about x; it rests along y.
function makeReactions(time_s, fitted) {
  const curve = (reading, quantity, unit, component, motion, stiffness) => ({
    reading, grip: 'jaw', quantity, unit, component, sigma: 0.01 * stiffness, time_s, fitted, motion,
    measured: time_s.map((t, k) => stiffness * (Math.sin(6 * t) + 0.05 * Math.cos(6 * t) + 0.02 * Math.sin(50 * k))), model: time_s.map((t) => 0.9 * stiffness * Math.sin(6 * t)) });
  const there_and_back = (size) => time_s.map((t) => size * Math.sin(6 * t));
  return [curve(0, 'force', 'N', 'x', there_and_back(0.01), 0.5), curve(0, 'force', 'N', 'y', null, 0.1), curve(1, 'torque', 'N m', 'x', there_and_back(0.2), 2e-3)];
}

function makeScene(recording, motion, { vertices = 400, frames = 60, seed = 1, withForce = true, packPoints = packFloats, isScan = false } = {}) {
  const times = frameTimes(frames), allTimes = frameTimes(60);
  const surface = barSurface(vertices);
  const V = surface.vertices.length, T = surface.triangles.length;
  const positions = new Float32Array(frames * V * 3), strain = new Float32Array(frames * V), force = new Float32Array(frames * T);
  times.forEach((time, f) => {
    const [ty, tz] = tip(time, motion.decay, motion.frequency);
    surface.vertices.forEach((place, v) => {
      positions.set(bend(place, time, motion), 3 * (f * V + v));
      const curvature = (3 - (3 * place[0]) / SIZE[0]) / SIZE[0] ** 2;
      strain[f * V + v] = Math.abs(curvature * (ty * place[1] + tz * place[2]));
    });
    surface.triangles.forEach(([a], t) => {
      force[f * T + t] = 900 * Math.sin(40 * time) * (surface.vertices[a][0] / SIZE[0] - 0.3);
    });
  });
  const range = (values) => {
    let low = Infinity, high = -Infinity;
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
    return { low, high };
  };
  const shown = makePoints(times, motion, seed), all = makePoints(allTimes, motion, seed);
  const P = MARKERS.length;
  const pointFrame = (list, f) => list.slice(3 * P * f, 3 * P * (f + 1));
  const lengths = allTimes.map((_, f) => Math.sqrt(3) * rms(pointFrame(all.residual, f)));
  const fitted = times.map((time) => time <= 0.451), allFitted = allTimes.map((time) => time <= 0.451);
  const swing = (phase, size) => allTimes.map((time) => size * Math.sin(40 * time + phase) * Math.exp(-4 * time));
  return {
    recording, times, fitted, up: [0, 0, 1],
    surface: {
      triangles: packIndices([T, 3], surface.triangles.flat()),
      positions: packQuantised([frames, V, 3], positions),
      fields: [
        { name: 'strain', label: 'largest principal strain', unit: '', on: 'nodes', diverging: false, ...range(strain), values: packQuantised([frames, V], strain) },
        { name: 'unexplained_force_x', label: 'unexplained force along x', unit: 'N/m^3', on: 'triangles', diverging: true, ...range(force), values: packQuantised([frames, T], force) },
      ],
    },
    points: { names: MARKER_NAMES, is_scan: isScan, sigma: NOISE, measured: packPoints([frames, P, 3], shown.measured),
              model: packPoints([frames, P, 3], shown.model), residual: packPoints([frames, P, 3], shown.residual) },
    series: { time_s: allTimes, fitted: allFitted, rms_m: lengths.map((value, f) => (f === 5 ? null : value)), sigma_m: NOISE },
    points_series: { time_s: allTimes, names: MARKER_NAMES, measured: packPoints([allTimes.length, P, 3], all.measured), model: packPoints([allTimes.length, P, 3], all.model) },
    force: withForce ? { time_s: allTimes, force_N: [swing(0, 0.01), swing(1, 0.024), swing(2, 0.05)], force_deviation_N: [2e-3, 3e-3, 4e-3].map((value) => allTimes.map((_, k) => (k === 2 ? null : value))),
      torque_N_m: [swing(0, 4e-4), swing(1, 9e-4), swing(2, 2e-4)], power_W: swing(0.5, 0.004) } : null,
    reactions: withForce ? makeReactions(allTimes, allFitted) : [],
    notes: vertices > 5000 ? ['The surface has fewer vertices than that of the model.'] : [],
    // For the records below.
    measures: { times: allTimes, fitted: allFitted, residual: all.residual, lengths },
  };
}

// ---- Records, with the keys that the program writes ----

function errorsOf(scenes) {
  const of = (wanted) => rms(scenes.flatMap((scene) => scene.measures.lengths.filter((_, f) => scene.measures.fitted[f] === wanted)));
  const held_out = of(false);
  return { in_fit: of(true), held_out, held_out_over_sigma: held_out / (Math.sqrt(3) * NOISE) };
}

const interval = (value, half) => ({ value, low_95: value - half, high_95: value + half });

function calibration(isSecond) {
  const parameter = (name, unit, value, half, verdict = 'pinned down', traded = '', correlation = 0) => ({
    name, unit, log_scale: unit === 'Pa', ...interval(value, half), deviation_from_data: half / 2, deviation: half / 2, verdict, most_correlated_with: traded, correlation });
  const parameters = isSecond ? [
    parameter('young_modulus', 'Pa', 6.55e4, 1.1e3), parameter('poisson_ratio', '', 0.41, 0.06, 'traded off', 'young_modulus', -0.96),
    parameter('stiffness_damping.beta', 's', 1.9e-4, 1.5e-4, 'flat'), parameter('viscoelastic_branch.modulus', 'Pa', 3.0e4, 4.8e3),
    parameter('viscoelastic_branch.relaxation_time', 's', 0.0418, 0.0021), parameter('recording 1.hold_force_x', 'N', -0.0012, 0.11, 'flat')]
    : [parameter('young_modulus', 'Pa', 8.47e4, 3.8e3), parameter('poisson_ratio', '', 0.26, 0.233, 'traded off', 'young_modulus', -0.99),
       parameter('stiffness_damping.beta', 's', 5.5e-3, 2.3e-4), parameter('recording 1.hold_force_x', 'N', -0.021, 0.14, 'at its bound')];
  if (!isSecond) parameters[3].high_95 = null;
  parameters[0].shares = { markers: 0.25, scans: 0, forces: 0.75 };
  return { schema_version: 2, experiment: '../../experiments/hidden_effect.yaml', usable: true, message: '', noise_m: NOISE, time_step_s: 0.005,
           step_error_over_sigma: 0.15, rms_before: 9.1, rms_after: isSecond ? 1.03 : 4.4, predictions: 31, parameters, recordings: [], prior_conflicts: [] };
}

function comparison(scenes, isSecond) {
  return {
    schema_version: 2, noise_m: NOISE, pairs: [], notes: ['The unexplained force of recording 2 was not computed.'], text: [],
    recordings: scenes.map((scene) => {
      const { times, fitted, residual, lengths } = scene.measures;
      const P = MARKERS.length;
      const parts = [true, false].map((wanted) => {
        const frames = times.map((_, f) => f).filter((f) => fitted[f] === wanted);
        const pointRms = MARKERS.map((_, p) => Math.sqrt(3) * rms(frames.flatMap((f) => residual.slice(3 * (P * f + p), 3 * (P * f + p) + 3))));
        let largest = { value: 0, point: -1, frame: frames[0] };
        for (const f of frames) for (let p = 0; p < P; ++p) {
          const value = Math.hypot(...residual.slice(3 * (P * f + p), 3 * (P * f + p) + 3));
          if (value > largest.value) largest = { value, point: p, frame: f };
        }
        const trend = (quantity, low, high, rank) => ({ quantity, rank_correlation: rank, bins: [0, 1, 2, 3].map((k) => ({
          low: low + ((high - low) * k) / 4, high: low + ((high - low) * (k + 1)) / 4, mean: low + ((high - low) * (k + 0.5)) / 4, count: 11, rms_m: isSecond ? 1.75e-4 + 1e-5 * ((7 * k) % 3) : (wanted ? 1 : 1.3) * (2e-4 + (rank > 0 ? 2e-4 * k : 1e-4 * (3 - k))) })) });
        return {
          part: wanted ? 'fitted' : 'held out', frames: frames.length, from_s: times[frames[0]], to_s: times[frames.at(-1)], point_rms_m: pointRms,
          worst_point: pointRms.indexOf(Math.max(...pointRms)), rms_m: rms(frames.map((f) => lengths[f])), rms_over_sigma: rms(frames.map((f) => lengths[f])) / NOISE / Math.sqrt(3),
          rms_over_floor: 5, steady_m: 1e-4, changing_m: 4e-4, points: frames.length * P, largest_m: largest.value, largest_point: largest.point, largest_time_s: times[largest.frame],
          mean_difference_m: [0, 3e-4, 7e-4], agreement: 0.6,
          time_correlation: { lags: 10, ljung_box_statistic: 300, lag_one_correlation: 0.89, correlation_time_s: 0.065, p_value: 0 },
          space_correlation: { mean_correlation: 0.6, correlation_length_m: 'longer than the data', p_value: 0, pairs: [] },
          worst_period: { first_frame: frames[3], last_frame: frames[9], frames: 7, from_s: times[frames[3]], to_s: times[frames[9]], rms_m: 9.7e-4, mean_difference_m: [0, 4e-4, 7e-4], agreement: 0.8 },
          trends: [trend('speed_m_per_s', 0, 0.155, 0.61), trend('strain', 0, 0.12, 0.3), trend('strain_rate_per_s', 0, 2, 0.4), trend('height_m', -0.02, 0.01, -0.1), trend('displacement_m', 0, 0.02, 0.5), trend('time_s', 0, 0.45, 0.2), trend('grip_distance_m', 0.01, 0.0716, 1)],
        };
      });
      return {
        name: scene.recording, kind: 'markers', noise_m: NOISE, point_names: MARKER_NAMES, grip_distance_m: MARKERS.map(([x]) => x),
        noise_floor: { floor_m: NOISE, white_noise_m: NOISE, rest_deviation_m: NOISE, rests: [] }, parts, height_along: 'against gravity', field_frames: 0,
        unexplained_force: { usable: true, is_significant: true, converged: true, predictions: 9, knots: 12, knot_spacing_s: 0.05, weight_N: 0.13, rms_N: [0.01, 0.024, 0.05], rms_deviation_N: [0.002, 0.003, 0.004],
          mean_N: [0.001, 0.003, 0.004], mean_deviation_N: [0.001, 0.001, 0.001], constant_share: 0.1, correlations: [{ quantity: 'displacement', correlation: 0.2 }, { quantity: 'velocity', correlation: -0.8 }, { quantity: 'acceleration', correlation: 0.1 }],
          duration_s: 0.59, work_J: -0.0009, work_deviation_J: 0.0001, mean_power_W: -0.0015, centroid_m: [0.05, 0, 0], grip_distance_m: 0.05, largest_grip_distance_m: 0.071,
          rms_over_sigma_without: 5, rms_over_sigma_with: 1.2, noise_scale: 1.2, log_evidence: 4000 },
      };
    }),
  };
}

const effect = (type, title, evidence, size, unit, more = {}) => ({
  effect: type, title, variant: more.variant ?? '', separating_experiment: more.experiment ?? '', look_alikes: more.lookAlikes ?? [], evidence, explained_share: 0.5,
  absorbed_share: more.absorbed ?? 0.9, expected_held_out_rms_over_sigma: more.expected ?? 4.3,
  sizes: [{ parameter: 'size', unit, expected: size, deviation: Math.abs(size) * 0.03, detectable: Math.abs(size) * 0.1, refitted: more.refit ? interval(size * 1.05, size * 0.04) : null }],
  refit: more.refit ? { message: '', evidence: more.refit.evidence, held_out_evidence: more.refit.evidence / 4, explained_share: 0.9, rms_over_sigma: 1.03, others: more.refit.others ?? [], in_fit_rms_m: 1.8e-4,
    held_out_rms_m: more.refit.heldOut, held_out_rms_over_sigma: more.refit.ratio, held_out_rms_over_sigma_without_nuisances: more.refit.ratio, unfitted_rms_over_sigma: more.refit.ratio } : null,
});

function decision(isSecond) {
  const probability = (kind, names, family, value, refuted = false) => ({ kind, names, family, evidence: value > 0 ? Math.log(value) + 100 : null, probability: value, is_refuted: refuted });
  const power = (truth, named, rest) => ({ truth, named, wrong_member: rest, wrong: 0, open: 1 - named - rest, unknown: 0, most_wrong: rest > 0 ? 'stiffness_damping' : '' });
  return {
    probabilities: isSecond ? [probability('nothing', [], 'other', 0.78), probability('nuisance', ['grip_compliance'], 'other', 0.21), probability('pair', ['drag', 'swelling'], 'other', 0.01), probability('effect', ['strain_stiffening'], 'elasticity', 0, true)]
      : [probability('effect', ['viscoelastic_branch'], 'loss_inside', 0.722), probability('effect', ['viscoelastic_branch', 'clock'], 'loss_inside', 0.24), probability('effect', ['elastoplastic_branch'], 'loss_inside', 0.031), probability('effect', ['attached_mass'], 'mass_distribution', 0.007), probability('effect', ['strain_stiffening'], 'elasticity', 0, true)],
    adequacy: { beside: isSecond ? [] : ['viscoelastic_branch'], p_unknown_force: 0.2, p_further: 0.1, p_variance: 0.002, p: 0.002, is_adequate: false, further: 'swelling', further_evidence: 1, rms_over_sigma: 1.03, left_share: 0.006, is_tolerated: true },
    power: [power([], 1, 0), power(['viscoelastic_branch'], 0.97, 0.02), power(['elastoplastic_branch'], 0.71, 0.2)],
    separations: [{ first: 'viscoelastic_branch', second: 'elastoplastic_branch', lambda: 380 }, { first: 'viscoelastic_branch', second: 'attached_mass', lambda: 4100 },
                  { first: 'elastoplastic_branch', second: 'attached_mass', lambda: 9.5 }, { first: 'pressure', second: 'swelling', lambda: 0.2 }, { first: 'pressure', second: 'attached_mass', lambda: null }],
    chance: -2.6,
  };
}

function agreement(isSecond) {
  return {
    recordings: ['recording 1', 'recording 2'], chi_square: isSecond ? 1.3 : 21.4, degrees_of_freedom: 2, p_value: isSecond ? 0.52 : 2.2e-5,
    parameters: [{ name: 'young_modulus', unit: 'Pa', values: [1.09e5, isSecond ? 1.095e5 : 1.21e5], deviations: [900, 1100], p_value: isSecond ? 0.6 : 6e-6, odd_recording: '' },
                 { name: 'poisson_ratio', unit: '', values: [0.42, 0.46], deviations: [0.01, null], p_value: 1, odd_recording: '' }],
  };
}

// A plan in which a shaken clamp decides between two losses.
function plan() {
  const rival = (effect, title, probability) => ({ effect, effects: [effect], title, probability, of_diagnosis: probability, named_now: 0.02 });
  const times = Array.from({ length: 61 }, (_, k) => 0.01 * k);
  const curve = (component, values) => ({ what: 'path of clamp', component, unit: 'm', values });
  const protocol = { times_s: times, release_s: 0.1037, curves: [curve('x', times.map(() => 0)), curve('z', times.map((t) => (t > 0.1037 ? 0.0025 * Math.sin(60 * (t - 0.1037)) ** 2 : 0))),
    { what: 'force that holds', component: 'y', unit: 'N', values: times.map((t) => (t < 0.1037 ? 0.05 : 0)) }] };
  const outcome = (name, what, drag, mass, lambda, seconds) => ({ name, what, seconds, message: '', named: { drag, mass_damping: mass }, probability: 0.52 * drag + 0.48 * mass, protocol, experiment: '',
    pairs: [{ first: 'drag', second: 'mass_damping', lambda_now: 0.1, lambda_then: lambda }], sizes: [{ effect: 'drag', parameter: 'coefficient', unit: 'kg/m', value: 0.4, half_width_now: 0.3, half_width_then: 0.06 }] });
  return {
    schema_version: 4, run: 'bar', verdict: 'ambiguous', rivals: [rival('drag', 'drag of the surrounding medium', 0.52), rival('mass_damping', 'mass-proportional damping', 0.48)],
    no_effect: 0, also_left: [], not_predicted: ['plane_contact'],
    outcomes: [outcome('shake along z', '"bar" with clamp shaken by 2.546 mm along z at 19.4 Hz', 1, 0.99, 25.9, 0.25), outcome('repeat', '"bar" once more', 0.02, 0, 0.12, 0.25),
      { name: 'turn about x', what: '', seconds: 0, message: 'at 0 s clamp would be 2 mm behind the plane of contact', named: {}, probability: 0, pairs: [], sizes: [], protocol: { times_s: [], release_s: null, curves: [] }, experiment: '' }],
  };
}

function diagnosis(isSecond, errors) {
  const ranking = isSecond ? [effect('strain_stiffening', 'Strain stiffening', 12, 2e3, 'Pa', { refit: { evidence: 14.5, heldOut: 2.02e-4, ratio: 1.2 }, expected: 1.2 })] : [
    effect('viscoelastic_branch', 'Viscoelastic branch (Maxwell element of a Prony series)', 8459.7, 2.85e4, 'Pa', { absorbed: 0.96, expected: 1.4, variant: 'τ = 0.08 s', experiment: 'Hold a constant strain: the force of a branch relaxes', refit: { evidence: 9357, heldOut: 2.37e-4, ratio: 1.2, others: [{ parameter: 'relaxation_time', unit: 's', ...interval(0.0428, 0.0017) }] } }),
    effect('elastoplastic_branch', 'Elastoplastic branch', 3468.8, 3.68e4, 'Pa', { absorbed: 0.94, expected: 4.5, variant: 'yield at a strain = 0.01' }),
    effect('attached_mass', 'Attached mass', 1196.3, 0.0308, 'kg', { absorbed: 0.998, refit: { evidence: 2596.8, heldOut: 1.64e-3, ratio: 4.7 }, variant: 'at 65 % of the length' }),
    effect('pressure', 'Pressure in a cavity', 183.2, 3420, 'Pa', { absorbed: 0.88, lookAlikes: ['swelling'], experiment: 'Turn the body: pressure rotates with it, gravity does not' }),
    effect('swelling', 'Swelling', 182.8, -0.0194, '', { absorbed: 0.88, lookAlikes: ['pressure'] }),
    effect('linear', 'Linear elasticity', -4.2, 0.1, '', { absorbed: 0.5 })];
  if (!isSecond) ranking[0].refit.removed_misfit = { markers: 18715.3, scans: 0, forces: -2.4 };
  return {
    schema_version: 10, verdict: isSecond ? 'adequate' : 'missing', effects: isSecond ? [] : ['viscoelastic_branch'], reasons: [], next_steps: [],
    noise_m: NOISE, scan_noise_m: 0, noise_correlation_time_s: 0.007, noise_variance_factor: 1, time_step_s: 0.005, decision: decision(isSecond),
    baseline_rms_over_sigma: 4, best_rms_over_sigma: 1.03, has_held_out: true, in_fit_rms_m: errors.in_fit, held_out_rms_m: errors.held_out,
    held_out_rms_over_sigma: isSecond ? 1.2 : 5.9, held_out_rms_over_sigma_without_nuisances: errors.held_out_over_sigma, unfitted_rms_over_sigma: errors.held_out_over_sigma,
    nuisances: [{ nuisance: 'mesh', what: 'elements that are too coarse', advice: 'refine the mesh', evidence: 10958.3, refitted_evidence: null, explained_share: 0.46, adopted: true, evidence_uncertainty: 3 },
                { nuisance: 'time_jitter', what: 'the times of single frames of recording 1', advice: 'check the clock', evidence: 3314.1, refitted_evidence: 120, explained_share: 0.37, adopted: false, evidence_uncertainty: 0 },
                { nuisance: 'clock', what: 'the clock of recording 1', advice: 'check the clock', evidence: -2, refitted_evidence: null, explained_share: 0, adopted: false, evidence_uncertainty: 0 }],
    agreement: agreement(isSecond), ranking, untried: [{ effect: 'plane_contact', why: 'there is no plane that the predicted body crosses and the measured one does not' }], alternatives: { effects: [], nuisances_evidence: 0, rms_over_sigma_without_both: 0 },
  };
}

function makeModel(name, motion, isSecond, options) {
  const scenes = (options.recordings ?? ['recording 1', 'recording 2']).map((recording, k) => makeScene(recording, { ...motion, frequency: motion.frequency + 0.05 * k }, { ...options, seed: k + 1 }));
  const errors = errorsOf(scenes);
  return { name, added: isSecond ? 'viscoelastic_branch' : '', label: isSecond ? 'with viscoelastic branch' : 'initial model', counts: true, errors,
           calibration: calibration(isSecond), comparison: comparison(scenes, isSecond), diagnosis: diagnosis(isSecond, errors), plan: isSecond ? null : plan(), scenes };
}

function withoutMeasures(data) {
  for (const run of data.runs) for (const model of run.models) for (const scene of model.scenes ?? []) delete scene.measures;
  return data;
}

const provenance = (modulus) => ({
  program: 'Lacuna 0.1.0 (38e33d1)', libraries: { Eigen: '3.4.0', Ceres: '2.1.0', TetGen: '1.6.0' }, seed: 1,
  configuration: { name: 'hidden_effect', mesh: { max_volume: '1000 mm^3', order: 2 }, material: { law: 'neo_hookean', young_modulus: modulus }, effects: [{ type: 'gravity', acceleration: [0, 0, -9.80665] }], fit: { parameters: [{ name: 'young_modulus' }] } },
  inputs: { 'experiments/hidden_effect.yaml': 'a3f5c0d1e2b4968778695a4b3c2d1e0f00112233445566778899aabbccddeeff', 'experiments/recordings/hidden_effect/recording_1/markers.csv': 'b7e1c0d1e2b4968778695a4b3c2d1e0f00112233445566778899aabbccddee00' },
  commands: ['lacuna fit experiments/hidden_effect.yaml', 'lacuna diagnose results/hidden_effect --until-done'],
});

function makeRun(name, options = {}) {
  const models = [makeModel(name, FIRST, false, options), makeModel(`${name}+viscoelastic_branch`, SECOND, true, options)];
  return { name, folder: `results/${name}`, kind: 'prediction', models, noise: Math.sqrt(3) * NOISE, reconstruction: null, table1: null, trials: null, provenance: provenance(options.modulus ?? '0.12 MPa'),
    ledger: { schema_version: 3, finished: true, ending: { reason: 'verdict' }, best: models[1].name, models: [] } };
}

const SENTENCES = [
  'The model misses the markers by 1.74 mm on held-out frames, 10 times the noise, most of it at the tip after 0.45 s.',
  'A viscoelastic branch is missing: a part of the stiffness that relaxes with time.',
  'With it the error is 0.20 mm, the noise.',
];

export function fullReport(options = {}) {
  return withoutMeasures({ schema: 1, program: 'Lacuna 0.1.0', title: 'hidden_effect', sentences: SENTENCES, runs: [makeRun('hidden_effect', options)] });
}

// A third model, whose effect has a size that may be zero.
export function inVainReport() {
  const data = fullReport();
  const [run] = data.runs;
  const third = structuredClone(run.models[1]);
  Object.assign(third, { name: `${third.name}+strain_stiffening`, added: 'strain_stiffening', label: 'and with strain stiffening', counts: false, diagnosis: null, comparison: null });
  Object.assign(run.models[1].diagnosis, { verdict: 'missing', effects: ['strain_stiffening'] });
  run.models.push(third);
  run.ledger.ending.reason = 'may_be_zero';
  return data;
}

export function twoRuns() {
  return withoutMeasures({
    schema: 1, program: 'Lacuna 0.1.0', title: 'hidden_effect and stiff', sentences: ['Two runs that differ in the modulus with which the fit starts.'],
    runs: [makeRun('hidden_effect'), makeRun('stiff', { modulus: '0.2 MPa' })],
    differences: [{ key: 'material.young_modulus', values: ['0.12 MPa', '0.2 MPa'] }],
  });
}

export function minimalReport() {
  return { schema: 1, program: 'Lacuna 0.1.0', title: 'minimal', sentences: ['A fit without recordings.'],
           runs: [{ name: 'minimal', models: [{ name: 'minimal', added: '', label: '', errors: { in_fit: null, held_out: null, held_out_over_sigma: null }, scenes: [] }] }] };
}

export const HOSTILE = `<script>alert(1)</script>"'\`</script><img src=x onerror=alert(2)>\u2028\u2029&amp;${'long '.repeat(2000)}`;

// The full report with a hostile text in every place that takes a name.
export function hostileReport() {
  const data = fullReport();
  data.title = data.program = HOSTILE;
  data.sentences = [HOSTILE];
  const run = data.runs[0];
  run.name = HOSTILE;
  run.provenance.configuration[HOSTILE] = HOSTILE;
  run.provenance.inputs[HOSTILE] = HOSTILE;
  run.provenance.commands = [HOSTILE];
  for (const model of run.models) {
    model.name = model.label = model.added = HOSTILE;
    model.calibration.parameters[0].name = model.calibration.parameters[0].unit = HOSTILE;
    model.diagnosis.ranking[0].effect = model.diagnosis.ranking[0].title = model.diagnosis.ranking[0].variant = HOSTILE;
    model.diagnosis.effects = [HOSTILE];
    model.diagnosis.decision.probabilities[0].names = [HOSTILE];
    model.diagnosis.decision.separations[0].first = HOSTILE;
    model.diagnosis.nuisances[0].what = HOSTILE;
    model.diagnosis.agreement.recordings[0] = model.diagnosis.agreement.parameters[0].name = HOSTILE;
    if (model.plan) model.plan.outcomes[0].what = model.plan.rivals[0].title = model.plan.outcomes[0].protocol.curves[0].what = HOSTILE;
    model.comparison.notes = [HOSTILE];
    model.comparison.recordings[0].name = HOSTILE;
    model.comparison.recordings[0].point_names[0] = HOSTILE;
    model.scenes[0].recording = HOSTILE;
    model.scenes[0].points.names = model.scenes[0].points.names.map(() => HOSTILE);
    model.scenes[0].points_series.names = model.scenes[0].points_series.names.map(() => HOSTILE);
    model.scenes[0].surface.fields[0].label = model.scenes[0].surface.fields[0].unit = HOSTILE;
  }
  return data;
}

export function largeReport(vertices, frames) {
  const data = fullReport({ vertices, frames, recordings: ['recording 1'] });
  data.runs[0].models.pop();
  return data;
}

// A motion as a reconstruction keeps it: a surface, and scans whose points have no names and no counterparts.
function scannedScene() {
  const scene = makeScene('bend', FIRST, { withForce: false });
  return { ...scene, fitted: scene.times.map(() => true), series: null, points_series: null, reactions: [],
           points: { names: [], is_scan: true, measured: scene.points.measured, model: null, residual: null, sigma: null } };
}

// Every second marker has four times the noise of the others, and one of them becomes worse in later frames.
export const SIGMAS = (point, frame) => (point % 2 ? 4 : 1) * (point === 5 && frame >= 30 ? 2 : 1) * NOISE;
export function ownNoiseReport() {
  const data = fullReport();
  data.runs[0].noise = null;
  for (const model of data.runs[0].models) {
    for (const { times, points, series, points_series } of model.scenes) {
      const sigmas = (count) => packFloats([count, MARKERS.length], Array.from({ length: count }, (_, f) => MARKERS.map((_, p) => SIGMAS(p, f))).flat());
      points.sigmas = sigmas(times.length);
      points_series.sigmas = sigmas(series.time_s.length);
      series.noise_m = series.time_s.map((_, f) => (f === 5 ? null : Math.sqrt(3) * rms(MARKERS.map((_, p) => SIGMAS(p, f)))));
    }
  }
  return data;
}

// Scans instead of markers, with positions as 16-bit numbers, and nothing held out.
export function scansReport() {
  const data = fullReport({ packPoints: packQuantised, isScan: true });
  const run = data.runs[0];
  run.noise = null;
  run.ledger = null;
  run.models.pop();
  const [model] = run.models;
  model.diagnosis = null;
  model.errors.has_held_out = false;
  for (const scene of model.scenes) {
    scene.surface = null;
    scene.force = null;
    scene.reactions = [];
  }
  return data;
}

export function studyReport() {
  const times = Array.from({ length: 20 }, (_, k) => 0.05 * k);
  const range = (median, half) => ({ median, least: median - half, largest: median + half });
  const row = (name, drop, paper, best) => ({ name, seeds: 10, drop_from_max: range(drop, 0.06), drop_from_start: range(drop - 0.05, 0.06), sum_drop_from_max: range(drop + 0.02, 0.06), best_per_point_m: range(best, 5e-5), below_truth: range(0.02, 0.03), young_modulus_Pa: range(1.1e5, 2e4), poisson_ratio: range(0.4, 0.05), paper_drop: paper });
  return {
    schema: 1, program: 'Lacuna 0.1.0', title: 'bend', sentences: ['The model follows the scan to 0.31 mm.'],
    runs: [{
      name: 'bend', kind: 'reconstruction', models: [{ name: 'bend', added: '', label: '', errors: null, scenes: [scannedScene()] }], noise: null, notes: ['The trace of the search was not kept.'],
      reconstruction: {
        record: { recording: 'bend', object_size_m: 0.0714, animation_residual_m: 0.31, relative_animation_residual: 0.004, mesh: { node_count: 812, tet_count: 402, order: 2, volume_m3: 2.7e-5, smallest_angle_rad: 0.3, largest_radius_edge_ratio: 1.4 }, stages: { registration: { usable: true, status: 'converged', message: '', iterations: 40 } }, measures: { force_rms_N: 0.2 }, warnings: ['Frame 3 did not converge.'] },
        frames: { frame: times.map((_, k) => k), time_s: times, residual_mean_m: times.map((t) => 3e-4 + 1e-4 * Math.sin(8 * t)), surface_distance_mean_m: times.map((t) => 2e-4 + 5e-5 * t), surface_distance_max_m: times.map((t) => 9e-4 + 5e-5 * t), force_x_N: times.map((t) => 0.1 * t), force_y_N: times.map(() => 0), force_z_N: times.map((t) => 0.3 * t) },
        trace: { evaluation: times.map((_, k) => k + 1), residual_per_point_m: times.map((_, k) => 4e-4 * (1 + 2 / (k + 1) + 0.4 * Math.sin(9 * k))), residual_sum_m: times.map((_, k) => 0.4 + 1 / (k + 1)), young_modulus_Pa: times.map((_, k) => 1e5 + 1e3 * k) },
      },
      table1: { truth: { young_modulus_Pa: 1.2e5, poisson_ratio: 0.42 }, rows: [row('geometry', 0.31, 0.4, 3.4e-4), row('material', 0.52, 0.61, 2.7e-4), row('geometry and material', 0.6, 0.75, 2.4e-4)], mesh_noise: { per_point: 0.012, sum: 0.03 }, last_is_best: { seeds: 8, of: 10 }, searches: [] },
      ablation: { truth: { young_modulus_Pa: 1.2e5, poisson_ratio: 0.42 }, mesh_noise: 0.012, rows: ['cobyla', 'random', 'coarse mesh'].map((name, k) => ({ name, varies: k === 0 ? '' : 'the method', question: 'Does the method matter?', against: k ? 'cobyla' : '', seeds: 10, method_message: '', shows: 'No difference beyond the mesh noise.', best_per_point_m: range(2.5e-4 + 1e-5 * k, 2e-5), drop: range(0.5 - 0.03 * k, 0.05), young_modulus_over_truth: range(0.95, 0.1), poisson_ratio_less_truth: range(-0.02, 0.03), evaluations: range(60, 4), seconds: range(120, 20) })) },
      trials: {
        tallies: [{ group: 'control, 1 rec', cases: 20, top1: 0, top2: 0, wrong: 0, ranked_first: 0, verdicts: { adequate: 20 }, fitted: 0, at_noise: 0, within_15_percent: 0, intervals: 0, covered: 0, median_error_before: 1.03, median_error_after: 0 },
                  { group: 'one_effect, 1 rec, 2 x', cases: 16, top1: 8, top2: 14, wrong: 0, ranked_first: 14, verdicts: { ambiguous: 6, missing: 8, 'not in library': 2 }, fitted: 16, at_noise: 14, within_15_percent: 5, intervals: 22, covered: 17, median_error_before: 1.45, median_error_after: 1.05 },
                  { group: 'pair, 2 rec', cases: 14, pairs: 14, top1: 5, in_part: 4, top2: 12, wrong: 3, ranked_first: 11, verdicts: { missing: 12, 'not in library': 2 }, fitted: 14, at_noise: 7, within_15_percent: 6, intervals: 28, covered: 20, median_error_before: 1.42, median_error_after: 1.3 }],
        confusion: { nothing: { adequate: 45, ambiguous: 1, nuisance: 10 }, drag: { drag: 3, ambiguous: 1 }, gravity: { gravity: 3, point_force: 1 } }, unfinished: ['0057'],
        rates: [{ truth: 'nothing is missing', what: 'an effect is named', cases: 0, of: 20, predicted: null }, { truth: 'one effect is missing', what: 'it is named, and no other', cases: 8, of: 16, predicted: 0.62 }, { truth: 'one effect is missing', what: 'one of another family is named', cases: 0, of: 0, predicted: null }],
        follow_ups: { open: 3, waiting: 0, unpaired: 1, recordings: [{ choice: 'best of the plan', cases: 2, predicted: 0.9, predicted_cases: 2, named: 2, wrong: 0 }, { choice: 'another one at random', cases: 2, predicted: 0.4, predicted_cases: 2, named: 1, wrong: 0 }] },
        calibration: [{ low: 0.4, high: 0.6, stated: 0.55, frequency: 0.5, statements: 8 }, { low: 0.6, high: 0.8, stated: 0.75, frequency: 0.8, statements: 10 }, { low: 0.8, high: 1, stated: 0.97, frequency: 0.94, statements: 60 }],
      },
      intervals: { missing: ['mass_damping'], failed: 1, parameters: [{ name: 'young_modulus', draws: 4, covered_50: 0.5, covered_80: 0.75, covered_95: 1, mean: -0.2, spread: 1.04, p_uniform: 0.28, positions: [0.1, 0.4, 0.6, 0.9] }] },
      provenance: provenance('0.1 MPa'),
    }],
  };
}

// A study without models, as the program writes it for Table 1.
export function table1Report() {
  const data = withoutMeasures(studyReport());
  Object.assign(data.runs[0], { kind: 'table1', models: [], reconstruction: null, trials: null, provenance: { program: 'Lacuna 0.1.0', commands: [] } });
  data.runs[0].table1.traces = { geometry: { evaluation: [1, 2, 3], residual_per_point_m: [4e-4, 3e-4, 3.5e-4], nodes: [800, 820, 810] } };
  return data;
}

export const kinds = {
  full: fullReport, 'in-vain': inVainReport, 'own-noise': ownNoiseReport, scans: scansReport, 'two-runs': twoRuns, minimal: minimalReport, hostile: hostileReport, study: () => withoutMeasures(studyReport()),
  table1: table1Report, '10k': () => largeReport(10000, 30), '100k': () => largeReport(100000, 100),
};

// The page with the data in it, as the program writes it.
export function writeReport(data, file) {
  const template = readFileSync(templateFile, 'utf8');
  const json = JSON.stringify(data).replaceAll('<', '\\u003c');
  writeFileSync(file, template.split(PLACEHOLDER).join(`<script type="application/json" id="report-data">${json}</script>`));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) writeReport(kinds[process.argv[2]](), process.argv[3]);
