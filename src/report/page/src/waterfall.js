// The held-out error of every model that was tried, with the noise as a dashed line.
import { h } from './dom.js';
import { isNumber, millimetres, percent, timesNoise } from './format.js';
import { shortTitle } from './text.js';

const ENDINGS = {
  verdict: 'The search ended: the last verdict names no effect to add.',
  undecided: 'The search ended: the last verdict is ambiguous, and no effect is added by guess.',
  most_effects: 'The search ended: as many effects were added as allowed.',
  not_fitted: 'The search ended: the model with the last effect could not be fitted.',
  may_be_zero: 'The search ended: the 95 % interval of the size of the last effect contains 0, so that the effect does not count.',
  little_gain: 'The search ended: the last effect reduced the error too little.',
};

// One bar for each model, and a pale one for each effect that was tried but is not in a model that counts.
function barsOf(choices, run, titles) {
  const bars = [];
  choices.filter((choice) => choice.run === run).forEach((choice, index, all) => {
    const { model } = choice;
    const before = index > 0 ? all[index - 1].model.errors?.held_out : null;
    if (choice.counts) bars.push({ label: choice.label, error: model.errors?.held_out, ratio: model.errors?.held_out_over_sigma, before, colour: choice.colour });
    else bars.push({ label: `tried: ${titles(model.added)}`, error: model.errors?.held_out, note: 'size may be 0', isTried: true });
    const added = all[index + 1]?.model.added;
    for (const effect of model.diagnosis?.ranking ?? []) {
      if (effect.refit && !effect.refit.message && effect.effect !== added) {
        bars.push({ label: `tried: ${titles(effect.effect)}`, error: effect.refit.held_out_rms_m, isTried: true });
      }
    }
  });
  return bars.filter((bar) => isNumber(bar.error));
}

// How far the error fell: in the fall where there is room for it, else behind the bar.
function fallOf(bar, share) {
  if (!(isNumber(bar.before) && bar.before > 0)) return null;
  const text = `${bar.error < bar.before ? '−' : '+'}${percent(Math.abs(1 - bar.error / bar.before))}`;
  const fell = bar.before > bar.error;
  const from = fell ? bar.before - bar.error > 0.25 * share.largest ? bar.error : bar.before : bar.error;
  return [fell ? h('div', { class: 'bar-fall', style: { left: share(bar.error), width: share(bar.before - bar.error) } }) : null,
    h('span', { class: `fall${from > 0.8 * share.largest ? ' at-end' : ''}`, style: { left: share(from) } }, text)];
}

function barRow(bar, noise, share) {
  const exceeds = bar.error > share.largest;
  return h('div', { class: `bar-row${bar.isTried ? ' tried' : ''}`, role: 'listitem' },
    h('span', { class: 'bar-label', title: bar.label.slice(0, 300) }, bar.label),
    h('div', { class: 'bar-track' },
      h('div', { class: `bar-fill${exceeds ? ' exceeds' : ''}`, style: { width: share(Math.min(bar.error, share.largest)), background: bar.isTried ? null : `var(--${bar.colour})` } }),
      fallOf(bar, share),
      isNumber(noise) && noise > 0 ? h('div', { class: 'bar-noise', style: { left: share(noise) } }) : null),
    h('span', { class: 'bar-value' }, h('strong', {}, millimetres(bar.error)),
      isNumber(bar.ratio) && bar.ratio > 0 ? h('span', { class: 'muted' }, ` ${timesNoise(bar.ratio)}`) : null,
      bar.note ? h('span', { class: 'muted' }, ` ${bar.note}`) : null));
}

export function waterfall(choices, runs) {
  const ranked = choices.flatMap((choice) => choice.model.diagnosis?.ranking ?? []);
  const title = (name) => shortTitle(ranked.find((effect) => effect.effect === name)?.title ?? name);
  const groups = runs.map((run) => ({ run, bars: barsOf(choices, run, title), noise: run.noise })).filter((group) => group.bars.length > 0);
  if (groups.length === 0) return null;
  // The scale is that of the models; the bar of a worse one that was only tried is cut off.
  const errors = groups.flatMap((group) => group.bars.filter((bar) => !bar.isTried).map((bar) => bar.error));
  const largest = Math.max(...errors, ...groups.map((group) => group.noise ?? 0)) || 1;
  const share = (length) => `${(100 * length) / largest}%`;
  share.largest = largest;
  const isHeldOut = groups.some(({ run }) => run.models.some((model) => model.errors && model.errors.has_held_out !== false));
  const hasNoise = groups.some((group) => isNumber(group.noise) && group.noise > 0);
  const endings = [...new Set(groups.map(({ run }) => ENDINGS[run.ledger?.ending?.reason]).filter(Boolean))];
  return h('figure', { class: 'waterfall' },
    h('figcaption', {}, h('h2', {}, `Error of each model on ${isHeldOut ? 'held-out' : 'fitted'} frames`),
      h('p', { class: 'explain' }, isHeldOut ? 'Rms distance from the measurement in frames that no parameter was fitted to.'
        : 'Rms distance from the measurement. Nothing was held out, so that a new recording would show a larger error.',
        hasNoise ? ' At the dashed line, a model is as good as the measurement allows.' : '')),
    groups.map(({ run, bars, noise }) => h('div', { class: 'bars', role: 'list', 'aria-label': `Errors of ${run.name ?? 'the run'}` },
      bars.map((bar) => barRow(bar, noise, share)))),
    hasNoise ? h('p', { class: 'key' }, h('span', { class: 'key-noise', 'aria-hidden': 'true' }), `noise of the measurement, ${millimetres(groups.find((group) => group.noise).noise)}`) : null,
    endings.map((text) => h('p', { class: 'explain' }, text)));
}
