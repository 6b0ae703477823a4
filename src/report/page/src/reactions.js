// The forces and torques that load cells measured on grips, beside what the models predict: over
// time, and over the motion of the grip.
import { chart, sharedLegend } from './chart.js';
import { h } from './dom.js';
import { displayUnit, isNumber, quantity } from './format.js';
import { sceneOf } from './motion.js';
import { grid } from './section.js';
import { heldOutSpans } from './timeline.js';

const MOTIONS = {
  force: { title: 'Load against displacement', x: 'displacement, mm', factor: 1e3 },
  torque: { title: 'Torque against rotation', x: 'rotation, °', factor: 180 / Math.PI },
};
const componentOf = (curve) => (curve.component === 'along' ? 'along its axis' : curve.component);
const times = (values, factor) => Array.from(values ?? [], (value) => (isNumber(value) ? factor * value : NaN));

// The values of the fitted frames, or of those that were held out; NaN elsewhere. A line also has the
// last frame before each held-out one, so that its two parts meet.
function partOf(curve, values, isFitted, isLine) {
  const { fitted = [] } = curve;
  const belongs = (k) => (fitted[k] !== false) === isFitted || (isLine && !isFitted && fitted[k + 1] === false);
  return values.map((value, k) => (belongs(k) ? value : NaN));
}

const isHeldOut = (curve) => (curve.fitted ?? []).includes(false);

// What the charts of one reading have in common, for the legend.
function legendOf(curves) {
  const withHeldOut = curves.some(({ curve }) => isHeldOut(curve) && curve.motion);
  const pair = (one, change) => (withHeldOut ? [one, { ...one, ...change, label: `${one.label}, held out` }] : [one]);
  const models = [...new Map(curves.map(({ choice }) => [choice.label, choice])).values()];
  return [...pair({ label: 'measured', colour: 'measured', style: 'dots' }, { hollow: true }),
    ...models.flatMap((choice) => pair({ label: choice.label, colour: choice.colour }, { dash: true }))];
}

function overTime(curves, shown, store) {
  const first = curves[0].curve;
  return chart({ title: `${componentOf(first)}, over time`, store, legend: false, height: 220, axisSize: 58, includesZero: false,
    x: 'time, s', y: `${first.quantity}, ${shown.unit}`, spans: heldOutSpans(first.time_s, first.fitted),
    series: [{ label: 'measured', x: first.time_s, y: times(first.measured, shown.factor), colour: 'measured', style: 'dots', size: 4 },
      ...curves.map(({ choice, curve }) => ({ label: choice.label, x: curve.time_s, y: times(curve.model, shown.factor), colour: choice.colour }))] });
}

// The abscissa may go back and forth, so that the curves are drawn in the order of time.
function overMotion(curves, shown) {
  const first = curves[0].curve;
  const motion = MOTIONS[first.quantity];
  if (!first.motion || !motion) return null;
  const both = (label, curve, values, style) => [true, false].map((isFitted) => ({ ...style, inOrder: true, hollow: !isFitted, dash: !isFitted,
    label: isFitted ? label : `${label}, held out`, x: times(curve.motion, motion.factor), y: partOf(curve, times(values, shown.factor), isFitted, style.style !== 'dots') }));
  return chart({ title: `${motion.title}, ${componentOf(first)}`, legend: false, height: 240, axisSize: 58, includesZero: false,
    x: motion.x, y: `${first.quantity}, ${shown.unit}`,
    series: [...both('measured', first, first.measured, { colour: 'measured', style: 'dots', size: 5 }),
      ...curves.filter(({ curve }) => curve.motion).flatMap(({ choice, curve }) => both(choice.label, curve, curve.model, { colour: choice.colour }))] });
}

export const hasReactions = (scenes) => scenes.some((scene) => scene.reactions?.length > 0);

// One block for each reading, with its components.
export function reactionPlots({ choices, store }, state) {
  const readings = new Map();
  for (const choice of choices) {
    for (const curve of sceneOf(choice, state.recording)?.reactions ?? []) {
      const components = readings.get(curve.reading) ?? new Map();
      readings.set(curve.reading, components.set(curve.component, [...(components.get(curve.component) ?? []), { choice, curve }]));
    }
  }
  return [...readings.values()].map((components) => {
    const curves = [...components.values()];
    const { curve: first } = curves[0][0];
    const values = curves.flat().flatMap(({ curve }) => [...(curve.measured ?? []), ...(curve.model ?? [])]).filter(isNumber);
    const shown = displayUnit(first.unit, values.reduce((largest, value) => Math.max(largest, Math.abs(value)), 0));
    const charts = grid([...curves.map((one) => overTime(one, shown, store)), ...curves.map((one) => overMotion(one, shown))]);
    if (!charts) return null;
    const name = first.quantity === 'torque' ? 'Torque' : 'Force';
    const explain = `The ${first.quantity} that the grip exerts. Dots are the readings of the load cell (σ = ${quantity(first.sigma, first.unit, 2)}), lines what each model predicts that it reads, with its offset (tare) and delay.`
      + (curves.flat().some(({ curve }) => isHeldOut(curve)) ? ' Frames that were held out are shaded; over the motion, their readings are open circles and their predictions dashed.' : '');
    return h('div', { class: 'block' }, h('div', { class: 'block-head' }, h('h3', {}, `${name} on ${String(first.grip).slice(0, 80)}`), h('p', { class: 'explain' }, explain)),
      sharedLegend(legendOf(curves.flat())), charts);
  }).filter(Boolean);
}
