/* Numbers as people read them: three digits, and a unit of a fitting size. */
const times = [[1, 's'], [1e-3, 'ms'], [1e-6, 'µs'], [1e-9, 'ns']];

export function digits(value, count = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size === 0) return '0';
  if (size < 1e-3 || size >= 99999.5) return value.toExponential(count - 1).replace('e+', 'e').replace(/\.?0+e/, 'e');
  return String(Number(value.toPrecision(count)));
}

export function number(value, unit = '') {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (unit === 's' && value !== 0) {
    const [factor, name] = times.find(([f]) => Math.abs(value) >= 0.9995 * f) ?? times[3];
    return `${digits(value / factor)} ${name}`;
  }
  return unit === '' || unit === '1' ? digits(value) : `${digits(value)} ${unit}`;
}

export const plural = (count, word) => `${count} ${word}${count === 1 ? '' : 's'}`;
export const slug = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, '-').slice(0, 60);
