// The verdict with its probabilities: of families of effects, and of their members.
import { h } from './dom.js';
import { isNumber, posterior, probabilityText, timesNoise } from './format.js';
import { FAMILIES, VERDICTS, namesOf } from './text.js';

const WORTH_NAMING = 0.01;
const IN_VAIN = 'One effect is named, but does not count';

// Hypotheses grouped by family, the most probable one first. An effect counts with and without
// nuisances beside it.
export function probabilityGroups(decision) {
  const groups = [];
  for (const one of decision?.probabilities ?? []) {
    const isMember = one.kind === 'effect' && one.family !== 'other';
    const name = namesOf(one.kind === 'effect' ? one.names.slice(0, 1) : one.names);
    const key = isMember ? one.family : `${one.kind}:${name}`;
    let group = groups.find((candidate) => candidate.key === key);
    if (!group) {
      group = { key, title: isMember ? FAMILIES[one.family] ?? one.family : one.kind === 'nothing' ? 'nothing is missing' : name,
                kind: one.kind, probability: 0, members: [] };
      groups.push(group);
    }
    group.probability += one.probability;
    if (!isMember) continue;
    const member = group.members.find((candidate) => candidate.name === name);
    if (member) member.probability += one.probability;
    else group.members.push({ name, probability: one.probability });
  }
  const byProbability = (a, b) => b.probability - a.probability;
  for (const group of groups) group.members.sort(byProbability);
  return groups.sort(byProbability);
}

function probabilityRow(name, probability, isMember) {
  return h('div', { class: `probability${isMember ? ' member' : ''}`, role: 'listitem' },
    h('span', { class: 'probability-name', title: name.slice(0, 300) }, name.slice(0, 120)),
    h('div', { class: 'probability-track' }, h('div', { class: 'probability-fill', style: { width: `${100 * probability}%` } })),
    h('span', { class: 'probability-value' }, posterior(probability)));
}

// What remains of the error, once the most probable hypothesis has been added.
function adequacyText(decision) {
  const adequacy = decision?.adequacy;
  if (!adequacy) return null;
  const subject = adequacy.beside?.length ? `With ${namesOf(adequacy.beside)}, the error` : 'The error';
  const size = `${timesNoise(adequacy.rms_over_sigma)} over all frames, ${probabilityText(adequacy.p)}`;
  if (adequacy.is_adequate) return `${subject} is no more than noise and the error of the model would leave (${size}).`;
  if (!adequacy.is_tolerated) return `Something unknown remains: ${subject[0].toLowerCase()}${subject.slice(1)} is more than noise alone would leave (${size}).`;
  const left = isNumber(adequacy.left_share) ? ` The excess is ${Number((100 * adequacy.left_share).toPrecision(2))} % of what was explained, which is tolerated.` : '';
  return `${subject} is slightly more than noise alone would leave (${size}).${left}`;
}

// One line: the verdict on a model that came later, and its most probable hypotheses.
function shortVerdict(diagnosis, subject, title, groups, isInVain) {
  return h('div', { class: `verdict short ${isInVain ? 'in-vain' : `verdict-${diagnosis.verdict.replaceAll(' ', '-')}`}` },
    h('p', { class: 'verdict-head' }, h('span', { class: 'muted' }, `${subject.slice(0, 200)}: `), h('span', { class: 'verdict-name' }, isInVain ? IN_VAIN : title), ' ',
      (diagnosis.effects ?? []).map((effect) => [h('code', { class: 'clip' }, effect), ' ']),
      h('span', { class: 'muted' }, isInVain ? 'Once fitted, its size may be 0.'
        : groups.slice(0, 3).map((group) => `${group.title.slice(0, 60)} ${posterior(group.probability)}`).join(', '))));
}

// `isInVain`: the effect that is named does not count once it is fitted.
export function verdictBox(diagnosis, subject, isFirst, isInVain) {
  if (!diagnosis?.verdict) return null;
  const [title, meaning] = VERDICTS[diagnosis.verdict] ?? [diagnosis.verdict, ''];
  const effects = diagnosis.effects ?? [];
  const groups = probabilityGroups(diagnosis.decision).filter((group) => group.probability >= WORTH_NAMING).slice(0, 5);
  if (!isFirst) return shortVerdict(diagnosis, subject, title, groups, isInVain);
  return h('div', { class: `verdict verdict-${diagnosis.verdict.replaceAll(' ', '-')}` },
    h('p', { class: 'verdict-head' },
      subject ? h('span', { class: 'muted' }, `${subject}: `) : null,
      h('span', { class: 'verdict-name' }, isInVain ? IN_VAIN : title), effects.length > 0 ? [' ', diagnosis.verdict === 'not in library' ? h('span', { class: 'muted' }, 'closest: ') : null, effects.map((name, k) => [k > 0 ? ' ' : '', h('code', { class: 'clip' }, name)])] : null),
    h('p', { class: 'explain' }, isInVain ? 'Once fitted, its size may be 0.' : meaning, ' ', adequacyText(diagnosis.decision)),
    groups.length > 0 ? h('div', { class: 'probabilities', role: 'list', 'aria-label': 'Probability of what is missing' },
      h('p', { class: 'small-head' }, diagnosis.verdict === 'not in library'
        ? 'What comes closest: probabilities among the hypotheses that were tried, none of which suffices'
        : 'How sure: the probability of each effect that could be missing'),
      groups.map((group) => [probabilityRow(group.title, group.probability, false),
        group.members.filter((member) => member.probability >= WORTH_NAMING).map((member) => probabilityRow(member.name, member.probability, true))])) : null);
}
