/**
 * The page's texts in one language, chosen once before the page is read. English is there at once; another is loaded.
 * Built from the catalogues beside this file; where nothing was built, as in the tests, texts are those in the code.
 */
import toRuntime, { type CatalogModule } from "wuchale/runtime";

const english = import.meta.glob<CatalogModule>("./.wuchale/page.page.en.compiled.js", { eager: true });
const others = import.meta.glob<CatalogModule>(
  ["./.wuchale/page.page.*.compiled.js", "!./.wuchale/page.page.en.compiled.js"],
);
const loaders = new Map(
  Object.entries(others).map(([path, load]) => [/page\.page\.(.+)\.compiled\.js$/.exec(path)?.[1] ?? "", load]),
);

const catalogue: CatalogModule = { c: [], ...Object.values(english)[0] };
const runtime = toRuntime(catalogue);

/** Where built code gets its texts. */
export const getRuntime = (): typeof runtime => runtime;
export const getRuntimeRx = getRuntime;

/** Loads the first of these languages that there is, and returns it; English where there is none. */
export async function loadLanguage(wanted: readonly string[]): Promise<string> {
  const language = chosenLanguage(wanted, [...loaders.keys()]);
  const load = loaders.get(language);
  if (load === undefined) {
    return "en";
  }
  const { c, p } = await load();
  Object.assign(catalogue, { c, p });
  return language;
}

/**
 * The first wanted language, as tags of BCP 47, that is English or among others: "de-AT" is "de" where that stands
 * alone. A tag with a private region such as en-XA is no wish for English, and comes only where it is wanted itself.
 */
export function chosenLanguage(wanted: readonly string[], others: readonly string[]): string {
  for (const tag of wanted) {
    const found = [tag, tag.split("-")[0] ?? tag].find((each) => each === "en" || others.includes(each));
    if (found !== undefined) {
      return found;
    }
  }
  return "en";
}
