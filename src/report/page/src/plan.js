// The recordings that would tell the rivals of a diagnosis apart, the best first, and what is to be done in the best one.
import { chart } from './chart.js';
import { h } from './dom.js';
import { displayUnit, isNumber, NONE, number, percent, posterior, quantity, seconds } from './format.js';
import { grid, name, section, table } from './section.js';

const COLOURS = ['series-first', 'series-last', 'series-2', 'series-1', 'series-4'];

const isPlayable = (outcome) => !outcome.message;
const isPair = (rival) => rival.effects?.length === 2;

function leastSeparation(outcome) {
  const lambdas = (outcome.pairs ?? []).map((pair) => pair.lambda_then).filter(isNumber);
  return lambdas.length > 0 ? Math.min(...lambdas) : NaN;
}

function ranked(plan) {
  const now = (plan.rivals ?? []).reduce((sum, rival) => sum + rival.probability * rival.named_now, 0);
  const rows = (plan.outcomes ?? []).filter(isPlayable).map((outcome) => [
    h('div', { class: 'effect' }, h('code', {}, name(outcome.name)), h('span', { class: 'effect-title' }, name(outcome.what))),
    h('span', { class: 'mini-bar-box' }, h('span', { class: 'mini-bar', style: { width: `${Math.round(56 * outcome.probability)}px` } }), posterior(outcome.probability)),
    h('div', {}, (plan.rivals ?? []).map((rival) => h('div', { class: 'nowrap' }, `${posterior(outcome.named?.[rival.effect])} if ${rival.title}`.slice(0, 120)))),
    number(leastSeparation(outcome)), seconds(outcome.seconds)]);
  const pairs = (plan.rivals ?? []).some(isPair) ? ', where two effects at once count as not named' : '';
  return h('div', {}, table(`If ${(plan.rivals ?? []).length === 1 ? 'it' : 'one of them'} is missing, recordings like these lead to the right name in ${percent(now)} of cases${pairs}.`,
    [['recording'], ['right name', true, 'averaged over the rivals with their probabilities'], ['for each rival'], ['least λ', true, 'of two rivals, with the recording; 12 separates them in four cases of five'], ['length', true]], rows));
}

function intervals(best) {
  return table('Expected sizes with the best recording, if the effect is the missing one', [['effect'], ['size'], ['± 95 % now', true], ['± 95 % then', true]],
    (best.sizes ?? []).map((size) => [name(size.effect), `${size.parameter} ${quantity(size.value, size.unit)}`.slice(0, 120), quantity(size.half_width_now, size.unit, 2), quantity(size.half_width_then, size.unit, 2)]));
}

// One chart for each quantity: the path of the clamp, its turn, the loads.
function picture(best) {
  const { times_s: times, release_s: release, curves } = best.protocol ?? {};
  if (!curves?.length) return null;
  const titles = [...new Set(curves.map((curve) => curve.what))];
  const lines = isNumber(release) ? [{ x: release, colour: 'noise' }] : [];
  return grid(titles.map((title) => {
    const own = curves.filter((curve) => curve.what === title);
    const { unit, factor } = displayUnit(own[0].unit, Math.max(...own.flatMap((curve) => curve.values.map(Math.abs))));
    return chart({ title, x: 'time, s', y: unit, height: 200, lines, explain: lines.length > 0 ? `The dashed line is the release, at ${seconds(release)}.` : null,
      series: own.map((curve, k) => ({ label: curve.component || title, x: times, y: curve.values.map((value) => factor * value), colour: COLOURS[k % COLOURS.length] })) });
  }));
}

// What is open, with the probabilities of the diagnosis.
function question(plan) {
  const list = (entries, probability) => entries.map((entry) => `${entry.title} (${posterior(probability(entry))})`).join(', ');
  const rivals = list(plan.rivals ?? [], (rival) => rival.of_diagnosis);
  if (plan.verdict === 'adequate' && plan.no_effect < 0.5)
    return `No missing effect can be named with certainty, but one is more probable than none (probability that none is missing: ${posterior(plan.no_effect)}). The most probable: ${rivals}.`;
  if (plan.verdict === 'adequate')
    return `Nothing is open: the recordings show no missing effect (probability ${posterior(plan.no_effect)}). If one were there, these would be the most probable: ${rivals}.`;
  if (plan.verdict === 'no power') return `These recordings could not show any effect. The plan tells which recording would best show ${rivals}.`;
  const open = (plan.rivals ?? []).length === 1 ? `Whether ${rivals} is missing, or something else, is open.` : `To be told apart: ${rivals}.`;
  const left = list(plan.also_left ?? [], (nuisance) => nuisance.probability);
  return `${open}${left ? ` The plan does not weigh errors of the measurement or of the discretisation, which could explain the recordings, too: ${left}.` : ''}`;
}

function block({ plan, label }) {
  const best = plan.outcomes?.find(isPlayable);
  const failed = (plan.outcomes ?? []).filter((outcome) => !isPlayable(outcome));
  return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, name(label)),
    h('p', { class: 'explain' }, question(plan).slice(0, 1500))),
  best ? [ranked(plan), h('h4', {}, 'The best recording: ', name(best.what)), picture(best), intervals(best)] : null,
  failed.length > 0 ? h('p', { class: 'explain' }, `Cannot be made: ${failed.map((outcome) => `${outcome.name} (${outcome.message})`).join('; ').slice(0, 1500)}.`) : null,
  plan.not_predicted?.length ? h('p', { class: 'explain' }, `Not planned for: ${plan.not_predicted.join(', ').slice(0, 500)}.`) : null);
}

export function planSection({ choices }) {
  const planned = choices.filter((choice) => choice.model.plan?.outcomes?.length > 0).map(({ model, label }) => ({ plan: model.plan, label }));
  return section('plan', 'Next recording', 'The next recording',
    'Each planned recording was simulated with the fitted model. The right name is how often a diagnosis of the recordings that are there and of this one would name the missing effect.',
    planned.map(block));
}
