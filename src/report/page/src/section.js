// A section of the page, and parts of it that follow what the reader has chosen.
import { h } from './dom.js';

// Null where there is nothing to show.
export function section(id, short, title, explain, ...children) {
  const shown = children.flat(Infinity).filter(Boolean);
  if (shown.length === 0) return null;
  return { id, short, root: h('section', { class: 'section', id, 'aria-labelledby': `${id}-title` },
    h('div', { class: 'section-head' }, h('h2', { id: `${id}-title` }, title), explain ? h('p', { class: 'explain' }, explain) : null), shown) };
}

// A part that is built again when one of the keys changes, and hidden while it is empty.
export function following(store, keys, build) {
  const root = h('div', { class: 'following' });
  async function update() {
    const token = (root.update = {});
    const children = [await build(store.get())].flat(Infinity).filter(Boolean);
    if (token !== root.update) return;
    root.hidden = children.length === 0;
    root.replaceChildren(...children);
  }
  store.on(keys, update);
  update();
  return root;
}

// Charts beside each other; `size` is '', or 'small' for four in a row.
export const grid = (charts, size = '') => {
  const shown = [charts].flat(Infinity).filter(Boolean);
  return shown.length > 0 ? h('div', { class: `grid ${size}` }, shown) : null;
};

// A table with a caption. Columns are [title, is a number, explanation]; rows are lists of nodes or texts.
export function table(caption, columns, rows, rowClass) {
  if (rows.length === 0) return null;
  return h('div', { class: 'table-box' }, h('table', { class: columns.length > 6 ? 'wide' : null },
    caption ? h('caption', {}, caption) : null,
    h('thead', {}, h('tr', {}, columns.map(([title, isNumber, help]) => h('th', { scope: 'col', class: isNumber ? 'number' : null, title: help }, title)))),
    h('tbody', {}, rows.map((row, r) => h('tr', { class: rowClass?.(r) }, row.map((cell, c) =>
      h(c === 0 ? 'th' : 'td', { scope: c === 0 ? 'row' : null, class: columns[c][1] ? 'number' : null }, cell)))))));
}

// A table of which only the first rows are shown at first, with a button for the others.
export function foldRows(box, fewest, things) {
  const rows = [...(box?.querySelectorAll('tbody tr') ?? [])].slice(fewest);
  if (rows.length < 3) return box;
  const button = h('button', { type: 'button', class: 'more-rows', 'aria-expanded': 'false', onclick: () => show(button.getAttribute('aria-expanded') === 'false') });
  const show = (all) => {
    for (const row of rows) row.hidden = !all;
    button.setAttribute('aria-expanded', String(all));
    button.textContent = all ? `Show fewer ${things}` : `Show ${rows.length} more ${things}`;
  };
  show(false);
  return h('div', { class: 'folded' }, box, button);
}

export const name = (text) => h('span', { class: 'name' }, String(text ?? '').slice(0, 400));
