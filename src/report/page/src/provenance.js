// How the numbers came about: configuration, inputs, versions, seed and commands.
import { h } from './dom.js';
import { name, section, table } from './section.js';

const isObject = (value) => value !== null && typeof value === 'object';

// A collapsible tree of a configuration.
function tree(value, depth) {
  if (!isObject(value)) return h('span', { class: 'leaf' }, name(value === null ? 'null' : value));
  const entries = Object.entries(value);
  const isShort = entries.every(([, one]) => !isObject(one)) && JSON.stringify(value).length < 60 && Array.isArray(value);
  if (isShort) return h('span', { class: 'leaf' }, `[${value.join(', ')}]`);
  return h('ul', { class: 'tree' }, entries.map(([key, one]) => {
    const label = Array.isArray(value) ? `${Number(key) + 1}` : key;
    if (!isObject(one)) return h('li', {}, h('span', { class: 'tree-key' }, name(label)), ' ', tree(one, depth + 1));
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
    table('Inputs', [['file'], ['hash']], Object.entries(provenance.inputs ?? {}).map(([file, hash]) => [name(file), h('code', { class: 'hash' }, String(hash).slice(0, 200))])),
    isObject(provenance.configuration) ? h('div', {}, h('h4', {}, 'Configuration'), tree(provenance.configuration, 0)) : null);
}

export function provenanceSection({ data }) {
  const runs = data.runs ?? [];
  return section('provenance', 'Provenance', 'Provenance', 'What went in, and how to compute it again. The same numbers lie as JSON and CSV in the folder of the run.',
    runs.map((run) => runProvenance(run, runs.length === 1)));
}
