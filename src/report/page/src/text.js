// Names and sentences of the page, in the words of docs/glossary.md.
import { h } from './dom.js';

export const FAMILIES = {
  other: 'other physics', steady_force: 'steady force', loss_outside: 'loss outside the body',
  loss_inside: 'loss inside the body', volume_stress: 'stress without a load',
  stiffness_distribution: 'distribution of stiffness', mass_distribution: 'distribution of mass',
  elasticity: 'elasticity at large strain', contact: 'contact',
};

export const VERDICTS = {
  missing: ['One effect is missing', 'The model lacks this effect.'],
  ambiguous: ['Ambiguous', 'One of these is missing, and these recordings cannot tell which.'],
  nuisance: ['Error of the measurement', 'The error comes from the measurement or the discretisation, not from missing physics.'],
  adequate: ['Adequate', 'Nothing is missing that these recordings could show.'],
  'not in library': ['Not in the catalogue', 'Something is missing that no effect of the catalogue explains.'],
  'no power': ['No power', 'These recordings cannot answer the question.'],
};

// Quantities on which the error may depend: name, unit, factor from the SI unit.
export const QUANTITIES = {
  time_s: ['time', 's', 1], displacement_m: ['displacement', 'mm', 1e3], speed_m_per_s: ['speed', 'mm/s', 1e3],
  strain: ['strain', '%', 100], strain_rate_per_s: ['strain rate', '%/s', 100], height_m: ['height', 'mm', 1e3],
  grip_distance_m: ['distance from the grip', 'mm', 1e3],
};

export const PARAMETER_VERDICTS = {
  'pinned down': 'The data determine it.',
  'traded off': 'Changes of other parameters can compensate for its changes.',
  flat: 'The effect of a typical change is within the noise.',
  dead: 'The predictions do not depend on it.',
  'at its bound': 'The best value lies on a bound, so the interval has little meaning.',
};

// The title of an effect within a sentence, without what it has in brackets.
export function shortTitle(title) {
  const short = title.replace(/ \(.*/, '');
  return /^[A-Z][a-z]/.test(short) ? short[0].toLowerCase() + short.slice(1) : short;
}

export const KEYBOARD_HELP = 'Arrow keys turn the view, shift with an arrow key moves it, plus and minus zoom, 0 shows everything.';

// A text of the program, in which `backticks` enclose commands.
export const sentence = (text) => String(text).split(/`([^`]{1,200})`/).map((part, k) => (k % 2 ? h('code', {}, part) : part));

// "a", "a and b", "a, b and c".
// A hypothesis names an effect two times if it contains two of it.
export const namesOf = (all) => {
  if (!all?.length) return 'nothing';
  const names = [...new Set(all)].map((name) => (all.filter((other) => other === name).length > 1 ? `${name} twice` : name));
  return names.length === 1 ? names[0] : `${names.slice(0, -1).join(', ')} and ${names.at(-1)}`;
};

export function modelLabel(model, index) {
  if (model.label) return model.label;
  if (index === 0 && !model.added) return 'the model as it is';
  return model.added ? `with ${model.added}` : model.name ?? `model ${index + 1}`;
}
