// Builds elements. Text becomes text nodes, so that nothing from the data is parsed as HTML.

function append(parent, children) {
  for (const child of children.flat(Infinity)) {
    if (child === null || child === undefined || child === false) continue;
    parent.append(child instanceof Node ? child : document.createTextNode(String(child)));
  }
  return parent;
}

function setProperties(node, properties) {
  for (const [key, value] of Object.entries(properties)) {
    if (value === null || value === undefined || value === false) continue;
    if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
    else if (key === 'style') for (const [name, one] of Object.entries(value)) node.style.setProperty(name, one);
    else if (key === 'class') node.setAttribute('class', value);
    else node.setAttribute(key, value === true ? '' : String(value));
  }
  return node;
}

export function h(tag, properties = {}, ...children) {
  return append(setProperties(document.createElement(tag), properties), children);
}

export function svg(tag, properties = {}, ...children) {
  return append(setProperties(document.createElementNS('http://www.w3.org/2000/svg', tag), properties), children);
}

let lastId = 0;
export const newId = (prefix) => `${prefix}-${++lastId}`;

// A select with a label. Options are [value, text].
export function labelledSelect(label, options, value, onChange) {
  const id = newId('select');
  const select = h('select', { id, onchange: () => onChange(select.value) },
    options.map(([key, text]) => h('option', { value: key }, text)));
  select.value = value;
  return { root: h('div', { class: 'control' }, h('label', { for: id }, label), select), select };
}

// Buttons of which exactly one is pressed. Options are [value, text].
export function segmented(label, options, value, onChange) {
  const buttons = options.map(([key, text]) =>
    h('button', { type: 'button', 'aria-pressed': String(key === value), 'data-value': key, onclick: () => set(key, true) }, text));
  function set(key, notify) {
    for (const button of buttons) button.setAttribute('aria-pressed', String(button.dataset.value === key));
    if (notify) onChange(key);
  }
  return { root: h('div', { class: 'segmented', role: 'group', 'aria-label': label }, buttons), set };
}
