// Several runs: what differs in their configuration, and their errors side by side.
import { millimetres, sigmas } from './format.js';
import { name, section, table } from './section.js';
import { h } from './dom.js';

export function runsSection({ data, choices }) {
  const runs = data.runs ?? [];
  if (runs.length < 2) return null;
  const differences = table('What differs in the configuration', [['key'], ...runs.map((run) => [String(run.name ?? '').slice(0, 60)])],
    (data.differences ?? []).map((one) => [h('code', {}, name(one.key)), ...runs.map((_, k) => name(one.values?.[k] ?? '–'))]));
  const metrics = table('Errors', [['run and model'], ['fitted', true], ['held out', true], ['held out / σ', true], ['noise', true]],
    choices.filter((choice) => choice.model.errors).map((choice) => [name(choice.label), millimetres(choice.model.errors.in_fit), millimetres(choice.model.errors.held_out), sigmas(choice.model.errors.held_out_over_sigma), millimetres(choice.run.noise)]));
  return section('runs', 'Runs', 'The runs compared', 'What differs between the runs, and how well each predicts. The 3D views above share one camera.', differences, metrics);
}
