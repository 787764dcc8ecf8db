/**
 * Readies a source file for wuchale, which takes texts out of it and puts their translations in. Sentences that the
 * code writes in several pieces become one, so that a translator finds whole ones, and strings of the code are marked
 * as texts.
 */
import { isRead } from "./rules.js";
import { placeOf, walkFile, wordsOf } from "./places.js";

/** A source file as wuchale gets it, and the strings of its code that are marked as texts. */
export function prepare(content, filename) {
  return mark(join(content, filename), filename);
}

/** Code without the marks that `prepare` puts in. */
export function withoutMarks(code) {
  return code.replace(/\s*\/\* @wc-\w+ \*\/ /g, " ").trim();
}

/** "a " + `b ${c}` as `a b ${c}`. */
function join(content, filename) {
  const edits = [];
  walkFile(content, filename, (node, parents) => {
    const isPart = (other) => other?.type === "BinaryExpression" && other.operator === "+";
    if (!isPart(node) || isPart(parents.at(-1))) {
      return;
    }
    const pieces = piecesOf(node);
    for (let i = 0; i < pieces.length;) {
      let end = i;
      while (end < pieces.length && wordsOf(pieces[end]) !== null) end += 1;
      if (end - i > 1) {
        const joined = pieces.slice(i, end);
        const lines = content.slice(joined[0].start, joined.at(-1).end).split("\n").length;
        const text = joined.map((piece) => insideTemplate(piece, content)).join("");
        const kept = text.split("\n").length;
        edits.push([joined[0].start, joined.at(-1).end, `\`${text}\`${"\n".repeat(Math.max(0, lines - kept))}`]);
      }
      i = Math.max(end, i + 1);
    }
  });
  return edited(content, edits);
}

/** The operands of a chain of additions, from left to right. */
function piecesOf(node) {
  return node.type === "BinaryExpression" && node.operator === "+" ? [...piecesOf(node.left), node.right] : [node];
}

function insideTemplate(node, content) {
  return node.type === "TemplateLiteral"
    ? content.slice(node.start + 1, node.end - 1)
    : node.value.replace(/[\\`]|\$\{/g, "\\$&").replaceAll("\n", "\\n");
}

/** Every text of the code with "this is one" before it, and every other string within one with "this is none". */
function mark(content, filename) {
  const edits = [];
  const told = [];
  const marked = [];
  const read = new Set();
  walkFile(content, filename, (node, parents) => {
    if (/Declaration|^Property|Definition|Statement/.test(node.type) && isTold(content, node)) {
      told.push(node);
    }
    const text = wordsOf(node);
    if (text === null || parents.at(-1)?.type === "TaggedTemplateExpression") {
      return;
    }
    const place = placeOf(node, parents, content);
    const isPart = parents.some((parent) => read.has(parent));
    if (isTextAt(text, node, place, { content, told }) || (isPart && node.type === "TemplateLiteral")) {
      read.add(node);
      if (place.name !== "plural") {
        marked.push(text);
      }
      edits.push([node.start, node.start, `${lineAfterComma(content, node)}/* @wc-include */ `]);
    } else if (isPart) {
      edits.push([node.start, node.start, `${lineAfterComma(content, node)}/* @wc-ignore */ `]);
    }
  });
  return { content: edited(content, edits), marked };
}

function isTextAt(text, node, place, { content, told }) {
  const said = content.slice(Math.max(0, node.start - 12), node.start) === "/* @text */ ";
  const isTold = place.kind !== "word" && told.some(({ start, end }) => start <= node.start && node.end <= end);
  return said || isRead(text, isTold ? { kind: "told" } : place);
}

/** After a comma Svelte takes a comment for one of what stands before it, but on a line of its own. */
function lineAfterComma(content, node) {
  return /,\s*$/.test(content.slice(Math.max(0, node.start - 200), node.start)) ? "\n" : "";
}

/** Whether the comment before a declaration says that all its words are texts. */
function isTold(content, node) {
  const before = content.slice(Math.max(0, node.start - 200), node.start).trimEnd();
  return /@texts(\s*\*\/|[^\n]*)$/.test(before);
}

/** A text with parts replaced: [start, end, by] each, which do not overlap. */
function edited(content, edits) {
  let result = content;
  for (const [start, end, by] of edits.toSorted((a, b) => b[0] - a[0] || b[1] - a[1])) {
    result = result.slice(0, start) + by + result.slice(end);
  }
  return result;
}
