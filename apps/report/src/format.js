// Numbers as text.

const finite = (x) => typeof x === 'number' && Number.isFinite(x);

/** Decimals that show two significant digits of the error. */
function decimalsOf(error) {
  return Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(error))));
}

/** {value, error} as texts, the error with two significant digits; null for a missing value. */
export function estimate(value, error) {
  if (!finite(value)) return null;
  if (!finite(error)) return { value: short(value), error: '' };
  if (error <= 1e-10 * Math.abs(value)) return { value: short(value), error: '' };
  const decimals = Math.min(decimalsOf(error), decimalsOf(Number(error.toFixed(decimalsOf(error)))));
  return { value: minus(value.toFixed(decimals)), error: error.toFixed(decimals) };
}

/** Five significant digits. */
export function short(x, digits = 5) {
  if (!finite(x)) return 'none';
  if (x === 0) return '0';
  const size = Math.abs(x);
  if (size < 1e-4 || size >= 1e7) {
    const [mantissa, exponent] = x.toExponential(Math.max(0, digits - 3)).split('e');
    return `${minus(String(Number(mantissa)))}·10${superscript(Number(exponent))}`;
  }
  return minus(String(Number(x.toPrecision(digits))));
}

/** 1,234,567 */
export function grouped(n) {
  return finite(n) ? minus(n.toLocaleString('en-US', { maximumFractionDigits: 3 })) : 'none';
}

export function superscript(n) {
  const digits = '⁰¹²³⁴⁵⁶⁷⁸⁹';
  return [...String(n)].map((c) => (c === '-' ? '⁻' : digits[Number(c)])).join('');
}

function minus(text) {
  return text.replace('-', '−');
}

/** "l sqrt(m/kT)" of a CSV header as it is printed. */
export function unitText(unit) {
  if (!unit || unit === '1') return '';
  return unit.replace(/sqrt\(/g, '√(').replace(/\^2/g, '²').replace(/\^3/g, '³');
}

export function duration(seconds) {
  if (!finite(seconds)) return 'none';
  if (seconds < 120) return `${short(seconds, 3)} s`;
  if (seconds < 7200) return `${short(seconds / 60, 3)} min`;
  return `${short(seconds / 3600, 3)} h`;
}

export function bytes(n) {
  if (!finite(n)) return 'none';
  return n < 1e9 ? `${short(n / 1e6, 3)} MB` : `${short(n / 1e9, 3)} GB`;
}
