/**
 * Which actions a few typed letters mean.
 */

export interface Searchable {
  readonly group: string;
  readonly name: string;
  /** Usual other words for it. */
  readonly words?: string;
}

/** Words of a text in small letters, without signs between them. */
export function wordsOf(text: string): readonly string[] {
  return text
    .toLowerCase()
    .split(/[^\p{L}\p{N}]+/u)
    .filter((word) => word !== "");
}

/**
 * Actions of which every typed word is found in the name, the group or the other words, the best first: names that
 * begin with what was typed, then those with words that begin so, then the rest; else in their own order.
 */
export function searchActions<T extends Searchable>(actions: readonly T[], typed: string): readonly T[] {
  const words = typed.toLowerCase().split(/\s+/).filter((word) => word !== "");
  const text = words.join(" ");
  return actions
    .filter((action) => {
      const text = `${action.name} ${action.group} ${action.words ?? ""}`.toLowerCase();
      return words.every((word) => text.includes(word));
    })
    .map((action) => ({ action, rank: rankOf(action.name.toLowerCase(), text, words) }))
    .sort((a, b) => a.rank - b.rank)
    .map(({ action }) => action);
}

function rankOf(name: string, text: string, words: readonly string[]): number {
  if (name.startsWith(text)) {
    return 0;
  }
  const parts = wordsOf(name);
  return words.every((word) => parts.some((part) => part.startsWith(word))) ? 1 : 2;
}
