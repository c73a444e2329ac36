// Numbers for people.
const PREFIXES = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n']];

export function figure(value, unit, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return `0 ${unit}`;
  const [scale, prefix] = PREFIXES.find(([s]) => Math.abs(value) >= s * 0.9999995) ?? PREFIXES.at(-1);
  return `${Number((value / scale).toPrecision(digits))} ${prefix}${unit}`;
}

// Without a prefix, for units that take none.
export function plain(value, unit, digits = 5) {
  return Number.isFinite(value) ? `${Number(value.toPrecision(digits))} ${unit}` : '–';
}
