// The first screen: what was found, how the error fell, how sure that is, and the motion.
import { h } from './dom.js';
import { waterfall } from './waterfall.js';
import { residualChart } from './reconstruction.js';
import { verdictBox } from './verdict.js';

function verdicts(choices) {
  const diagnosed = choices.filter((choice) => choice.model.diagnosis?.verdict);
  return diagnosed.map((choice, k) => verdictBox(choice.model.diagnosis, diagnosed.length > 1 ? choice.label : null, k === 0));
}

// Whether there is neither an error of a model nor a verdict to tell of.
export function hasShortStory({ data, choices }) {
  return !waterfall(choices, data.runs ?? []) && !choices.some((choice) => choice.model.diagnosis?.verdict);
}

export function overview({ data, choices, motion, store, isShort }, problem) {
  const boxes = verdicts(choices).filter(Boolean);
  const errors = waterfall(choices, data.runs ?? []);
  const notes = [...new Set((data.runs ?? []).flatMap((run) => run.notes ?? []))];
  const story = h('div', { class: 'story' },
    h('h1', { class: 'clip' }, data.title ?? 'Report'),
    (data.sentences ?? []).length > 0 ? h('div', { class: 'sentences' }, data.sentences.map((sentence) => h('p', {}, sentence))) : null,
    errors,
    boxes.length > 0 ? h('section', { class: 'verdicts', 'aria-labelledby': 'verdict-title' }, h('h2', { id: 'verdict-title' }, 'What is missing'), boxes) : null,
    isShort ? motion?.worst : null,
    isShort ? (data.runs ?? []).map((run) => residualChart(run.reconstruction?.frames, store)) : null,
    notes.length > 0 ? h('ul', { class: 'notes' }, notes.map((note) => h('li', {}, note))) : null);
  const view = motion ? h('section', { class: 'stage', 'aria-labelledby': 'motion-title' },
    h('div', { class: 'stage-head' }, h('h2', { id: 'motion-title' }, 'The motion'),
      motion.explanation),
    motion.root, isShort ? null : motion.worst) : null;
  return h('div', { class: view ? 'overview' : 'overview narrow', id: 'overview' }, story, view, problem ? h('p', { class: 'notice' }, problem) : null);
}
