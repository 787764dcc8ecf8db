/** Shows the cases of a cohort: distributions, and a table to sort and to filter. The data is in the page. */
"use strict";

const cases = JSON.parse(document.getElementById("cases").textContent);
const done = cases.filter((one) => one.reason === null);
const AT_ONCE = 200; // rows: more of them make the page slow
const FILTERS = [
  ["All", () => true],
  ["Failed", (one) => one.reason !== null],
  ["Outliers", (one) => one.outliers.length > 0],
  ["With warnings", (one) => one.warnings.length > 0],
];
const state = { filter: 0, words: "", segment: "", sort: "name", falling: false, open: null, shown: AT_ONCE };

/** Makes an element; text is never taken for HTML. */
function make(tag, given = {}, ...children) {
  const { svg, on = {}, ...attributes } = given;
  const made = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== undefined && value !== false) made.setAttribute(name, value === true ? "" : value);
  }
  for (const [name, listener] of Object.entries(on)) made.addEventListener(name, listener);
  made.append(...children.filter((child) => child !== null));
  return made;
}

/** "mean_HU" is "mean [HU]": the unit stands last in the name of a column, but for the number of a second one. */
function titled(column) {
  if (column === "voxels_without_value") return "voxels without a value";
  const [, name, unit, count] = /^(.*?)(?:_([A-Za-z]+_per_[A-Za-z]+|[^_\d][^_]*))?(?:_(\d+))?$/.exec(column);
  const told = name.replaceAll("_", " ") + (count === undefined ? "" : ` (${count})`);
  if (unit === undefined) return told;
  return `${told} [${unit.replace("_per_", "/").replace(/mm(\d)/, (_, power) => `mm${"²³"[power - 2]}`)}]`;
}

function number(value) {
  if (value === undefined || value === null) return "–";
  const shown = Math.abs(value) >= 1e4 ? Math.round(value) : Number(value.toPrecision(4));
  return shown.toString().replace("-", "−");
}

const segments = [...new Set(done.flatMap((one) => Object.keys(one.segments)))];

/** The columns that are shown: [segment, column]. */
function columns() {
  const of = (segment) => [...new Set(done.flatMap((one) => Object.keys(one.segments[segment]?.values ?? {})))];
  if (state.segment !== "") return of(state.segment).map((column) => [state.segment, column]);
  const chosen = (column) => column === "volume_ml" || /^(mean|dice|hausdorff95)|stiffness/.test(column);
  return segments.flatMap((segment) => of(segment).filter(chosen).map((column) => [segment, column]));
}

const value = (one, [segment, column]) => one.segments[segment]?.values[column];
const isFar = (one, [segment, column]) => one.outliers.some(([a, b]) => a === segment && b === column);
const colour = (segment) => done.find((one) => one.segments[segment]?.colour)?.segments[segment].colour ?? "gray";
const swatch = (segment) => make("span", { class: "swatch", style: `background:${colour(segment)}` });

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const half = sorted.length / 2;
  return sorted.length % 2 ? sorted[Math.floor(half)] : (sorted[half - 1] + sorted[half]) / 2;
}

/** A distribution: a dot for each case, or bars where they are many; the line is the median. */
function card(place) {
  const known = done.filter((one) => Number.isFinite(value(one, place)));
  const values = known.map((one) => value(one, place));
  const low = Math.min(...values), high = Math.max(...values), middle = median(values);
  const [width, height, bins] = [256, 44, 36];
  const at = (number) => (high > low ? (number - low) / (high - low) : 0.5);
  const piles = Array.from({ length: bins }, () => []);
  for (const one of known) piles[Math.min(bins - 1, Math.floor(at(value(one, place)) * bins))].push(one);
  const tallest = Math.max(...piles.map((pile) => pile.length));
  const drawn = make("svg", { svg: true, width, height: height + 6, role: "img", "aria-label": `${known.length} cases from ${number(low)} to ${number(high)}` });
  const line = (name, x1, x2, y1, y2) => drawn.append(make("line", { svg: true, class: name, x1, x2, y1, y2 }));
  line("axis", 0, width, height, height);
  piles.forEach((pile, bin) => {
    if (tallest > 7) {
      const tall = (height * pile.length) / tallest;
      const far = pile.some((one) => isFar(one, place));
      if (pile.length) drawn.append(make("rect", { svg: true, class: far ? "bar far" : "bar", x: (bin * width) / bins + 0.5, width: width / bins - 1, y: height - tall, height: tall }, make("title", { svg: true }, `${pile.length} cases`)));
      return;
    }
    pile.forEach((one, up) => {
      const far = isFar(one, place) ? " far" : "", chosen = state.open === one.name ? " chosen" : "";
      drawn.append(make("circle", { svg: true, class: `case-dot${far}${chosen}`, cx: 4 + at(value(one, place)) * (width - 8), cy: height - 5 - 6 * up, r: 4, on: { click: () => choose(one.name) } }, make("title", { svg: true }, `${one.name}: ${number(value(one, place))}`)));
    });
  });
  const x = 4 + at(middle) * (width - 8);
  line("middle", x, x, height - 3, height + 6);
  return make("section", { class: "card" },
    make("h2", { title: `${place[0]}, ${titled(place[1])}` }, swatch(place[0]), `${place[0]} ${titled(place[1])}`), drawn,
    make("div", { class: "ends" }, make("span", {}, number(low)), make("span", {}, `median ${number(middle)}`), make("span", {}, number(high))));
}

/** A number in the table; an outlier also says to which side it is. */
function cell(one, place) {
  const known = value(one, place);
  if (!isFar(one, place)) return make("td", { class: "number" }, number(known));
  const middle = median(done.map((each) => value(each, place)).filter(Number.isFinite));
  return make("td", { class: "number far", title: `far from the median ${number(middle)}` }, `${known > middle ? "↑" : "↓"} ${number(known)}`);
}

function heading(key, title, isNumber, above = null) {
  const now = state.sort === key;
  const sort = () => { state.falling = now && !state.falling; state.sort = key; show(); };
  return make("th", { class: isNumber && "number", "aria-sort": now ? (state.falling ? "descending" : "ascending") : null },
    make("button", { on: { click: sort } }, ...(above === null ? [] : [make("span", { class: "segment" }, swatch(above), above)]), title, now ? (state.falling ? " ▾" : " ▴") : ""));
}

function rows() {
  const words = state.words.toLowerCase();
  const wanted = cases.filter((one) => FILTERS[state.filter][1](one) && one.name.toLowerCase().includes(words));
  const shown = columns().find((place) => place.join("/") === state.sort);
  const key = shown ? (one) => value(one, shown) : state.sort === "state" ? (one) => (one.reason === null ? 0 : 1) : state.sort === "seconds" ? (one) => one.seconds : (one) => one.name;
  // what has no value comes last, whichever way it is sorted
  const missing = (one) => (key(one) === undefined || key(one) === null ? 1 : 0);
  const order = (a, b) => (typeof a === "string" ? a.localeCompare(b, undefined, { numeric: true }) : a - b);
  return wanted.sort((a, b) => missing(a) - missing(b) || (missing(a) ? 0 : (state.falling ? -1 : 1) * order(key(a), key(b))));
}

function details(one, span) {
  const copy = make("button", { on: { click: async () => { await navigator.clipboard.writeText(one.open); copy.textContent = "Copied"; } } }, "Copy");
  const all = [...new Set(Object.values(one.segments).flatMap((segment) => Object.keys(segment.values)))];
  const lines = Object.entries(one.segments).map(([name, segment]) => make("tr", {},
    make("td", {}, swatch(name), name, segment.note ? make("span", { class: "note" }, ` ${segment.note}`) : ""), ...all.map((column) => cell(one, [name, column]))));
  return make("tr", { class: "details" }, make("td", { colspan: span }, make("div", { class: "sheet" },
    one.picture === null ? null : make("img", { src: one.picture, alt: `${one.name} from the front` }),
    make("div", { class: "numbers" },
      one.open === null ? null : make("p", { class: "command" }, "To open it, from this folder:", make("code", {}, one.open), copy),
      one.reason === null || one.open !== null ? null : make("p", { class: "muted" }, "Nothing was made of it."),
      lines.length ? make("table", {}, make("tr", {}, make("th", {}, "segment"), ...all.map((column) => make("th", { class: "number" }, titled(column)))), ...lines) : null,
      one.files.length ? make("p", { class: "muted" }, `Files: ${one.files.map((file) => `${one.name}/${file}`).join(", ")}`) : null,
      one.warnings.length ? make("ul", { class: "note" }, ...one.warnings.map((each) => make("li", {}, each))) : null))));
}

function row(one, places) {
  const open = state.open === one.name;
  const toggle = () => { state.open = open ? null : one.name; show(); };
  const picture = one.picture === null ? make("span") : make("img", { src: one.picture, alt: "", loading: "lazy" });
  const told = one.reason === null
    ? [...places.map((place) => cell(one, place)), make("td", { class: one.warnings.length ? "number note" : "number" }, one.warnings.length || "")]
    : [make("td", { class: "reason", colspan: places.length + 1 }, one.reason)];
  return make("tr", { class: open ? "case chosen" : "case", id: `case-${one.name}`, on: { click: toggle } },
    make("td", { class: "picture" }, picture),
    make("td", { class: "name" }, make("button", { "aria-expanded": String(open), title: "Show all of this case" }, open ? "▾" : "▸"), ` ${one.name}`),
    make("td", { class: one.reason === null ? "done" : "failed" }, one.reason === null ? "done" : "failed"),
    ...told, make("td", { class: "number" }, one.seconds === null ? "–" : number(one.seconds)));
}

function choose(name) {
  Object.assign(state, { open: name, filter: 0, words: "", shown: cases.length });
  document.querySelector("input[type=search]").value = "";
  show();
  document.getElementById(`case-${name}`)?.scrollIntoView({ block: "center" });
}

function show() {
  const places = columns(), wanted = rows();
  filters.forEach((button, index) => button.setAttribute("aria-pressed", String(index === state.filter)));
  const scrolled = cards.scrollLeft;
  cards.replaceChildren(...places.filter((place) => done.some((one) => Number.isFinite(value(one, place)))).map(card));
  cards.scrollLeft = scrolled;
  const head = make("tr", {}, make("td"), heading("name", "Case", false), heading("state", "State", false),
    ...places.map((place) => heading(place.join("/"), titled(place[1]), true, place[0])), make("th", { class: "number" }, "Warnings"), heading("seconds", "Time [s]", true));
  const body = wanted.slice(0, state.shown).flatMap((one) => (state.open === one.name ? [row(one, places), details(one, places.length + 5)] : [row(one, places)]));
  if (!wanted.length) body.push(make("tr", {}, make("td", { colspan: places.length + 5, class: "muted" }, "No case is like that.")));
  const left = wanted.length - state.shown;
  table.replaceChildren(make("table", {}, make("thead", {}, head), make("tbody", {}, ...body)));
  more.replaceChildren(...(left > 0 ? [make("button", { on: { click: () => { state.shown += AT_ONCE; show(); } } }, `Show ${Math.min(left, AT_ONCE)} more of ${left}`)] : []));
}

const filters = FILTERS.map(([name, takes], index) =>
  make("button", { on: { click: () => { state.filter = index; show(); } } }, name, make("span", { class: "count" }, cases.filter(takes).length)));
const search = make("input", { type: "search", placeholder: "Find a case", "aria-label": "Find a case", on: { input: (event) => { state.words = event.target.value; show(); } } });
const choice = make("select", { "aria-label": "Measures", on: { change: (event) => { state.segment = event.target.value; state.sort = "name"; show(); } } },
  make("option", { value: "" }, "Main numbers of all segments"), ...segments.map((name) => make("option", { value: name }, `All of ${name}`)));
const scrolled = (name, label) => make("div", { class: name, role: "region", tabindex: 0, "aria-label": label });
const cards = scrolled("cards", "Distributions"), table = scrolled("table", "Cases"), more = make("div", { class: "more" });
const failed = cases.length - done.length;
document.getElementById("page").replaceChildren(
  make("h1", {}, `${cases.length} ${cases.length === 1 ? "case" : "cases"}`),
  make("p", { class: "muted", style: "margin:0" }, `${done.length} done${failed ? `, ${failed} failed` : ""}`),
  make("div", { class: "top" }, ...filters, make("span", { class: "space" }), choice, search), cards, table, more);
show();
