// Fitted parameters with their intervals, and what the data does not pin down.
import { h, svg } from './dom.js';
import { displayUnit, fixed, isNumber, NONE, number, quantity } from './format.js';
import { name, section, table } from './section.js';
import { PARAMETER_VERDICTS } from './text.js';

const [WIDTH, MARGIN] = [240, 8];

// The intervals of one parameter in all models, on one axis that spans them.
function whiskers(entries) {
  const values = entries.flatMap(({ parameter }) => [parameter.value, parameter.low_95, parameter.high_95]).filter(isNumber);
  let low = Math.min(...values), high = Math.max(...values);
  if (!(high > low)) [low, high] = [low - Math.abs(low || 1) * 0.1, high + Math.abs(high || 1) * 0.1];
  const x = (value) => MARGIN + ((WIDTH - 2 * MARGIN) * (value - low)) / (high - low);
  const height = 14 * entries.length + 4;
  const parts = [];
  if (low < 0 && high > 0) parts.push(svg('line', { x1: x(0), x2: x(0), y1: 0, y2: height, class: 'zero' }));
  entries.forEach(({ parameter, choice }, k) => {
    const y = 9 + 14 * k;
    const style = { stroke: `var(--${choice.colour})`, fill: `var(--${choice.colour})` };
    const from = isNumber(parameter.low_95) ? x(parameter.low_95) : 0, to = isNumber(parameter.high_95) ? x(parameter.high_95) : WIDTH;
    parts.push(svg('line', { x1: from, x2: to, y1: y, y2: y, style, class: 'whisker' }));
    if (isNumber(parameter.low_95)) parts.push(svg('line', { x1: from, x2: from, y1: y - 4, y2: y + 4, style }));
    if (isNumber(parameter.high_95)) parts.push(svg('line', { x1: to, x2: to, y1: y - 4, y2: y + 4, style }));
    parts.push(svg('circle', { cx: x(parameter.value), cy: y, r: 3.6, style }));
  });
  return svg('svg', { class: 'whiskers', width: WIDTH, height, viewBox: `0 0 ${WIDTH} ${height}`, 'aria-hidden': 'true' }, parts);
}

function verdictText(parameter) {
  if (parameter.verdict === 'traded off') return `traded off with ${parameter.most_correlated_with} (correlation ${fixed(parameter.correlation, 2)})`;
  return parameter.verdict ?? '';
}

export function parameterSection({ choices }) {
  const fitted = choices.filter((choice) => choice.model.calibration?.parameters?.length > 0);
  if (fitted.length === 0) return null;
  const names = [...new Set(fitted.flatMap((choice) => choice.model.calibration.parameters.map((one) => one.name)))];
  const rows = [], starts = [];
  for (const one of names) {
    const entries = fitted.map((choice) => ({ choice, parameter: choice.model.calibration.parameters.find((parameter) => parameter.name === one) })).filter(({ parameter }) => parameter);
    entries.forEach(({ choice, parameter }, k) => {
      const { unit, factor } = displayUnit(parameter.unit, Math.max(Math.abs(parameter.value), Math.abs(parameter.high_95 ?? 0)));
      const side = (value, infinite) => (isNumber(value) ? number(value * factor) : infinite);
      starts.push(k === 0);
      rows.push([k === 0 ? name(one) : '', h('span', { class: 'model-name' }, h('i', { class: 'swatch', style: { background: `var(--${choice.colour})` } }), name(choice.label)),
        number(parameter.value * factor), `${side(parameter.low_95, '−∞')} … ${side(parameter.high_95, '∞')}`, name(unit),
        k === 0 ? whiskers(entries) : '', h('span', { class: `pin pin-${(parameter.verdict ?? '').replaceAll(' ', '-')}`, title: PARAMETER_VERDICTS[parameter.verdict] }, verdictText(parameter).slice(0, 200))]);
    });
  }
  const conflicts = fitted.reduce((sum, choice) => sum + (choice.model.calibration.prior_conflicts?.length ?? 0), 0);
  const used = [...new Set(fitted.flatMap((choice) => choice.model.calibration.parameters.map((one) => one.verdict)))].filter((one) => PARAMETER_VERDICTS[one]);
  return section('parameters', 'Parameters', 'Parameters',
    'Fitted values with 95 % intervals. A wrong model makes its parameters compensate, so intervals of different models need not overlap.',
    table(null, [['parameter'], ['model'], ['value', true], ['95 % interval', true], ['unit'], ['interval, each on its own scale'], ['what the data says']], rows, (r) => (starts[r] ? 'group-start' : null)),
    h('dl', { class: 'facts wide' }, used.map((one) => h('div', {}, h('dt', {}, one), h('dd', {}, PARAMETER_VERDICTS[one])))),
    conflicts > 0 && h('p', { class: 'explain' }, `${conflicts} values conflict with what was known before the fit (more than three standard deviations from the prior).`),
    h('p', { class: 'explain' }, fitted.map((choice) => choice.model.calibration).map((one, k) => `${fitted[k].label.slice(0, 80)}: time step ${quantity(one.time_step_s, 's')}, halving it would change the prediction by ${isNumber(one.step_error_over_sigma) ? `${number(one.step_error_over_sigma, 2)} σ` : NONE}.`).join(' ')));
}
