// Numbers as people read them: sensible digits, and units in which soft objects are measured.

export const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);
export const NONE = '–';

const SUPERSCRIPT = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };
const minus = (text) => text.replace(/^-/, '−');

// A number with the given significant digits.
export function number(value, digits = 3) {
  if (!isNumber(value)) return NONE;
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return minus(`${mantissa} × 10${[...String(Number(exponent))].map((c) => SUPERSCRIPT[c]).join('')}`);
  }
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return minus(value.toFixed(Math.min(decimals, 8)));
}

export function fixed(value, decimals) {
  return isNumber(value) ? minus(value.toFixed(decimals)) : NONE;
}

// A length in m, in mm or µm.
export const millimetres = (metres) => (!isNumber(metres) ? NONE : metres !== 0 && Math.abs(metres) < 1e-5 ? `${number(1e6 * metres)} µm` : `${number(1e3 * metres)} mm`);
export const sigmas = (ratio) => (isNumber(ratio) ? `${ratio >= 100 ? ratio.toFixed(0) : ratio.toFixed(1)} σ` : NONE);
export const seconds = (time) => (isNumber(time) ? `${minus(time.toFixed(3))} s` : NONE);

// The same without needless zeros.
export const shortSeconds = (time) => (isNumber(time) ? `${minus(String(Number(time.toFixed(3))))} s` : NONE);

export function percent(share) {
  if (!isNumber(share)) return NONE;
  if (share > 0.995 && share < 1) return '> 99 %';
  if (share > 0 && share < 0.005) return '< 1 %';
  return `${minus((100 * share).toFixed(0))} %`;
}

// The probability of a hypothesis, which is never certain.
export function posterior(probability) {
  return probability > 0.995 ? '> 99 %' : probability < 0.005 ? '< 1 %' : percent(probability);
}

export function probabilityText(p) {
  if (!isNumber(p)) return NONE;
  return p < 0.001 ? 'p < 0.001' : `p = ${number(p, p < 0.01 ? 1 : 2)}`;
}

// The unit and factor in which values of an SI unit up to this size are shown.
export function displayUnit(unit, size) {
  const pick = (...choices) => {
    for (const [name, factor] of choices) if (size * factor >= 1) return { unit: name, factor };
    const [name, factor] = choices[choices.length - 1];
    return { unit: name, factor };
  };
  switch (unit) {
    case 'm': return { unit: 'mm', factor: 1e3 };
    case 'm/s': return { unit: 'mm/s', factor: 1e3 };
    case 'Pa': return pick(['MPa', 1e-6], ['kPa', 1e-3], ['Pa', 1]);
    case 'N': return pick(['N', 1], ['mN', 1e3]);
    case 'N m': case 'N·m': case 'Nm': return pick(['N m', 1], ['mN m', 1e3]);
    case 'W': return pick(['W', 1], ['mW', 1e3]);
    case 'J': return pick(['J', 1], ['mJ', 1e3]);
    case 's': return pick(['s', 1], ['ms', 1e3]);
    case 'kg': return pick(['kg', 1], ['g', 1e3]);
    case 'N/m^3': case 'N/m³': return pick(['kN/m³', 1e-3], ['N/m³', 1]);
    default: return { unit: (unit ?? '').replaceAll('^2', '²').replaceAll('^3', '³').replaceAll('^4', '⁴'), factor: 1 };
  }
}

export function quantity(value, unit, digits = 3) {
  if (!isNumber(value)) return NONE;
  const shown = displayUnit(unit, Math.abs(value));
  return `${number(value * shown.factor, digits)}${shown.unit ? ` ${shown.unit}` : ''}`;
}

// The axis nearest to a direction, and a second one where the direction lies between two.
export function directionText(vector) {
  if (!Array.isArray(vector) || !vector.every(isNumber)) return '';
  const axes = vector.map((value, k) => ({ size: Math.abs(value), name: `${value < 0 ? '−' : '+'}${'xyz'[k]}` }))
    .sort((a, b) => b.size - a.size);
  const length = Math.hypot(...vector);
  if (!(length > 0)) return '';
  return axes[0].size < 0.866 * length ? `${axes[0].name} and ${axes[1].name}` : axes[0].name;
}

// An error relative to the noise.
export const timesNoise = (ratio) => (isNumber(ratio) ? `${ratio >= 100 ? ratio.toFixed(0) : ratio.toFixed(1)} × noise` : NONE);

// "1 frame", "2 frames", "3 patches".
export const counted = (count, thing) => `${count} ${count === 1 ? thing : thing.endsWith('ch') ? `${thing}es` : `${thing}s`}`;
