// The sections below the first screen, in their order.

export function sections(_context) {
  return [];
}
