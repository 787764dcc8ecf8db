/**
 * Which actions a few typed letters mean.
 */

export interface Searchable {
  readonly group: string;
  readonly name: string;
}

/**
 * Actions of which every typed word is found in the name or the group, the best first: names that begin
 * with what was typed, then those with words that begin so, then the rest; else in their own order.
 */
export function searchActions<T extends Searchable>(actions: readonly T[], typed: string): readonly T[] {
  const words = typed.toLowerCase().split(/\s+/).filter((word) => word !== "");
  const text = words.join(" ");
  return actions
    .filter(({ group, name }) => words.every((word) => `${name} ${group}`.toLowerCase().includes(word)))
    .map((action) => ({ action, rank: rankOf(action.name.toLowerCase(), text, words) }))
    .sort((a, b) => a.rank - b.rank)
    .map(({ action }) => action);
}

function rankOf(name: string, text: string, words: readonly string[]): number {
  if (name.startsWith(text)) {
    return 0;
  }
  const parts = name.split(/[^\p{L}\p{N}]+/u);
  return words.every((word) => parts.some((part) => part.startsWith(word))) ? 1 : 2;
}
