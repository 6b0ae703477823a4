// A reconstruction: how closely the model follows the scan in each frame, and the search that led there.
import { chart } from './chart.js';
import { h } from './dom.js';
import { displayUnit, isNumber, millimetres, number, quantity } from './format.js';
import { grid, section } from './section.js';

const scaled = (values, factor) => Array.from(values ?? [], (value) => (isNumber(value) ? factor * value : NaN));

function best(values) {
  let least = Infinity;
  return values.map((value) => (least = Number.isFinite(value) ? Math.min(least, value) : least));
}

const PARAMETERS = { young_modulus_Pa: 'Young’s modulus', poisson_ratio: 'Poisson’s ratio', max_volume_m3: 'Largest volume of a tetrahedron', radius_edge_ratio: 'Ratio of radius to edge of a tetrahedron' };
const LENGTHS = [['residual_mean_m', 'mean residual |D| per point', 'series-last'], ['surface_distance_mean_m', 'mean distance of the scan', 'series-2'], ['surface_distance_max_m', 'largest distance of the scan', 'series-first']];

// The axis of the frames: their times, or else their numbers.
function axisOf(frames, store) {
  return frames?.time_s ? { store, x: 'time, s', values: frames.time_s } : { store: null, x: 'frame', values: frames?.frame ?? [] };
}

export function residualChart(frames, store) {
  const { values, ...axis } = axisOf(frames, store);
  if (values.length < 2) return null;
  return chart({ ...axis, title: 'Residual of each frame', y: 'length, mm',
    explain: 'D is the displacement from the simulated surface to the recorded one. Fitted forces can make a wrong model follow: a small residual does not prove the physics.',
    series: LENGTHS.filter(([key]) => frames[key]).map(([key, label, colour]) => ({ label, x: values, y: scaled(frames[key], 1e3), colour })) });
}

const FORCES = { none: ['forces', 'The model followed the scan without fitted or recorded forces.'], known: ['recorded forces', 'The model followed the scan under the recorded loads.'],
  fitted: ['fitted forces', 'The model was made to follow the scan with fitted forces, frame by frame.'] };
const forcesOf = (reconstruction) => FORCES[reconstruction?.record?.forces] ?? FORCES.fitted;

function forceChart(reconstruction, store) {
  const { frames } = reconstruction;
  const { values, ...axis } = axisOf(frames, store);
  if (values.length < 2) return null;
  return chart({ ...axis, title: `Resultant of the ${forcesOf(reconstruction)[0]}`, y: 'force, N',
    series: ['x', 'y', 'z'].filter((one) => frames[`force_${one}_N`]).map((one, k) => ({ label: one, x: values, y: scaled(frames[`force_${one}_N`], 1), colour: ['series-first', 'series-last', 'series-2'][k] })) });
}

export function traceCharts(trace) {
  if (!trace) return null;
  const columns = Object.entries(trace).filter(([, values]) => Array.isArray(values) && values.length > 0);
  if (columns.length === 0) return null;
  const evaluation = trace.evaluation ?? columns[0][1].map((_, k) => k + 1);
  const measure = trace.residual_per_point_m ? 'residual_per_point_m' : columns.map(([key]) => key).find((key) => /residual|value|objective/.test(key));
  const charts = [];
  if (measure) {
    const factor = measure.endsWith('_m') ? 1e3 : 1;
    const values = scaled(trace[measure], factor);
    charts.push(chart({ title: 'Trace of the search', explain: 'Each dot is one reconstruction; the line is the best so far.', height: 180, x: 'evaluation', y: `${measure.replace(/_m$/, '').replaceAll('_', ' ')}${factor === 1e3 ? ', mm' : ''}`,
      series: [{ label: 'evaluations', x: evaluation, y: values, colour: 'noise', style: 'dots' }, { label: 'best so far', x: evaluation, y: best(values), colour: 'series-last' }] }));
  }
  for (const [key, values] of columns) {
    if (!/young_modulus|poisson_ratio|max_volume|radius_edge/.test(key) || new Set(values).size < 2) continue;  // not searched
    const largest = Math.max(...values.filter(isNumber).map(Math.abs), 0);
    const { unit, factor } = key.endsWith('_Pa') ? displayUnit('Pa', largest) : key.endsWith('_m3') ? { unit: 'mm³', factor: 1e9 } : { unit: '', factor: 1 };
    charts.push(chart({ title: PARAMETERS[key] ?? key.replaceAll('_', ' '), x: 'evaluation', y: unit, height: 180, axisSize: 64, includesZero: false, legend: false, series: [{ label: key, x: evaluation, y: scaled(values, factor), colour: 'series-1', style: 'dots' }] }));
  }
  return grid(charts, 'small');
}

function facts(record) {
  if (!record) return null;
  const { mesh } = record;
  const entries = [
    ['recording', record.recording], ['size of the object', millimetres(record.object_size_m)], ['|D_anim|, sum over all frames', isNumber(record.animation_residual_m) ? `${number(record.animation_residual_m)} m` : null],
    ['mean residual over the size', isNumber(record.relative_animation_residual) ? `${number(100 * record.relative_animation_residual, 2)} %` : null],
    ['nodes', mesh?.node_count], ['tetrahedra', mesh?.tet_count], ['order of the elements', mesh?.order], ['volume', isNumber(mesh?.volume_m3) ? `${number(1e9 * mesh.volume_m3)} mm³` : null],
    ...Object.entries(record.stages ?? {}).map(([stage, status]) => [`stage ${stage}`, `${status.status}${status.message ? `: ${status.message}` : ''}`]),
    ...Object.entries(record.measures ?? {}).map(([key, value]) => {
      const match = /^(.*)_(m|N|Pa|s|W|J|kg)$/.exec(key);
      return [(match ? match[1] : key).replaceAll('_', ' '), match ? quantity(value, match[2]) : number(value)];
    })];
  return h('dl', { class: 'facts' }, entries.filter(([, value]) => value !== null && value !== undefined && value !== '').map(([key, value]) => h('div', {}, h('dt', {}, String(key).slice(0, 200)), h('dd', {}, String(value).slice(0, 400)))));
}

// The residual of the frames stands on the first screen where there is room for it.
export function reconstructionSection({ data, store, isShort }) {
  const runs = (data.runs ?? []).filter((run) => run.reconstruction);
  const parts = runs.map(({ reconstruction, name }) => [
    data.runs.length > 1 ? h('h3', {}, String(name).slice(0, 200)) : null,
    grid([isShort ? null : residualChart(reconstruction.frames, store), forceChart(reconstruction, store)]), traceCharts(reconstruction.trace), facts(reconstruction.record),
    reconstruction.record?.warnings?.length ? h('ul', { class: 'notes' }, reconstruction.record.warnings.map((warning) => h('li', {}, warning.slice(0, 500)))) : null]);
  return section('reconstruction', 'Reconstruction', 'Reconstruction', [...new Set(runs.map((run) => forcesOf(run.reconstruction)[1]))].join(' '), parts);
}

