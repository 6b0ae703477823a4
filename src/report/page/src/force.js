// The smooth force that would have made the model follow the recording.
import { chart } from './chart.js';
import { h } from './dom.js';
import { displayUnit, fixed, isNumber, number, percent, quantity, seconds } from './format.js';
import { following, grid, section } from './section.js';
import { sceneOf } from './motion.js';
import { heldOutSpans } from './timeline.js';

const AXIS_COLOURS = ['series-first', 'series-last', 'series-2'];

// The band of one standard deviation about a curve, where both are known.
function areaAround(times, values, deviations, factor, colour) {
  const known = times.map((_, k) => k).filter((k) => isNumber(values?.[k]) && isNumber(deviations?.[k]));
  return { colour, x: known.map((k) => times[k]), low: known.map((k) => factor * (values[k] - deviations[k])), high: known.map((k) => factor * (values[k] + deviations[k])) };
}

function charts(scene, store) {
  const { force } = scene;
  if (!force) return null;
  const spans = heldOutSpans(scene.series?.time_s ?? [], scene.series?.fitted);
  const build = (title, unit, lists, labels, deviations) => {
    const all = lists.flatMap((list) => list ?? []).filter(isNumber);
    if (all.length === 0) return null;
    const shown = displayUnit(unit, all.reduce((largest, value) => Math.max(largest, Math.abs(value)), 0));
    return chart({ title, store, spans, x: 'time, s', y: `${title.toLowerCase()}, ${shown.unit}`, height: 220, lines: [{ y: 0, colour: 'rule' }], explain: deviations ? 'The tint is one standard deviation.' : title === 'Torque' ? 'About the centroid of the undeformed object.' : 'Below zero, the force takes energy from the body.',
      areas: (deviations ?? []).map((deviation, k) => areaAround(force.time_s, lists[k], deviation, shown.factor, AXIS_COLOURS[k])),
      series: lists.map((list, k) => ({ label: labels[k], x: force.time_s, y: Array.from(list ?? [], (value) => (isNumber(value) ? value * shown.factor : NaN)), colour: AXIS_COLOURS[k] })) });
  };
  return grid([build('Force', 'N', force.force_N ?? [], ['x', 'y', 'z'], force.force_deviation_N), build('Torque', 'N m', force.torque_N_m ?? [], ['x', 'y', 'z']),
    build('Power', 'W', force.power_W ? [force.power_W] : [], ['power'])]);
}

function summary(record) {
  if (!record) return null;
  if (!record.usable) return h('p', { class: 'explain' }, record.message);
  const vector = (values, unit) => values?.map((value) => quantity(value, unit, 2)).join(', ');
  const entries = [
    ['significant', record.is_significant ? 'yes' : 'no'],
    ['rms force along x, y, z', vector(record.rms_N, 'N')],
    ['one standard deviation of it', vector(record.rms_deviation_N, 'N')],
    ['weight of the part that no grip holds', quantity(record.weight_N, 'N', 2)],
    ['share that never changes', percent(record.constant_share)],
    ...(record.correlations ?? []).map((one) => [`correlation with ${one.quantity}`, fixed(one.correlation, 2)]),
    [`work in ${seconds(record.duration_s)}`, `${quantity(record.work_J, 'J', 2)} ± ${quantity(record.work_deviation_J, 'J', 2)}`],
    ['mean distance from the grip', quantity(record.grip_distance_m, 'm', 2)],
    ['residual without and with it', `${number(record.rms_over_sigma_without, 2)} σ, ${number(record.rms_over_sigma_with, 2)} σ`],
    ['log likelihood ratio', number(record.log_evidence, 3)],
  ];
  return h('dl', { class: 'facts' }, entries.filter(([, value]) => value).map(([key, value]) => h('div', {}, h('dt', {}, key), h('dd', {}, value))));
}

export function forceSection(context) {
  const { choices, store } = context;
  const has = choices.some((choice) => (choice.model.scenes ?? []).some((scene) => scene.force?.time_s?.length > 0) || (choice.model.comparison?.recordings ?? []).some((one) => one.unexplained_force));
  if (!has) return null;
  return section('force', 'Force', 'The unexplained force',
    'The smooth force on the body that would have made the model follow. Its direction, its work and what it correlates with hint at the missing effect: a loss has negative power and follows the velocity.',
    following(store, ['recording', 'first'], (state) => {
      const choice = choices[state.first];
      const scene = sceneOf(choice, state.recording);
      const record = choice.model.comparison?.recordings?.find((one) => one.name === state.recording)?.unexplained_force;
      const shown = [scene ? charts(scene, store) : null, summary(record)].filter(Boolean);
      const subject = `Model: ${choice.label.slice(0, 120)}. Recording: ${String(state.recording).slice(0, 80)}.`;
      return shown.length > 0 ? [h('p', { class: 'explain' }, subject), ...shown] : h('p', { class: 'explain' }, `${subject} No such force was computed for it; choose another one above.`);
    }));
}
