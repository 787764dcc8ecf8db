/**
 * Takes the texts out of one source file and puts their translations in: wuchale's own way for Svelte, prepared, and
 * with what it leaves out of the language. Texts of this page never change while it is shown, so that nothing of its
 * code becomes reactive by them.
 */
import { getKey } from "wuchale";
import { pluralPattern } from "wuchale/adapter-vanilla";
// its package names no way to it
import { SvelteTransformer } from "../node_modules/@wuchale/svelte/dist/transformer.js";
import { prepare, withoutMarks } from "./prepare.js";
import { isReadAttribute, isReadText } from "./rules.js";

const asIs = { wrapInit: (expression) => expression, wrapUse: (expression) => expression };

/** Where code gets its texts: once for each file. */
export const runtime = {
  initReactive: ({ funcName }) => (funcName === undefined ? false : null),
  useReactive: false,
  plain: asIs,
  reactive: asIs,
};

/** What of the markup is read; strings of code are marked. */
function heuristic({ msgStr, details: { scope, attribute } }) {
  const read = scope === "markup" ? isReadText(msgStr.join(" ")) : scope === "attribute" && isReadAttribute(attribute);
  return read ? "message" : false;
}

class PageTransformer extends SvelteTransformer {
  constructor(content, { filename, index, expr, matchUrl }) {
    super(content, filename, index, heuristic, [pluralPattern], expr, runtime, matchUrl);
    this.visitVariableDeclarator = this.defaultVisitVariableDeclarator;
    const visitClass = this.visitClassDeclaration;
    this.visitClassDeclaration = (node) => [
      ...visitClass(node),
      ...node.body.body
        .filter(({ type, value }) => type === "PropertyDefinition" && value)
        .flatMap(({ value }) => this.visit(value)),
    ];
    const visitAttribute = this.visitAttribute;
    this.visitAttribute = (node) => {
      const msgs = visitAttribute(node);
      const parts = msgs.length === 0 && Array.isArray(node.value) && node.value.length > 1 ? node.value : [];
      return [...msgs, ...parts.flatMap((part) => (part.type === "ExpressionTag" ? this.visitSv(part) : []))];
    };
    this.visitThrowStatement = (node) => this.visit(node.argument);
    this.visitTSNonNullExpression = (node) => this.visit(node.expression);
  }
}

/** As wuchale asks for it: the code with its texts taken out, and the texts. */
export async function transform(given) {
  const known = new Set(given.index.indices.keys());
  const { content, marked } = prepare(given.content, given.filename);
  const { msgs, output } = await new PageTransformer(content, given).transformSv();
  const found = msgs.filter(({ plural, details: { scope } }) => scope === "script" && !plural);
  if (found.length !== marked.length) {
    const missed = marked.filter((text) => !found.some(({ msgStr }) => msgStr[0].replace(/\{\d+\}/g, "{}") === text));
    throw new Error(`${given.filename}: texts that wuchale does not reach: ${JSON.stringify(missed)}`);
  }
  const isNew = ({ msgStr, context }) => !known.has(getKey(msgStr, context));
  if (process.env.NODE_ENV === "production" && msgs.some(isNew)) {
    // the built page would show nothing in their place
    const texts = msgs.filter(isNew).map(({ msgStr }) => msgStr[0]);
    throw new Error(`texts that src/texts/en.po lacks: ${JSON.stringify(texts)}; npm run texts writes them there`);
  }
  for (const message of msgs) {
    // what is put into a text is shown to translators as the code has it
    message.placeholders = message.placeholders.map(([i, code]) => [i, withoutMarks(code)]);
  }
  return { msgs, output };
}
