// Fitted parameters with their intervals, and what the data does not pin down.
import { h, svg } from './dom.js';
import { displayUnit, fixed, isNumber, NONE, number, quantity } from './format.js';
import { name, section, table } from './section.js';
import { PARAMETER_VERDICTS } from './text.js';

const [WIDTH, HEIGHT, MARGIN] = [240, 18, 8];

// The axis that spans the intervals of one parameter in all models.
function axisOf(entries) {
  const values = entries.flatMap(({ parameter }) => [parameter.value, parameter.low_95, parameter.high_95]).filter(isNumber);
  let low = Math.min(...values), high = Math.max(...values);
  if (!(high > low)) [low, high] = [low - Math.abs(low || 1) * 0.1, high + Math.abs(high || 1) * 0.1];
  return { low, high, x: (value) => MARGIN + ((WIDTH - 2 * MARGIN) * (value - low)) / (high - low) };
}

// A dot for the value, and a whisker for the interval. A side without a bound has no end mark.
function whisker({ parameter, choice }, { low, high, x }) {
  const style = { stroke: `var(--${choice.colour})`, fill: `var(--${choice.colour})` };
  const [from, to] = [isNumber(parameter.low_95) ? x(parameter.low_95) : 0, isNumber(parameter.high_95) ? x(parameter.high_95) : WIDTH];
  const end = (at) => svg('line', { x1: at, x2: at, y1: HEIGHT / 2 - 4, y2: HEIGHT / 2 + 4, style });
  return svg('svg', { class: 'whiskers', width: WIDTH, height: HEIGHT, viewBox: `0 0 ${WIDTH} ${HEIGHT}`, 'aria-hidden': 'true' },
    low < 0 && high > 0 ? svg('line', { x1: x(0), x2: x(0), y1: -6, y2: HEIGHT + 6, class: 'zero' }) : null,
    svg('line', { x1: from, x2: to, y1: HEIGHT / 2, y2: HEIGHT / 2, style, class: 'whisker' }),
    isNumber(parameter.low_95) ? end(from) : null, isNumber(parameter.high_95) ? end(to) : null,
    svg('circle', { cx: x(parameter.value), cy: HEIGHT / 2, r: 3.6, style }));
}

function verdictText(parameter) {
  if (parameter.verdict === 'traded off') return `traded off with ${parameter.most_correlated_with} (correlation ${fixed(parameter.correlation, 2)})`;
  return parameter.verdict ?? '';
}

// Which kind of data determines each parameter; only where a fit has more than one kind.
function sharesTable(fitted) {
  const percent = (share) => `${fixed(100 * share, 0)} %`;
  const rows = fitted.flatMap(({ label, model }) => model.calibration.parameters.filter((one) => one.shares)
    .map((one) => [name(one.name), name(label), percent(one.shares.markers), percent(one.shares.scans), percent(one.shares.forces)]));
  return rows.length === 0 ? null : table('Share of each kind of data in the information about a parameter, with all others held fixed',
    [['parameter'], ['model'], ['markers', true], ['scans', true], ['forces', true]], rows);
}

export function parameterSection({ choices }) {
  const fitted = choices.filter((choice) => choice.model.calibration?.parameters?.length > 0);
  if (fitted.length === 0) return null;
  const names = [...new Set(fitted.flatMap((choice) => choice.model.calibration.parameters.map((one) => one.name)))];
  const rows = [], starts = [];
  for (const one of names) {
    const entries = fitted.map((choice) => ({ choice, parameter: choice.model.calibration.parameters.find((parameter) => parameter.name === one) })).filter(({ parameter }) => parameter);
    const axis = axisOf(entries);
    entries.forEach(({ choice, parameter }, k) => {
      const { unit, factor } = displayUnit(parameter.unit, Math.max(Math.abs(parameter.value), Math.abs(parameter.high_95 ?? 0)));
      const side = (value, infinite) => (isNumber(value) ? number(value * factor) : infinite);
      starts.push(k === 0);
      rows.push([k === 0 ? name(one) : '', h('span', { class: 'model-name' }, h('i', { class: 'swatch', style: { background: `var(--${choice.colour})` } }), name(choice.label)),
        number(parameter.value * factor), `${side(parameter.low_95, '−∞')} … ${side(parameter.high_95, '∞')}`, name(unit),
        whisker(entries[k], axis), h('span', { class: `pin pin-${(parameter.verdict ?? '').replaceAll(' ', '-')}`, title: PARAMETER_VERDICTS[parameter.verdict] }, verdictText(parameter).slice(0, 200))]);
    });
  }
  const used = [...new Set(fitted.flatMap((choice) => choice.model.calibration.parameters.map((one) => one.verdict)))].filter((one) => PARAMETER_VERDICTS[one]);
  return section('parameters', 'Parameters', 'Parameters',
    'Fitted values with 95 % intervals. A wrong model makes its parameters compensate, so intervals of different models need not overlap.',
    table(null, [['parameter'], ['model'], ['value', true], ['95 % interval', true], ['unit'], ['interval, each on its own scale'], ['what the data say']], rows, (r) => (starts[r] ? 'group-start' : null)),
    h('dl', { class: 'facts wide' }, used.map((one) => h('div', {}, h('dt', {}, one), h('dd', {}, PARAMETER_VERDICTS[one])))),
    sharesTable(fitted),
    table('The fits', [['model'], ['time step', true], ['change if it is halved', true, 'of the prediction'], ['values in conflict with priors', true, 'more than three standard deviations from what was known before the fit']],
      fitted.map(({ label, model: { calibration } }) => [name(label), quantity(calibration.time_step_s, 's'), isNumber(calibration.step_error_over_sigma) ? `${number(calibration.step_error_over_sigma, 2)} σ` : NONE, String(calibration.prior_conflicts?.length ?? 0)])));
}
