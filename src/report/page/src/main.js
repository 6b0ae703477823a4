// Reads the data of the page and builds its sections; a section without data is left out.
import { h } from './dom.js';
import { createStore } from './store.js';
import { choicesOf, Motion } from './motion.js';
import { modelLabel } from './text.js';
import { overview } from './overview.js';
import { sections } from './sections.js';

function readData() {
  return JSON.parse(document.getElementById('report-data').textContent);
}

function recordingsOf(choices) {
  return [...new Set(choices.flatMap((choice) => (choice.model.scenes ?? []).map((scene) => scene.recording)))];
}

// The first model and the last one, or the last ones of the first two runs.
function firstChoices(choices, data) {
  if ((data.runs?.length ?? 0) > 1) {
    const lastOf = (run) => choices.findLastIndex((choice) => choice.runIndex === run);
    return [Math.max(0, lastOf(0)), Math.max(0, lastOf(1))];
  }
  return [0, Math.max(0, choices.length - 1)];
}

async function build(data) {
  const page = document.getElementById('page');
  if (data.title) document.title = `${data.title} – Lacuna report`;
  const choices = choicesOf(data, modelLabel);
  const recordings = recordingsOf(choices);
  const [first, second] = firstChoices(choices, data);
  const store = createStore({ recording: recordings[0] ?? null, time: null, point: null, mode: 'both', colouring: 'residual',
                              first, second, isCompared: choices.length > 1 });
  let motion = null, problem = null;
  if (recordings.length > 0) {
    try {
      motion = new Motion(store, choices, recordings);
    } catch (error) {
      problem = `The 3D view cannot be shown in this browser: ${error.message}`;
    }
  }
  const context = { data, choices, recordings, store, motion };
  const parts = sections(context);
  page.append(
    h('header', { class: 'top' }, h('div', { class: 'inner' },
      h('p', { class: 'brand' }, data.program ?? 'Lacuna'),
      h('nav', { 'aria-label': 'Sections' }, h('ul', {}, [['overview', 'Overview'], ...parts.map((part) => [part.id, part.short])]
        .map(([id, title]) => h('li', {}, h('a', { href: `#${id}` }, title))))))),
    h('main', { id: 'main', tabindex: -1 }, overview(context, problem), parts.map((part) => part.root)),
    h('footer', {}, h('p', {}, `Written by ${data.program ?? 'Lacuna'}. This file needs no network and nothing beside it.`)));
  if (motion) await motion.reload();
  window.lacunaReport = { store, motion };
  requestAnimationFrame(() => requestAnimationFrame(() => { document.documentElement.dataset.ready = String(Math.round(performance.now())); }));
}

try {
  build(readData());
} catch (error) {
  document.getElementById('page').append(h('p', { class: 'notice' }, `The data of this report cannot be read: ${error.message}`));
}
