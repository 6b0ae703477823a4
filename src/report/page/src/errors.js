// Where and when the models err: over time, at one point, and against other quantities.
import { chart, sharedLegend } from './chart.js';
import { unpack } from './decode.js';
import { h, labelledSelect } from './dom.js';
import { fixed, isNumber, millimetres, sigmas } from './format.js';
import { hasReactions, reactionPlots } from './reactions.js';
import { following, grid, name, section, table } from './section.js';
import { rmsOfNoise } from './scene_data.js';
import { sceneOf } from './motion.js';
import { heldOutSpans } from './timeline.js';
import { QUANTITIES } from './text.js';

const inMillimetres = (values) => Array.from(values ?? [], (value) => (isNumber(value) ? 1e3 * value : NaN));
const isScan = (scene) => Boolean(scene?.points?.is_scan);

function scenesOf(choices, recording) {
  return choices.map((choice) => ({ choice, scene: sceneOf(choice, recording) })).filter(({ scene }) => scene);
}

// What noise alone would give, below the errors of a chart: up to one value, or in each frame where points have
// noise of their own.
function noiseBand(scene) {
  const own = scene.series.noise_m;
  if (own) {
    // One area for each run of frames in which points were seen; a single frame has a level instead.
    const runs = [];
    own.forEach((value, f) => {
      if (!isNumber(value)) return;
      if (f === 0 || !isNumber(own[f - 1])) runs.push([]);
      runs.at(-1).push(f);
    });
    const explain = ` The grey band is what noise alone would give, where each ${isScan(scene) ? 'patch' : 'marker'} has a σ of its own.`;
    if (runs.length === 1 && runs[0].length === 1) {
      const level = 1e3 * own[runs[0][0]];
      return { bands: [{ from: 0, to: level }], lines: [{ y: level }], explain };
    }
    const areas = runs.map((run) => ({ x: run.map((f) => scene.series.time_s[f]), low: run.map(() => 0), high: run.map((f) => 1e3 * own[f]), colour: 'noise' }));
    return { areas, explain };
  }
  const noise = rmsOfNoise(scene.series.sigma_m ?? scene.points?.sigma, isScan(scene));
  return noise ? { bands: [{ from: 0, to: 1e3 * noise }], lines: [{ y: 1e3 * noise }], explain: ` The grey band is what noise alone would give, up to ${millimetres(noise)}.` } : {};
}

export function errorOverTime({ choices, store }, state) {
  const all = scenesOf(choices, state.recording).filter(({ scene }) => scene.series?.rms_m?.length > 0);
  if (all.length === 0) return null;
  const { scene } = all[0];
  const { explain = '', ...noise } = noiseBand(scene);
  const spans = heldOutSpans(scene.series.time_s, scene.series.fitted);
  return chart({
    title: `Error over time, ${state.recording.slice(0, 80)}`, store, height: 260,
    explain: `The rms residual of each frame.${spans.length > 0 ? ' Shaded frames were held out.' : ''}${explain} Click to go to a time.`,
    x: 'time, s', y: 'rms residual, mm', spans, ...noise,
    series: all.map(({ choice, scene: one }) => ({ label: choice.label, x: one.series.time_s, y: inMillimetres(one.series.rms_m), colour: choice.colour })),
  });
}

// The motion of one point: where it was measured, and where each model has it.
async function pointPlots({ choices, store }, state) {
  const all = scenesOf(choices, state.recording);
  const tracks = [];
  for (const { choice, scene } of all) {
    const source = scene.points_series ?? (scene.points ? { ...scene.points, time_s: scene.times } : null);
    if (!source?.model) continue;
    const [measured, model] = await Promise.all([unpack(source.measured), unpack(source.model)]);
    tracks.push({ choice, scene, times: source.time_s, names: source.names ?? [], measured, model, fitted: scene.points_series ? scene.series?.fitted : scene.fitted });
  }
  if (tracks.length === 0) return null;
  const count = (tracks[0].measured ?? tracks[0].model).shape[1];
  const point = Math.min(state.point ?? worstPoint(tracks[0], count), count - 1);
  const values = (track, array, axis) => Array.from({ length: array.frames }, (_, f) => 1e3 * array.frame(f)[3 * point + axis]);
  const label = String(tracks[0].names[point] ?? point).slice(0, 60);
  const options = Array.from({ length: Math.min(count, 2000) }, (_, k) => [String(k), String(tracks[0].names[k] ?? k).slice(0, 60)]);
  const chooser = labelledSelect(isScan(tracks[0].scene) ? 'Patch' : 'Marker', options, String(point), (value) => store.set({ point: Number(value) }));
  const spans = heldOutSpans(tracks[0].times, tracks[0].fitted);
  const charts = [0, 1, 2].map((axis) => chart({
    title: 'xyz'[axis], store, legend: false, height: 200, x: 'time, s', y: `${'xyz'[axis]}, mm`, spans, includesZero: false, axisSize: 58,
    series: [
      tracks[0].measured ? { label: 'measured', x: tracks[0].times, y: values(tracks[0], tracks[0].measured, axis), colour: 'measured', style: 'dots', size: 4 } : null,
      ...tracks.map((track) => (track.model ? { label: track.choice.label, x: track.times, y: values(track, track.model, axis), colour: track.choice.colour } : null)),
    ].filter(Boolean),
  }));
  return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, `Position of ${label}`), chooser.root,
    h('p', { class: 'explain' }, 'Dots are measured, lines are predicted. Choose a point here or by a click in the 3D view.')),
  sharedLegend([...(tracks[0].measured ? [{ label: 'measured', colour: 'measured', style: 'dots' }] : []), ...tracks.filter((track) => track.model).map((track) => ({ label: track.choice.label, colour: track.choice.colour }))]),
  h('div', { class: 'grid thirds' }, charts));
}

function worstPoint(track, count) {
  if (!track.measured || !track.model) return 0;
  let best = 0, largest = -1;
  const sums = new Float64Array(count);
  for (let f = 0; f < track.measured.frames; ++f) {
    const [a, b] = [track.measured.frame(f), track.model.frame(f)];
    for (let k = 0; k < count; ++k) {
      const square = (a[3 * k] - b[3 * k]) ** 2 + (a[3 * k + 1] - b[3 * k + 1]) ** 2 + (a[3 * k + 2] - b[3 * k + 2]) ** 2;
      if (!Number.isNaN(square)) sums[k] += square;
    }
  }
  sums.forEach((sum, k) => { if (sum > largest) [best, largest] = [k, sum]; });
  return best;
}

const comparedRecording = (choice, recording) => choice.model.comparison?.recordings?.find((one) => one.name === recording);

// The error of frames, or points, sorted into bins of another quantity.
function trends({ choices }, state) {
  const compared = choices.map((choice) => ({ choice, recording: comparedRecording(choice, state.recording) })).filter(({ recording }) => recording);
  const quantities = [...new Set(compared.flatMap(({ recording }) => recording.parts.flatMap((part) => part.trends.map((trend) => trend.quantity))))];
  const shown = [];
  const charts = quantities.map((key) => {
    const [title, unit, factor] = QUANTITIES[key] ?? [key, '', 1];
    const series = [];
    const ranks = [];
    for (const { choice, recording } of compared) {
      for (const part of recording.parts) {
        const trend = part.trends.find((one) => one.quantity === key);
        if (!trend || trend.bins.length === 0) continue;
        const suffix = recording.parts.length > 1 ? `, ${part.part}` : '';
        series.push({ label: `${choice.label}${suffix}`, x: trend.bins.map((bin) => factor * bin.mean), y: trend.bins.map((bin) => 1e3 * bin.rms_m), colour: choice.colour, style: 'line-dots', dash: part.part === 'held out' });
        if (choice === compared[0].choice && isNumber(trend.rank_correlation)) ranks.push(`${part.part} ${fixed(trend.rank_correlation, 2)}`);
      }
    }
    for (const one of series) if (!shown.some((other) => other.label === one.label)) shown.push(one);
    return chart({ legend: false, title: `Against ${title}`, explain: ranks.length > 0 ? `Rank correlation${compared.length > 1 ? ` of the ${compared[0].choice.label.slice(0, 60)}` : ''}: ${ranks.join(', ')}.` : null,
      x: unit ? `${title}, ${unit}` : title, y: 'rms residual, mm', height: 190, series });
  }).filter(Boolean);
  if (charts.length === 0) return null;
  return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, 'What the error depends on'),
    h('p', { class: 'explain' }, 'Frames (for the distance from the grip: points) in bins of about equal size. An error that grows with speed suggests a missing loss; with strain, a wrong elasticity law.')), sharedLegend(shown), grid(charts, 'small'));
}

// One row for each model, recording and part.
function errorTable(choices) {
  const rows = [];
  for (const choice of choices) {
    const compared = choice.model.comparison?.recordings ?? [];
    for (const recording of compared) {
      for (const part of recording.parts ?? []) {
        rows.push([name(choice.label), name(recording.name), part.part, fixed(part.frames, 0), millimetres(part.rms_m), millimetres(part.rms_at_measured_places_m), sigmas(part.rms_over_sigma), isNumber(part.rms_over_floor) ? fixed(part.rms_over_floor, 1) : '–', millimetres(part.largest_m),
          fixed(part.time_correlation?.lag_one_correlation, 2), name(recording.point_names?.[part.worst_point] ?? '–')]);
      }
    }
    if (compared.length > 0) continue;
    for (const recording of choice.model.calibration?.recordings ?? []) {
      for (const [key, part] of [['in_fit', 'fitted'], ['held_out', 'held out']]) {
        const measure = recording[key];
        if (measure?.frames > 0) rows.push([name(choice.label), name(recording.name), part, fixed(measure.frames, 0), millimetres(measure.rms_m), millimetres(measure.rms_at_measured_places_m), sigmas(measure.rms_over_sigma), '–', millimetres(measure.largest_m), '–', '–']);
      }
    }
  }
  return table('Plain errors', [['model'], ['recording'], ['part'], ['frames', true], ['rms', true, 'with each point at the place on the object that the fit gives it within the uncertainty of its measurement'], ['as measured', true, 'rms with each point at the place where it was measured: where it is much larger, the fit ascribes the difference to errors of these places'], ['rms / σ', true, 'relative to the noise that the fit assumes'], ['rms / floor', true, 'relative to the noise that the recording itself shows'], ['largest', true], ['correlation in time', true, 'of the errors of neighbouring frames; near 0 for noise'], ['worst point']], rows);
}

export function errorSection(context) {
  const { choices, store, recordings } = context;
  const rows = errorTable(choices);
  const notes = [...new Set(choices.flatMap((choice) => choice.model.comparison?.notes ?? []))];
  const hasScenes = recordings.length > 0;
  const hasTrends = choices.some((choice) => choice.model.comparison?.recordings?.some((one) => one.parts?.some((part) => part.trends?.length > 0)));
  const scenes = choices.flatMap((choice) => choice.model.scenes ?? []);
  return section('errors', 'Errors', 'Where and when the models err',
    'Residual is predicted minus measured. 1 σ means as good as the measurement allows.',
    !context.hasErrorsFirst && scenes.some((scene) => scene.series?.rms_m?.length > 0) && following(store, ['recording'], (state) => errorOverTime(context, state)),
    hasScenes && scenes.some((scene) => scene.points_series?.model || scene.points?.model) && following(store, ['recording', 'point'], (state) => pointPlots(context, state)),
    hasReactions(scenes) && following(store, ['recording'], (state) => reactionPlots(context, state)),
    hasTrends && following(store, ['recording'], (state) => trends(context, state)),
    rows, notes.length > 0 && h('ul', { class: 'notes' }, notes.map((note) => h('li', {}, note))));
}

