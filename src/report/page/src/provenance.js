// How the numbers came about: configuration, inputs, versions, seed and commands.
import { h } from './dom.js';
import { foldRows, name, section, table } from './section.js';

const isObject = (value) => value !== null && typeof value === 'object';

// A collapsible tree of a configuration.
function tree(value, depth) {
  if (!isObject(value)) return h('span', { class: 'leaf' }, name(value === null || value === '' ? '–' : typeof value === 'number' ? Number(value.toPrecision(6)) : value));
  const entries = Object.entries(value);
  if (entries.length === 0) return h('span', { class: 'leaf' }, 'none');
  const isShort = entries.every(([, one]) => !isObject(one)) && JSON.stringify(value).length < 60 && Array.isArray(value);
  if (isShort) return h('span', { class: 'leaf' }, `[${value.join(', ')}]`);
  return h('ul', { class: 'tree' }, entries.map(([key, one]) => {
    const label = Array.isArray(value) ? `${Number(key) + 1}` : key;
    if (!isObject(one) || Object.keys(one).length === 0) return h('li', {}, h('span', { class: 'tree-key' }, name(label)), ' ', tree(one, depth + 1));
    return h('li', {}, h('details', { open: depth < 1 }, h('summary', {}, h('span', { class: 'tree-key' }, name(label))), tree(one, depth + 1)));
  }));
}

function runProvenance(run, isOnly) {
  const { provenance } = run;
  if (!provenance) return null;
  const facts = [['program', provenance.program], ['seed', provenance.seed], ['folder', run.folder], ['kind', run.kind], ...Object.entries(provenance.libraries ?? {})]
    .filter(([, value]) => value !== null && value !== undefined && value !== '');
  return h('div', { class: 'block' }, isOnly ? null : h('h3', {}, name(run.name)),
    facts.length > 0 ? h('dl', { class: 'facts' }, facts.map(([key, value]) => h('div', {}, h('dt', {}, name(key)), h('dd', {}, name(value))))) : null,
    provenance.commands?.length ? h('div', {}, h('h4', {}, 'Commands that reproduce it'), h('pre', { tabindex: 0, 'aria-label': 'Commands' }, provenance.commands.join('\n').slice(0, 5000))) : null,
    foldRows(table('Inputs', [['file'], ['hash']], Object.entries(provenance.inputs ?? {}).map(([file, hash]) => [name(file), h('code', { class: 'hash' }, String(hash).slice(0, 200))])), 10, 'files'),
    isObject(provenance.configuration) ? h('div', {}, h('h4', {}, 'Configuration, in SI units'), tree(provenance.configuration, 0)) : null);
}

export function provenanceSection({ data }) {
  const runs = data.runs ?? [];
  return section('provenance', 'Provenance', 'Provenance', 'What went in, and how to compute it again. The numbers of this page lie beside it as JSON, those of the run in its folder as JSON and CSV.',
    runs.map((run) => runProvenance(run, runs.length === 1)));
}
