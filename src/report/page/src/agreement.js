// The parameters that each recording alone would have given, side by side.
import { h, svg } from './dom.js';
import { displayUnit, fixed, isNumber, NONE, number, probabilityText } from './format.js';
import { name, section, table } from './section.js';

const [WIDTH, ROW, MARGIN] = [240, 16, 8];

// A row of dots with bars of one standard deviation, on one scale.
function comparison(parameter) {
  const known = parameter.values.map((value, k) => ({ value, deviation: parameter.deviations[k], k })).filter(({ value, deviation }) => isNumber(value) && isNumber(deviation));
  if (known.length === 0) return NONE;
  const low = Math.min(...known.map(({ value, deviation }) => value - 2 * deviation));
  const high = Math.max(...known.map(({ value, deviation }) => value + 2 * deviation));
  const x = (value) => MARGIN + ((WIDTH - 2 * MARGIN) * (value - low)) / (high - low || 1);
  const height = ROW * parameter.values.length;
  return svg('svg', { class: 'whiskers', width: WIDTH, height, viewBox: `0 0 ${WIDTH} ${height}`, 'aria-hidden': 'true' },
    known.map(({ value, deviation, k }) => {
      const y = ROW * (k + 0.5);
      const style = { stroke: 'var(--series-first)', fill: 'var(--series-first)' };
      return [svg('line', { x1: x(value - deviation), x2: x(value + deviation), y1: y, y2: y, style, class: 'whisker' }), svg('circle', { cx: x(value), cy: y, r: 3.6, style })];
    }).flat());
}

function estimates(parameter, agreement) {
  const size = Math.max(...parameter.values.filter(isNumber).map(Math.abs), 0);
  const { unit, factor } = displayUnit(parameter.unit, size);
  return agreement.recordings.map((recording, k) => h('div', { class: 'nowrap' },
    isNumber(parameter.deviations[k])
      ? `${number(parameter.values[k] * factor, 4)} ± ${number(parameter.deviations[k] * factor, 2)} ${unit} from ${recording.slice(0, 60)}`
      : `not determined by ${recording.slice(0, 60)}`));
}

function block({ model, label }) {
  const { agreement } = model.diagnosis;
  const disagree = agreement.p_value < 0.05;
  return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, name(label)),
    h('p', { class: 'explain' }, `${disagree ? 'The recordings disagree' : 'The recordings agree'}: χ² = ${fixed(agreement.chi_square, 1)} with ${agreement.degrees_of_freedom} degrees of freedom, ${probabilityText(agreement.p_value)}.`)),
  table(null, [['parameter'], ['each recording alone, ± one standard deviation'], ['on one scale'], ['p', true, 'the probability of such a difference by chance, if only this parameter may differ'], ['differs most']],
    agreement.parameters.map((parameter) => [name(parameter.name), h('div', {}, estimates(parameter, agreement)), comparison(parameter), number(parameter.p_value, 2), parameter.odd_recording ? name(parameter.odd_recording) : NONE])));
}

export function agreementSection({ choices }) {
  const compared = choices.filter((choice) => choice.model.diagnosis?.agreement?.degrees_of_freedom > 0);
  return section('agreement', 'Recordings', 'Do the recordings agree?',
    'Each recording has estimates of its own, with the same error of mesh, shape and markers’ places as the others. Where they differ by more than chance, something differs between the recordings, or the model lacks something.',
    compared.map(block));
}
