/** What of a source file comes into the catalogue, and that what does not stays as it is. */
import { expect, test } from "vitest";
import { IndexTracker } from "wuchale";
import { chosenLanguage } from "../../src/texts/page.loader";
import { inPseudo } from "../../texts/pseudo.js";
import { transform } from "../../texts/transformer.js";

async function textsOf(content: string, filename = "some.ts"): Promise<string[]> {
  const given = { content, filename, index: new IndexTracker(), expr: { plain: "load()", reactive: "load()" } };
  const { msgs } = await transform({ ...given, matchUrl: () => null });
  return msgs.flatMap(({ msgStr }) => msgStr);
}

test("texts of tables, of what is thrown and of fields of classes are found", async () => {
  expect(await textsOf('export const tools = [{ kind: "drill", name: "Drill", does: "removes" }];')).toEqual([
    "Drill",
    "removes",
  ]);
  expect(await textsOf('throw new RangeError("no room for it");')).toEqual(["no room for it"]);
  expect(await textsOf('class A { hint = (n: number) => `Press on ${n} to touch it`; }')).toEqual([
    "Press on {0} to touch it",
  ]);
});

test("a sentence in pieces is one text", async () => {
  const code = 'const long = "It is so, " +\n  `with ${count} of them, ` +\n  "in a line of its own.";';
  expect(await textsOf(code)).toEqual(["It is so, with {0} of them, in a line of its own."]);
});

test("names of the protocol, keys, selectors and units are none", async () => {
  const code = `
    send({ type: "change_shape", kind: "keep-largest" });
    if (event.key === "Delete" || kind === "Open") document.querySelector(".left .threshold");
    formatFixed(depth, 1, "mm"); const keys = ["Ctrl+Shift+Z", "Escape"]; remember("shape", {});
    const place = { at: "header, .views", unit: "g/cm³" };`;
  expect(await textsOf(code)).toEqual([]);
});

test("markup, and attributes that are read, are found; classes and ids are not", async () => {
  const code =
    '<button class="framed big" id="the-one" title="Undo it (Ctrl+Z)">Undo <kbd>Z</kbd> {on ? "now" : ""}</button>';
  expect((await textsOf(code, "some.svelte")).sort()).toEqual(["Undo <0/> {0}", "Undo it (Ctrl+Z)", "now"]);
});

test("a number and its word have all forms in the catalogue", async () => {
  expect(await textsOf('plural(count, ["seed", "seeds"]);')).toEqual(["seed", "seeds"]);
});

test("a place that says so makes small words texts", async () => {
  expect(await textsOf('// @texts\nconst names = { L: "left" };')).toEqual(["left"]);
  expect(await textsOf('const names = { L: "left" };')).toEqual([]);
});

test("the first language that there is is taken, English as any other", () => {
  expect(chosenLanguage(["fr", "de-AT", "en"], ["de"])).toBe("de");
  expect(chosenLanguage(["en-GB", "de"], ["de", "en-XA"])).toBe("en");
  expect(chosenLanguage(["pt-BR"], ["pt-BR", "pt"])).toBe("pt-BR");
  expect(chosenLanguage(["xx"], ["de"])).toBe("en");
});

test("the language of brackets keeps what is put in", () => {
  expect(inPseudo("Undo {0} of <0>all</0>")).toBe("⟦Ûñdö {0} öf <0>åll</0>··⟧");
});
