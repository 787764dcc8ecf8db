/** Where the words of a source file stand: every string of its code, with the place that it ends up in. */
import { parse } from "svelte/compiler";
import { parseScript } from "wuchale/adapter-vanilla";

/** Types and styles hold no texts; what a module is called is none. */
const skipped = new Set([
  ...["css", "metadata", "options", "returnType", "typeAnnotation", "typeArguments", "typeParameters"],
]);
const skippedTypes = /^(TS(Type|Interface|Enum|Literal|Union|Declare)|Import|ExportAll)/;

/** The tree of a file, with each node's parents; `see(node, parents)` once for each node, outer ones first. */
export function walkFile(content, filename, see) {
  const tree = filename.endsWith(".svelte")
    ? parse(content, { modern: true })
    : parseScript(content)[0];
  walk(tree, [], see);
}

function walk(node, parents, see) {
  if (skippedTypes.test(node.type)) {
    return;
  }
  see(node, parents);
  const below = [...parents, node];
  for (const [key, value] of Object.entries(node)) {
    if (skipped.has(key)) {
      continue;
    }
    for (const child of Array.isArray(value) ? value : [value]) {
      if (typeof child?.type === "string") {
        walk(child, below, see);
      }
    }
  }
}

/** The words of a string as it is read, with "{}" for each part that is put in; null for anything else. */
export function wordsOf(node) {
  if (node.type === "Literal" && typeof node.value === "string") {
    return node.value;
  }
  return node.type === "TemplateLiteral" ? node.quasis.map(({ value }) => value.cooked).join("{}") : null;
}

/**
 * Where a string ends up, as far as its file tells, as { kind, name }: a "field" of an object, an "attribute", the
 * argument of a "call", a "variable", text of the "markup", a "word" that code compares or looks up by, or "unknown".
 */
export function placeOf(node, parents, content) {
  let inner = node;
  for (const outer of parents.toReversed()) {
    const place = placeIn(inner, outer, content);
    if (place !== null) {
      return place;
    }
    inner = outer;
  }
  return { kind: "unknown" };
}

const word = { kind: "word" };

/** What the next node around makes of it; null where it only hands it on. */
function placeIn(inner, outer, content) {
  const name = (node) => content.slice(node.start, node.end);
  switch (outer.type) {
    case "ConditionalExpression":
      return outer.test === inner ? word : null;
    case "BinaryExpression":
      return outer.operator === "+" ? null : word;
    case "Property":
    case "PropertyDefinition":
      return outer.value === inner ? { kind: "field", name: outer.key.name ?? outer.key.value } : word;
    case "CallExpression":
    case "NewExpression":
      return outer.callee === inner ? null : { kind: "call", name: name(outer.callee) };
    case "Attribute":
      return { kind: "attribute", name: outer.name };
    case "StyleDirective":
    case "ClassDirective":
    case "BindDirective":
      return word;
    case "SwitchCase":
      return outer.test === inner ? word : { kind: "unknown" };
    case "MemberExpression":
      return outer.property === inner ? word : null;
    case "ExpressionTag":
      return null;
    case "Fragment":
      return { kind: inner.type === "ExpressionTag" ? "markup" : "word" };
    case "VariableDeclarator":
    case "AssignmentExpression":
      return { kind: "variable", name: name(outer.id ?? outer.left) };
    case "IfStatement":
    case "IfBlock":
    case "EachBlock":
    case "KeyBlock":
      return word;
    case "BlockStatement":
    case "Program":
      return { kind: "unknown" };
    default:
      return null;
  }
}
