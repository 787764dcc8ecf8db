/**
 * A language that nobody speaks, made of the catalogue: every text in brackets, with accents and a third longer. What
 * is seen without brackets is in no catalogue, and what does not fit will not fit in German either.
 */
import { pofile } from "wuchale";

/** Its tag is the usual one for English with accents. */
export const pseudo = "en-XA";

const accents = new Map([..."AaCcEeIiNnOoSsUuYyZz"].map((letter, i) => [letter, [..."ÅåÇçÉéÎîÑñÖöŠšÛûÝýŽž"][i]]));

/** A text in it; what is put in ("{0}") and marks of elements ("<0>") stay. */
export function inPseudo(text) {
  const inner = text.replace(/\{\d+\}|<\/?\d+\/?>|./gsu, (part) => accents.get(part) ?? part);
  // the brackets are part of the third
  const { length } = text.replace(/\{\d+\}|<\/?\d+\/?>/g, "");
  const longer = "·".repeat(Math.max(0, Math.round(length * 0.3) - 2));
  return `⟦${inner}${longer}⟧`;
}

/** Keeps the catalogues of all languages but this one, and makes this one of the English. */
export async function withPseudo(options) {
  const locales = options.locales.filter((locale) => locale !== pseudo);
  const kept = await pofile({ dir: options.localesDir })({ ...options, locales });
  return {
    key: kept.key,
    files: kept.files,
    load: async () => {
      const { items, pluralRules } = await kept.load();
      for (const { translations } of items) {
        for (const [locale, forms] of translations) {
          // an empty one is none, and shown in English
          translations.set(locale, forms.every((form) => form === "") ? [] : forms);
        }
        translations.set(pseudo, translations.get("en").map(inPseudo));
      }
      return { items, pluralRules };
    },
    save: (data) => kept.save(data),
  };
}
