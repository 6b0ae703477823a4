// Studies over many runs: Table 1 of the paper, the ablation of its search, sealed cases, and
// intervals that are compared with the truth.
import { chart } from './chart.js';
import { cellColour } from './colours.js';
import { h, svg } from './dom.js';
import { counted, fixed, isNumber, millimetres, NONE, number, quantity, sigmas } from './format.js';
import { grid, name, section, table } from './section.js';
import { traceCharts } from './reconstruction.js';

const range = (value, text) => (isNumber(value?.median)
  ? h('span', {}, text(value.median), h('span', { class: 'extremes' }, `${text(value.least)} … ${text(value.largest)}`)) : NONE);
const share = (value) => (isNumber(value) ? `${fixed(100 * value, 0)} %` : NONE);

// Median and extremes of a share as a dot and a whisker from 0 to 1, with the paper's value as a diamond.
function rangeBar(value, paper) {
  const [width, height] = [220, 18];
  const x = (one) => 6 + (width - 12) * Math.min(Math.max(one, 0), 1);
  if (!isNumber(value?.median)) return '';
  return svg('svg', { class: 'whiskers', width, height, viewBox: `0 0 ${width} ${height}`, 'aria-hidden': 'true' },
    svg('line', { x1: x(0), x2: x(1), y1: 9, y2: 9, class: 'zero' }), svg('line', { x1: x(value.least), x2: x(value.largest), y1: 9, y2: 9, class: 'whisker', style: { stroke: 'var(--accent)' } }),
    svg('circle', { cx: x(value.median), cy: 9, r: 4, style: { fill: 'var(--accent)' } }),
    isNumber(paper) ? svg('rect', { x: x(paper) - 4, y: 5, width: 8, height: 8, transform: `rotate(45 ${x(paper)} 9)`, style: { fill: 'none', stroke: 'var(--text)' } }) : null);
}

export function table1Section({ data }) {
  const runs = (data.runs ?? []).filter((run) => run.table1?.rows?.length > 0);
  return section('table1', 'Table 1', 'Table 1: what the search of geometry and material gains', 'The reduction of the residual per point: median and extremes over the seeds, and the paper’s value (diamond). Each seed has scans, a start and meshes of its own.',
    runs.map(({ table1 }) => [
      table(null, [['searched'], ['seeds', true], ['reduction', true, 'from the largest residual of the search to the smallest'], ['from 0 to 100 %'], ['paper', true], ['reduction from the start', true], ['reduction of the sum |D_anim|', true], ['smallest residual per point', true], ['Young’s modulus', true], ['Poisson’s ratio', true]],
        table1.rows.map((row) => [name(row.name), String(row.seeds), range(row.drop_from_max, share), rangeBar(row.drop_from_max, row.paper_drop), share(row.paper_drop), range(row.drop_from_start, share), range(row.sum_drop_from_max, share), range(row.best_per_point_m, millimetres), range(row.young_modulus_Pa, (value) => quantity(value, 'Pa')), range(row.poisson_ratio, (value) => number(value))])),
      h('p', { class: 'explain' }, [
        table1.truth ? `True values: ${quantity(table1.truth.young_modulus_Pa, 'Pa')} and ${number(table1.truth.poisson_ratio)}.` : '',
        table1.last_is_best?.of > 0 ? `The search “${table1.rows.at(-1).name}” ends at least as low as the better one of the others in ${table1.last_is_best.seeds} of ${table1.last_is_best.of} seeds.` : '',
        isNumber(table1.mesh_noise?.per_point) ? `Mesh noise: another mesh of the same size changes the residual per point by ${number(100 * table1.mesh_noise.per_point, 2)} %.` : ''].filter(Boolean).join(' ').slice(0, 1000)),
      Object.entries(table1.traces ?? {}).map(([key, trace]) => [h('h3', {}, 'Search “', name(key), '”'), traceCharts(trace)])]));
}

export function ablationSection({ data }) {
  const runs = (data.runs ?? []).filter((run) => run.ablation?.rows?.length > 0);
  return section('ablation', 'Ablation', 'Ablation of the search', 'The search, repeated with one thing changed at a time. Each row is compared with the row that it names.',
    runs.map(({ ablation }) => [
      table(null, [['row'], ['varies'], ['against'], ['reduction', true], ['from 0 to 100 %'], ['best, per point', true], ['modulus / truth', true], ['Poisson’s ratio − truth', true], ['evaluations', true], ['what it shows']],
        ablation.rows.map((row) => [name(row.name), name(row.varies), name(row.against), range(row.drop, share), rangeBar(row.drop), range(row.best_per_point_m, millimetres), range(row.young_modulus_over_truth, (value) => number(value)), range(row.poisson_ratio_less_truth, (value) => number(value, 2)), range(row.evaluations, (value) => number(value)), h('div', { class: 'prose' }, name(row.shows))])),
      isNumber(ablation.mesh_noise) ? h('p', { class: 'explain' }, `Mesh noise: another mesh of the same size changes the residual per point by ${number(100 * ablation.mesh_noise, 2)} %; smaller differences mean nothing.`) : null]));
}

function confusion(counts) {
  const truths = Object.keys(counts ?? {});
  if (truths.length === 0) return null;
  const said = [...new Set(truths.flatMap((truth) => Object.keys(counts[truth])))].sort();
  return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, 'Confusion matrix'), h('p', { class: 'explain' }, 'Rows are what was hidden; columns are the effect that was named, or the verdict. The tint is the share of the row.')),
    h('div', { class: 'table-box' }, h('table', { class: `matrix${said.length > 7 ? ' many' : ''}` }, h('thead', {}, h('tr', {}, h('th', {}), said.map((one) => h('th', { scope: 'col' }, name(one))))),
      h('tbody', {}, truths.map((truth) => {
        const total = Object.values(counts[truth]).reduce((sum, value) => sum + value, 0);
        return h('tr', {}, h('th', { scope: 'row' }, name(truth)), said.map((one) => {
          const value = counts[truth][one] ?? 0;
          const { background, colour } = cellColour(value / total);
          return h('td', value > 0 ? { class: 'number', style: { background, color: colour } } : { class: 'number' }, value > 0 ? String(value) : '');
        }));
      })))));
}

// The share of a few statements says little, so that they are no point of the curve.
const FEWEST_STATEMENTS = 5;

function calibrationCurve(bins) {
  const all = (bins ?? []).filter((bin) => isNumber(bin.stated) && isNumber(bin.frequency));
  const shown = all.filter((bin) => bin.statements >= FEWEST_STATEMENTS);
  if (shown.length === 0) return null;
  const left = all.length - shown.length;
  return chart({ title: 'Calibration of the probabilities', explain: `How often a stated probability was right. On the dashed diagonal, probabilities mean what they say.${left > 0 ? ` Intervals with fewer than ${FEWEST_STATEMENTS} statements are left out: ${left}.` : ''}`, x: 'stated probability, %', y: 'frequency, %', xRange: [0, 100], yRange: [0, 100], height: 280,
    series: [{ label: 'diagonal', x: [0, 100], y: [0, 100], colour: 'noise', dash: true }, { label: `found (${shown.map((bin) => bin.statements).join(', ')} statements)`, x: shown.map((bin) => 100 * bin.stated), y: shown.map((bin) => 100 * bin.frequency), colour: 'series-last', style: 'dots', size: 8 }] });
}

// How often verdicts name effects, over all groups, beside what the simulated rules could say.
function rateTable(rates) {
  const shown = (rates ?? []).filter((one) => one.of > 0);
  return table('What is named', [['truth'], ['verdict'], ['cases', true], ['share', true], ['simulated rules', true]],
    shown.map((one, k) => [k === 0 || shown[k - 1].truth !== one.truth ? name(one.truth) : '', name(one.what), `${one.cases} of ${one.of}`, share(one.cases / one.of), share(one.predicted)]));
}

// What further recordings decided, beside what the plan had predicted.
function followUpTable(followUps) {
  const shown = (followUps?.recordings ?? []).filter((one) => one.cases > 0);
  return table('One more recording of the cases that are left open', [['recording'], ['cases', true], ['named', true, 'the hidden effect, and no other'], ['another named', true], ['predicted', true, 'by the plan, where the hidden effect is among its rivals']],
    shown.map((one) => [name(one.choice), String(one.cases), share(one.named / one.cases), String(one.wrong), share(one.predicted)]));
}

export function intervalsSection({ data }) {
  return section('intervals', 'Intervals', 'Do the intervals hold?', 'Each draw simulates a recording with known parameters and fits them. The 50, 80 and 95 % intervals should contain the truth in as many draws.',
    (data.runs ?? []).filter((run) => run.intervals?.parameters).map(({ intervals: { parameters, missing, failed } }) => [
      missing?.length ? h('p', { class: 'explain' }, `The model lacks what the recordings contain: ${missing.join(', ')}. Its intervals cannot be right; they show how far a wrong model misleads.`) : null,
      failed > 0 ? h('p', { class: 'explain' }, `${counted(failed, 'draw')} without a usable fit.`) : null,
      table(null, [['parameter'], ['draws', true], ['in 50 %', true], ['in 80 %', true], ['in 95 %', true], ['mean', true, 'of (truth − centre)/σ; 0 is right'], ['spread', true, 'its standard deviation; 1 is right'], ['χ² p', true, 'that positions in the interval are uniform']],
        parameters.map((one) => [name(one.name), String(one.draws), share(one.covered_50), share(one.covered_80), share(one.covered_95), fixed(one.mean, 2), fixed(one.spread, 2), number(one.p_uniform, 2)])),
      h('p', { class: 'explain' }, 'The plots show the share of draws whose truth lies below each quantile of its interval’s distribution. On the dashed diagonal, intervals mean what they say; above it, estimates are too high.'),
      grid(parameters.map((one) => chart({ title: one.name ?? NONE, x: 'quantile, %', y: 'share of draws, %', xRange: [0, 100], yRange: [0, 100], height: 240,
        series: [{ label: 'diagonal', x: [0, 100], y: [0, 100], colour: 'noise', dash: true }, { label: 'found', x: (one.positions ?? []).map((position) => 100 * position), y: (one.positions ?? []).map((_, k, all) => (100 * (k + 1)) / all.length), colour: 'series-last' }] })), 'small')]));
}

export function trialsSection({ data }) {
  const of = (part, whole) => (whole > 0 ? `${part} of ${whole}` : NONE);
  return section('trials', 'Sealed cases', 'Sealed cases', 'Synthetic recordings whose hidden effect the diagnosis does not read. They measure how often a verdict is right.',
    (data.runs ?? []).filter((run) => run.trials).map(({ trials }) => [
      table(null, [['group'], ['cases', true], ['named', true, 'all that is hidden, and nothing else'], ['in part', true, 'one of two hidden effects, and nothing else'], ['in the first two', true], ['another named', true], ['ranked first', true, 'a hidden effect, by evidence'], ['fit at the noise', true, 'with the hidden effect'], ['size within 15 %', true], ['in the 95 % interval', true, 'true values of parameters'], ['error before', true], ['and after', true], ['verdicts']],
        (trials.tallies ?? []).map((one) => [name(one.group), String(one.cases), String(one.top1), one.pairs > 0 ? String(one.in_part) : NONE, String(one.top2), String(one.wrong), String(one.ranked_first), of(one.at_noise, one.fitted), of(one.within_15_percent, one.fitted), of(one.covered, one.intervals), sigmas(one.median_error_before), one.fitted > 0 ? sigmas(one.median_error_after) : NONE,
          name(Object.entries(one.verdicts ?? {}).map(([verdict, count]) => `${count} ${verdict}`).join(', '))])),
      h('p', { class: 'explain' }, 'Controls hide nothing; hard controls have a faulty measurement; a removed effect is not in the catalogue that the diagnosis tries. 1 rec and 2 rec are the numbers of recordings; 2 x is the size of the hidden effect relative to the detectable one. Errors are medians on held-out frames.'),
      rateTable(trials.rates), followUpTable(trials.follow_ups), confusion(trials.confusion), grid(calibrationCurve(trials.calibration)),
      trials.unfinished?.length ? h('p', { class: 'explain' }, `${counted(trials.unfinished.length, 'case')} without an outcome.`) : null,
      trials.skipped?.length ? h('p', { class: 'explain' }, `${counted(trials.skipped.length, 'case')} could not be made.`) : null]));
}
