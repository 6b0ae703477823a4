// The first screen: what was found, how the error fell, how sure that is, and the motion.
import { errorOverTime } from './errors.js';
import { h } from './dom.js';
import { counted, millimetres } from './format.js';
import { residualChart } from './reconstruction.js';
import { following } from './section.js';
import { sentence } from './text.js';
import { verdictBox } from './verdict.js';
import { waterfall } from './waterfall.js';

function verdicts(choices) {
  const diagnosed = choices.filter((choice) => choice.model.diagnosis?.verdict);
  return diagnosed.map((choice, k) => {
    const after = choices[choices.indexOf(choice) + 1];
    const isInVain = after?.run === choice.run && !after.counts;
    return verdictBox(choice.model.diagnosis, diagnosed.length > 1 ? choice.label : null, k === 0, isInVain);
  });
}

const isDiagnosed = (choices) => choices.some((choice) => choice.model.diagnosis?.verdict);

// Whether there is neither an error of a model nor a verdict to tell of; and whether there are
// errors, which then stand on the first screen over time in the place of a verdict.
export function lengthOfStory({ data, choices }) {
  const [hasErrors, hasVerdict] = [Boolean(waterfall(choices, data.runs ?? [])), isDiagnosed(choices)];
  return { isShort: !hasErrors && !hasVerdict, hasErrorsFirst: hasErrors && !hasVerdict };
}

// What was measured: "2 recordings of 8 markers, 120 frames, 28 of them held out".
function measured({ data, choices, recordings }) {
  if (data.runs?.length !== 1) return null;
  const { calibration, scenes } = choices[0]?.model ?? {};
  if (!(calibration?.recordings?.length > 0)) return null;
  const sum = (part) => calibration.recordings.reduce((frames, one) => frames + (one[part]?.frames ?? 0), 0);
  const [fitted, heldOut] = [sum('in_fit'), sum('held_out')];
  const points = [...new Set((scenes ?? []).filter((scene) => recordings.includes(scene.recording) && scene.points)
    .map((scene) => counted(scene.points.measured?.shape?.[1] ?? 0, scene.points.is_scan ? 'patch' : 'marker')))];
  const noise = data.runs[0].noise;
  const parts = [`${counted(calibration.recordings.length, 'recording')}${points.length === 1 ? ` of ${points[0]}` : ''}`,
    `${counted(fitted + heldOut, 'frame')}${heldOut > 0 ? `, ${heldOut} of them held out` : ''}`, noise > 0 ? `noise ${millimetres(noise)}` : null];
  return h('p', { class: 'muted measured' }, parts.filter(Boolean).join(' · '));
}

export function overview(context, problem) {
  const { data, choices, motion, store, isShort } = context;
  const boxes = verdicts(choices).filter(Boolean);
  const errors = waterfall(choices, data.runs ?? []);
  const notes = [...new Set((data.runs ?? []).flatMap((run) => run.notes ?? []))];
  const story = h('div', { class: 'story' },
    h('div', {}, h('h1', { class: 'clip' }, data.title ?? 'Report'), measured(context)),
    (data.sentences ?? []).length > 0 ? h('div', { class: 'sentences' }, data.sentences.map((text) => h('p', {}, sentence(text)))) : null,
    errors,
    boxes.length > 0 ? h('section', { class: 'verdicts', 'aria-labelledby': 'verdict-title' }, h('h2', { id: 'verdict-title' }, 'What is missing'), boxes) : null,
    isShort ? motion?.worst : null,
    isShort ? (data.runs ?? []).map((run) => residualChart(run.reconstruction?.frames, store)) : null,
    context.hasErrorsFirst ? following(store, ['recording'], (state) => errorOverTime(context, state)) : null,
    notes.length > 0 ? h('ul', { class: 'notes' }, notes.map((note) => h('li', {}, sentence(note)))) : null);
  const view = motion ? h('section', { class: 'stage', 'aria-labelledby': 'motion-title' },
    h('div', { class: 'stage-head' }, h('h2', { id: 'motion-title' }, 'The motion'),
      motion.explanation),
    motion.root, isShort ? null : motion.worst) : null;
  return h('div', { class: view ? 'overview' : 'overview narrow', id: 'overview' }, story, view, problem ? h('p', { class: 'notice' }, problem) : null);
}
