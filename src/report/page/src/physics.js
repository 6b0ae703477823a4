// Which effects were tried, how probable each is, and which of them these recordings can separate.
import { cellColour } from './colours.js';
import { h, labelledSelect } from './dom.js';
import { displayUnit, fixed, isNumber, millimetres, NONE, number, percent, posterior, sigmas } from './format.js';
import { foldRows, name, section, table } from './section.js';
import { namesOf } from './text.js';

const SEPARATES = 12;  // λ with which a decision is right in four cases of five

const isUsable = (effect) => effect.refit && !effect.refit.message;

// "28.7 [27.6, 29.7] kPa" where the effect was refitted, else "28.7 ± 0.9 kPa".
function sizeText(size) {
  const found = size.refitted;
  const value = found ? found.value : size.expected;
  const { unit, factor } = displayUnit(size.unit, Math.abs(value ?? 0));
  const text = (one, infinite, digits) => (isNumber(one) ? number(one * factor, digits) : infinite);
  const range = found ? ` [${text(found.low_95, '−∞')}, ${text(found.high_95, '∞')}]` : isNumber(size.deviation) ? ` ± ${text(size.deviation, '', 2)}` : '';
  return `${text(value, NONE)}${range}${unit ? ` ${unit}` : ''}`;
}

function probabilityCell(probability, isRefuted) {
  if (!isNumber(probability)) return NONE;
  return h('span', { class: 'mini-bar-box' }, h('span', { class: 'mini-bar', style: { width: `${Math.round(56 * probability)}px` } }), isRefuted ? 'refuted' : posterior(probability));
}

// The probability that this effect alone is missing, with or without nuisances beside it.
export function beliefIn(type, decision) {
  const withEffect = (decision?.probabilities ?? []).filter((one) => one.kind === 'effect' && one.names[0] === type);
  if (withEffect.length === 0) return undefined;
  return { probability: withEffect.reduce((sum, one) => sum + one.probability, 0), is_refuted: withEffect.every((one) => one.is_refuted) };
}

function candidates(diagnosis) {
  const byName = (type) => beliefIn(type, diagnosis.decision);
  const before = diagnosis.held_out_rms_over_sigma;
  const shown = (diagnosis.ranking ?? []).filter((effect) => effect.evidence > 0 || isUsable(effect) || byName(effect.effect)?.probability > 0);
  const rows = shown.map((effect) => {
    const after = isUsable(effect) ? effect.refit.held_out_rms_over_sigma : effect.expected_held_out_rms_over_sigma;
    const belief = byName(effect.effect);
    return [
      h('div', { class: 'effect' }, h('code', {}, name(effect.effect)), h('span', { class: 'effect-title' }, name(effect.title)), effect.variant ? h('span', { class: 'muted small' }, name(effect.variant)) : null),
      probabilityCell(belief?.probability, belief?.is_refuted), fixed(effect.evidence, 1), isUsable(effect) ? fixed(effect.refit.evidence, 1) : NONE,
      h('div', {}, effect.sizes?.map((size) => h('div', { class: 'nowrap' }, sizeText(size))), isUsable(effect) ? effect.refit.others?.map((other) => h('div', { class: 'muted small' }, `${other.parameter} ${sizeText({ unit: other.unit, refitted: other })}`.slice(0, 200))) : null),
      h('span', { class: isUsable(effect) ? null : 'muted' }, `${sigmas(before)} → ${sigmas(after)}`), isUsable(effect) ? millimetres(effect.refit.held_out_rms_m) : NONE,
      isNumber(effect.absorbed_share) ? percent(effect.absorbed_share) : NONE, effect.look_alikes?.length ? name(effect.look_alikes.join(', ')) : NONE,
    ];
  });
  // The last row that says more than that the effect is improbable.
  const fewest = Math.max(5, 1 + shown.findLastIndex((effect) => isUsable(effect) || diagnosis.effects?.includes(effect.effect) || byName(effect.effect)?.probability >= 0.005));
  const silent = (diagnosis.ranking ?? []).filter((effect) => !shown.includes(effect)).map((effect) => effect.effect);
  return rows.length === 0 && silent.length === 0 ? null : h('div', { class: 'block' },
    h('div', { class: 'block-head' }, h('h3', {}, 'Effects that were tried'),
      h('p', { class: 'explain' }, 'Evidence is the logarithm of the Bayes factor against the model without the effect, less a penalty for the number of effects that were tried; 5 is a factor of about 150. A first-order estimate ranks the effects, and a refit with the effect decides. Grey errors are estimates without a refit. Errors in σ leave out what mesh and time step contribute.')),
    foldRows(table(null, [['effect'], ['probability', true], ['first-order evidence', true, 'from derivatives along the fitted motion'], ['evidence of the refit', true], ['size [95 %] or ± 1 σ'], ['held-out error', true], ['plain error', true], ['absorbed', true, 'share of the signature that the fitted parameters can imitate'], ['look-alikes', false, 'effects that these recordings cannot distinguish to first order']], rows,
      (r) => (diagnosis.effects?.includes(shown[r].effect) ? 'named' : null)), fewest, 'effects'),
    silent.length > 0 ? h('p', { class: 'explain' }, `No evidence for: ${silent.join(', ').slice(0, 1500)}.`) : null,
    removedMisfit(diagnosis),
    diagnosis.untried?.length ? h('p', { class: 'explain' }, `Not tried: ${diagnosis.untried.map((one) => `${one.effect} (${one.why})`).join('; ').slice(0, 1500)}.`) : null,
    experiments(diagnosis, shown));
}

// From which kinds of data each refitted effect removes squared misfit; only where there are several.
function removedMisfit(diagnosis) {
  const kinds = ['markers', 'scans', 'forces'];
  const rows = (diagnosis.ranking ?? []).filter((effect) => isUsable(effect) && effect.refit.removed_misfit)
    .map((effect) => [h('code', {}, name(effect.effect)), ...kinds.map((kind) => fixed(effect.refit.removed_misfit[kind], 1))]);
  return table('Squared misfit that each refitted effect removes from each kind of data, in σ². A negative number is misfit that it adds.',
    [['effect'], ...kinds.map((kind) => [kind, true])], rows);
}

function experiments(diagnosis, shown) {
  const named = shown.filter((effect) => effect.separating_experiment && (diagnosis.effects?.includes(effect.effect) || effect.look_alikes?.length > 0)).slice(0, 4);
  if (named.length === 0) return null;
  return h('div', {}, h('h4', {}, 'Experiments that would tell them apart'), h('dl', { class: 'facts wide' }, named.map((effect) => h('div', {}, h('dt', {}, effect.effect), h('dd', {}, `${effect.separating_experiment}.`)))));
}

function nuisances(diagnosis) {
  const rows = (diagnosis.nuisances ?? []).filter((one) => one.evidence > 0 || one.adopted).map((one) => [
    h('div', { class: 'effect' }, h('code', {}, name(one.nuisance)), h('span', { class: 'effect-title' }, name(one.what))),
    fixed(one.evidence, 1), fixed(one.refitted_evidence, 1), percent(one.explained_share), one.adopted ? 'in every model' : '', name(one.advice)]);
  if (rows.length === 0) return null;
  return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, 'Nuisances'),
    h('p', { class: 'explain' }, 'Errors of the measurement or the discretisation that can look like physics of the object.')),
    table(null, [['nuisance'], ['first-order evidence', true], ['refitted', true], ['explains', true, 'share of the squared misfit'], ['in the model'], ['how to check']], rows));
}

// Which pairs of effects these recordings can separate.
function separability(decision) {
  const pairs = decision?.separations ?? [];
  if (pairs.length === 0) return null;
  const names = [...new Set(pairs.flatMap((pair) => [pair.first, pair.second]))];
  const find = (a, b) => pairs.find((pair) => (pair.first === a && pair.second === b) || (pair.first === b && pair.second === a));
  const cell = (a, b) => {
    if (a === b) return h('td', { class: 'diagonal' });
    const pair = find(a, b);
    if (!pair || !isNumber(pair.lambda)) return h('td', { class: 'number muted' }, NONE);
    const share = Math.min(1, Math.log10(1 + pair.lambda) / 4);
    const { background, colour } = cellColour(share);
    const separates = pair.lambda >= SEPARATES;
    return h('td', { class: `number${separates ? '' : ' inseparable'}`, style: { background, color: colour }, title: `${separates ? 'separable' : 'not separable'}: ${a.slice(0, 80)}, ${b.slice(0, 80)}` }, number(pair.lambda, 2), separates ? '' : h('span', { class: 'cross', 'aria-label': ', not separable' }, ' ✕'));
  };
  return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, 'Which pairs these recordings can separate'),
    h('p', { class: 'explain' }, `λ is the squared distance of the predictions of two effects in units of the noise, after all parameters have been adjusted. ${SEPARATES} separates them in four cases of five; below it the cell has a cross.`)),
    h('div', { class: 'table-box' }, h('table', { class: 'matrix' },
      h('thead', {}, h('tr', {}, h('th', {}), names.map((one) => h('th', { scope: 'col' }, name(one))))),
      h('tbody', {}, names.map((a) => h('tr', {}, h('th', { scope: 'row' }, name(a)), names.map((b) => cell(a, b))))))));
}

const OUTCOMES = [['named', 'named', 'series-2'], ['wrong_member', 'a relative was named', 'series-4'], ['wrong', 'another was named', 'warn'], ['open', 'left open', 'noise'], ['unknown', 'something unknown reported', 'series-1']];

function power(decision) {
  const rows = (decision?.power ?? []).map((one) => [
    name(one.truth?.length ? namesOf(one.truth) : 'nothing'),
    h('div', { class: 'stack', role: 'img', 'aria-label': OUTCOMES.map(([key, title]) => `${title} ${percent(one[key])}`).join(', ') },
      OUTCOMES.map(([key, , colour]) => h('span', { style: { width: `${100 * (one[key] ?? 0)}%`, background: `var(--${colour})` } }))),
    ...OUTCOMES.map(([key]) => percent(one[key])), one.most_wrong ? name(one.most_wrong) : NONE]);
  if (rows.length === 0) return null;
  return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, 'What such recordings would have said'),
    h('p', { class: 'explain' }, 'Had this been missing at the size that was found: the outcomes of simulated recordings.')),
    h('p', { class: 'key' }, OUTCOMES.map(([, title, colour]) => h('span', { class: 'key-item' }, h('i', { class: 'swatch', style: { background: `var(--${colour})` } }), title))),
    table(null, [['truth'], ['outcomes'], ...OUTCOMES.map(([, title]) => [title, true]), ['most frequent wrong name']], rows));
}

export function physicsSection({ choices }) {
  const diagnosed = choices.filter((choice) => choice.model.diagnosis);
  if (diagnosed.length === 0) return null;
  const body = h('div', { class: 'following' });
  const show = (index) => {
    const { diagnosis } = diagnosed[index].model;
    body.replaceChildren(...[candidates(diagnosis), separability(diagnosis.decision), power(diagnosis.decision), nuisances(diagnosis)].filter(Boolean));
  };
  show(0);
  const chooser = diagnosed.length > 1 ? labelledSelect('Diagnosis of', diagnosed.map((choice, k) => [String(k), choice.label.slice(0, 80)]), '0', (value) => show(Number(value))).root : null;
  return section('physics', 'Missing physics', 'Which physics the model lacks', 'Every effect of the catalogue was added to the model in turn.', chooser, body);
}
