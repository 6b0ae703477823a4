// Colour maps that people with colour-vision deficiencies can read, and colours of the theme.

const SEQUENTIAL = ['#440154', '#472d7b', '#3b528b', '#2c728e', '#21918c', '#28ae80', '#5ec962', '#addc30', '#fde725'];
const DIVERGING = ['#16498c', '#4a86c0', '#9cc4e0', '#eef0f2', '#f2b98a', '#cf7434', '#7f3b08'];

const channels = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));

function interpolate(stops, share) {
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(place), stops.length - 2);
  const [a, b] = [channels(stops[k]), channels(stops[k + 1])];
  return a.map((value, c) => Math.round(value + (b[c] - value) * (place - k)));
}

const stopsOf = (diverging) => (diverging ? DIVERGING : SEQUENTIAL);

// 256 RGBA colours from the lowest to the highest value.
export function colourTable(diverging) {
  const table = new Uint8Array(4 * 256);
  for (let k = 0; k < 256; ++k) table.set([...interpolate(stopsOf(diverging), k / 255), 255], 4 * k);
  return table;
}

export const colourGradient = (diverging) => `linear-gradient(to right, ${stopsOf(diverging).join(', ')})`;

// A pale to strong tint of the accent for cells of a matrix, with readable text on it.
export function cellColour(share) {
  const strength = Math.round(100 * Math.min(Math.max(share, 0), 1));
  return { background: `color-mix(in srgb, var(--accent) ${strength}%, transparent)`,
           colour: strength > 55 ? 'var(--on-accent)' : 'var(--text)' };
}

// The colour of a line, a point or an area of the theme in use.
export function themeColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// Colours of models, in their order: the first and the last always differ clearly.
export function modelColourName(index, count) {
  if (index === 0) return 'series-first';
  if (index === count - 1) return 'series-last';
  return `series-${1 + ((index - 1) % 4)}`;
}

const listeners = new Set();
export function onThemeChange(listener) { listeners.add(listener); }
export function changeTheme() { listeners.forEach((call) => call()); }
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', changeTheme);
