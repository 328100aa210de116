// Numbers as people read them: round ticks, SI prefixes, no trailing noise.

const PREFIXES = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n']];
const PREFIXABLE = new Set(['Pa', 'N', 'J', 'm', 's', 'W', 'm/s', 'Hz', 'N/m']);
const SUPERSCRIPT = '⁰¹²³⁴⁵⁶⁷⁸⁹';

const superscript = (n) => (n < 0 ? '⁻' : '') + [...String(Math.abs(n))].map((d) => SUPERSCRIPT[d]).join('');

/** How to show values up to this magnitude: multiply by factor and write unit after them. */
export function unitScale(magnitude, unit) {
  if (!(magnitude > 0) || !Number.isFinite(magnitude)) return { factor: 1, unit };
  if (PREFIXABLE.has(unit)) {
    const [size, prefix] = PREFIXES.find(([s]) => magnitude >= 0.9995 * s) ?? PREFIXES.at(-1);
    return { factor: 1 / size, unit: prefix + unit };
  }
  // Volumes of soft chambers are read in milliliters.
  if (unit === 'm³' || unit === 'm^3') {
    if (magnitude < 1e-6) return { factor: 1e9, unit: 'mm³' };
    if (magnitude < 1e-3) return { factor: 1e6, unit: 'mL' };
    return { factor: 1, unit: 'm³' };
  }
  if (magnitude >= 1e5 || magnitude < 1e-3) {
    const power = Math.floor(Math.log10(magnitude));
    return { factor: 10 ** -power, unit: `×10${superscript(power)}${unit ? ` ${unit}` : ''}` };
  }
  return { factor: 1, unit };
}

/** Round ticks inside [low, high], about `wanted` of them, and the decimals they need. */
export function niceTicks(low, high, wanted = 6) {
  const span = high - low;
  if (!(span > 0)) return { ticks: [low], decimals: 3 };
  const raw = span / wanted;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].find((m) => m * power >= raw * 0.999) * power;
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * span; ++k) ticks.push(k * step);
  const decimals = Math.min(12, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)
    + (Math.abs(step / power - 2.5) < 1e-6 ? 1 : 0)));
  return { ticks, decimals };
}

const MINUS = '\u2212';

export function fixed(value, decimals) {
  const text = Math.abs(value) < 0.5 * 10 ** -decimals ? (0).toFixed(decimals) : value.toFixed(decimals);
  return text.replace('-', MINUS);
}

/** A value with so many significant digits. */
export function significant(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return 'not a number';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) {
    const [mantissa, power] = value.toExponential(digits - 1).split('e');
    const shown = String(Number(mantissa)).replace('-', MINUS);
    return `${shown === '1' ? '' : shown === `${MINUS}1` ? MINUS : `${shown}×`}10${superscript(Number(power))}`;
  }
  return String(Number(value.toPrecision(digits))).replace('-', MINUS);
}
