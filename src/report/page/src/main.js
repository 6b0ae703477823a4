// Reads the data of the page and builds its sections; a section without data is left out.
import { h } from './dom.js';
import { createStore } from './store.js';
import { choicesOf, Motion } from './motion.js';
import { preparePrinting } from './print.js';
import { modelLabel } from './text.js';
import { lengthOfStory, overview } from './overview.js';
import { sections, lateSections } from './sections.js';

function readData() {
  return JSON.parse(document.getElementById('report-data').textContent);
}

function recordingsOf(choices) {
  return [...new Set(choices.flatMap((choice) => (choice.model.scenes ?? []).map((scene) => scene.recording)))];
}

// The first model and the last one that counts, or those last ones of the first two runs.
function firstChoices(choices, data) {
  const lastOf = (run) => Math.max(0, choices.findLastIndex((choice) => choice.runIndex === run && choice.counts));
  return (data.runs?.length ?? 0) > 1 ? [lastOf(0), lastOf(1)] : [0, lastOf(0)];
}

// The recording in which the first model errs most, among those with held-out frames if there are any.
function firstRecording(choices, recordings) {
  const errors = (part) => (choices[0]?.model.calibration?.recordings ?? []).filter((one) => recordings.includes(one.name) && one[part]?.frames > 0)
    .map((one) => ({ name: one.name, rms: one[part].rms_m })).sort((a, b) => b.rms - a.rms);
  return [...errors('held_out'), ...errors('in_fit')][0]?.name ?? recordings[0] ?? null;
}

async function build(data) {
  const page = document.getElementById('page');
  if (data.title) document.title = `${data.title} – Lacuna report`;
  const choices = choicesOf(data, modelLabel);
  const recordings = recordingsOf(choices);
  const [first, second] = firstChoices(choices, data);
  const store = createStore({ recording: firstRecording(choices, recordings), time: null, point: null, mode: 'both', colouring: 'residual',
                              first, second, isCompared: first !== second });
  let motion = null, problem = null;
  if (recordings.length > 0) {
    try {
      motion = new Motion(store, choices, recordings);
    } catch (error) {
      problem = `The 3D view cannot be shown in this browser: ${error.message}`;
    }
  }
  const context = { data, choices, recordings, store, motion };
  Object.assign(context, lengthOfStory(context));
  const parts = sections(context);
  page.append(
    h('header', { class: 'top' }, h('div', { class: 'inner' },
      h('p', { class: 'brand clip' }, data.program ?? 'Lacuna'),
      h('nav', { 'aria-label': 'Sections' }, h('ul', {}, [['overview', 'Overview'], ...parts.map((part) => [part.id, part.short])]
        .map(([id, title]) => navigationItem(id, title)))))),
    h('main', { id: 'main', tabindex: -1 }, overview(context, problem), parts.map((part) => part.root)),
    h('footer', {}, h('p', {}, `Written by ${data.program ?? 'Lacuna'}. This file needs no network and nothing beside it.`)));
  if (motion) await motion.reload();
  preparePrinting(motion);
  window.lacunaReport = { store, motion };
  await nextFrame();
  document.documentElement.dataset.ready = String(Math.round(performance.now()));
  await addLateSections(context);
  document.documentElement.dataset.complete = String(Math.round(performance.now()));
}

const navigationItem = (id, title) => h('li', {}, h('a', { href: `#${id}` }, title));
const nextFrame = () => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); });

// Sections whose arrays take time to unpack come when the page can be used already.
async function addLateSections(context) {
  for (const { before, part } of await lateSections(context)) {
    const next = document.getElementById(before);
    if (next) next.before(part.root);
    else document.getElementById('main').append(part.root);
    const link = document.querySelector(`nav a[href="#${before}"]`)?.closest('li');
    const item = navigationItem(part.id, part.short);
    if (link) link.before(item);
    else document.querySelector('nav ul').append(item);
  }
}

Promise.resolve().then(() => build(readData())).catch((error) => {
  console.error(error);
  document.getElementById('page').append(h('p', { class: 'notice' }, `This report cannot be shown: ${error.message}`));
});
