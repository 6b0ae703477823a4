// The held-out error of every model that was tried, with the noise as a dashed line.
import { h } from './dom.js';
import { isNumber, millimetres, percent, sigmas } from './format.js';

const ENDINGS = {
  verdict: 'The search ended: the last verdict names no effect to add.',
  undecided: 'The search ended: the last verdict is ambiguous, and no effect is added by guess.',
  most_effects: 'The search ended: as many effects were added as allowed.',
  not_fitted: 'The search ended: the model with the last effect could not be fitted.',
  may_be_zero: 'The search ended: the size of the last effect may be zero, so that the effect does not count.',
  little_gain: 'The search ended: the last effect reduced the error too little.',
};

// One bar for each model, and a pale one for each effect that was tried with it but not added.
function barsOf(choices, run) {
  const bars = [];
  choices.filter((choice) => choice.run === run).forEach((choice, index, all) => {
    const { model } = choice;
    const before = index > 0 ? all[index - 1].model.errors?.held_out : null;
    bars.push({ label: choice.label, error: model.errors?.held_out, ratio: model.errors?.held_out_over_sigma, before, colour: choice.colour });
    const added = all[index + 1]?.model.added;
    for (const effect of model.diagnosis?.ranking ?? []) {
      if (effect.refit && !effect.refit.message && effect.effect !== added) {
        bars.push({ label: `tried: ${effect.effect}`, error: effect.refit.held_out_rms_m, ratio: null, isTried: true });
      }
    }
  });
  return bars.filter((bar) => isNumber(bar.error));
}

export function waterfall(choices, runs) {
  const groups = runs.map((run) => ({ run, bars: barsOf(choices, run), noise: run.noise })).filter((group) => group.bars.length > 0);
  if (groups.length === 0) return null;
  const largest = Math.max(...groups.flatMap((group) => [...group.bars.map((bar) => bar.error), group.noise ?? 0])) || 1;
  const share = (length) => `${(100 * length) / largest}%`;
  const isHeldOut = groups.some(({ run }) => run.models.some((model) => model.errors && model.errors.has_held_out !== false));
  const hasNoise = groups.some((group) => isNumber(group.noise) && group.noise > 0);
  return h('figure', { class: 'waterfall' },
    h('figcaption', {}, h('h2', {}, `Error of each model on ${isHeldOut ? 'held-out' : 'fitted'} frames`),
      h('p', { class: 'explain' }, isHeldOut ? 'The rms distance of prediction and measurement in frames that no parameter was fitted to.'
        : 'The rms distance of prediction and measurement. Nothing was held out, so that a new recording would show a larger error.',
        hasNoise ? ' A model whose bar ends at the dashed line is as good as the measurement allows.' : '')),
    groups.map(({ run, bars, noise }) => h('div', { class: 'bars', role: 'list', 'aria-label': `Errors of ${run.name ?? 'the run'}` },
      bars.map((bar) => h('div', { class: `bar-row${bar.isTried ? ' tried' : ''}`, role: 'listitem' },
        h('span', { class: 'bar-label', title: bar.label.slice(0, 300) }, bar.label),
        h('div', { class: 'bar-track' },
          isNumber(bar.before) && bar.before > bar.error ? h('div', { class: 'bar-fall', style: { left: share(bar.error), width: share(bar.before - bar.error) } }) : null,
          h('div', { class: 'bar-fill', style: { width: share(bar.error), background: bar.isTried ? null : `var(--${bar.colour})` } }),
          isNumber(noise) && noise > 0 ? h('div', { class: 'bar-noise', style: { left: share(noise) } }) : null),
        h('span', { class: 'bar-value' }, h('strong', {}, millimetres(bar.error)),
          isNumber(bar.ratio) && bar.ratio > 0 ? h('span', { class: 'muted' }, ` ${sigmas(bar.ratio)}`) : null,
          isNumber(bar.before) && bar.before > 0 ? h('span', { class: 'fall' }, ` ${bar.error < bar.before ? '−' : '+'}${percent(Math.abs(1 - bar.error / bar.before))}`) : null)))),
    ),
    hasNoise ? h('p', { class: 'key' }, h('span', { class: 'key-noise', 'aria-hidden': 'true' }), `noise of the measurement, ${millimetres(groups.find((group) => group.noise).noise)}`) : null,
    groups.map(({ run }) => ENDINGS[run.ledger?.ending?.reason]).filter(Boolean).map((sentence) => h('p', { class: 'explain' }, sentence)));
}
