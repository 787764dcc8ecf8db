/**
 * A person at the page, in a real browser: does what it is told on standard input and
 * answers on standard output, one JSON object a line each.
 *
 *   {"do": "open", "url": …, "width": 720, "height": 480}   → {"firstPicture": ms | null}
 *   {"do": "wait", "for": "<expression in the page>", "seconds": 30}
 *   {"do": "read", "expression": "<expression in the page>"}  → {"value": …}
 *   {"do": "text", "testid": "force"}                         → {"value": "1.25"}
 *   {"do": "screenshot", "path": …, "testid": optional}
 *   {"do": "doubleClick", "x": …, "y": …}                     in pixels of the picture
 *   {"do": "drag", "x": …, "y": …}                            left button held: turns the picture
 *   {"do": "altDrag", "x": …, "y": …}                         the same with Alt held: window and level
 *   {"do": "dragElement", "testid": …, "x": …, "y": …}        a handle in the picture, "from": [x, y] of its middle
 *   {"do": "paintLine", "points": [[x, y], …]}                left button held over the picture, from its middle
 *   {"do": "touch", "x": …, "y": …, "depth": wheel pixels}    Shift held: move by x, y; wheel (< 0 is deeper)
 *   {"do": "stroke", "x": …, "y": …, "depth": …}              the same with the left button too, "held": true: still
 *   {"do": "release"}                                         the left button
 *   {"do": "fingers", "from": [[x, y], …], "to": [[x, y], …]}  on a touch screen, of the picture's middle or of that of
 *                                                             an element by "testid"; "hold": true
 *   {"do": "pen", "x": …, "y": …, "force": 0..1}              presses a pen there and holds it; of the picture's middle
 *   {"do": "penUp"}, {"do": "fingersUp"}
 *   {"do": "mouse", "down": true}                             the left button where the mouse is; false lets it go
 *   {"do": "hold", "key": "x"}                                a key, until the same with "up": true
 *   {"do": "point", "x": …, "y": …}                           the mouse, in pixels of the page
 *   {"do": "clickAt", "testid": …, "x": …, "y": …}            in shares of an element; "doubleClickAt" too
 *   {"do": "wheelOver", "testid": …, "x": …, "y": …}          over an element's middle, 120 is a notch; "times": so
 *                                                             often, "every" so many ms → {"value": ms that it took}
 *   {"do": "clickText", "text": …}                            a button by its name
 *   {"do": "wheel", "y": …}                                   over the picture's middle (< 0 is nearer)
 *   {"do": "click", "testid": …}                              {"do": "choose", "testid": …, "value": …} of a list
 *   {"do": "slide", "testid": …, "value": …}                  a slider, with the mouse
 *   {"do": "download", "testid": …, "path": …}                → {"name": of the file}
 *   {"do": "give", "testid": …, "path": …}                    a file to a chooser of files
 *   {"do": "drop", "paths": […]}                              files and folders onto the page, as from a file manager
 *   {"do": "fill", "testid": …, "text": …}                    a field; {"do": "type", "text": …} where the focus is
 *   {"do": "film", "folder": …}                               films the page; the mouse is drawn as a dot
 *   {"do": "cut"}                                             ends it → {"value": [[seconds, name of a JPEG file], …]}
 *   {"do": "axe"}                                             → {"value": violations of accessibility, as lines}
 *   {"do": "key", "key": "я", "code": "KeyZ", "alt": true}    as on a keyboard of another layout; "repeats": so often
 *   {"do": "requests", "about": "/api/labels"}                → {"value": how many were made so far, by workers too}
 *   {"do": "beforeOpen", "script": …}                         runs in every page opened from now on, before its own
 *   {"do": "freeze", "on": true}                              as a browser does with a page that is long hidden
 *   {"do": "media", "forcedColors": "active", "media": "print"}  as the system has it; null: as it is
 *   {"do": "press", "key": "Escape"}, {"do": "resize", "width": …, "height": …}
 *
 * The browser is the one in CHROMIUM, with CHROMIUM_FLAGS beside the usual ones.
 */
import { readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { createInterface } from "node:readline";
import { launchChromium } from "./chromium.mjs";

const moreFlags = (process.env.CHROMIUM_FLAGS ?? "").split(" ").filter((flag) => flag !== "");
const browser = await launchChromium(moreFlags);
const page = await browser.newPage();
const drawer = process.env.DRAWER ?? "";
if (drawer !== "") {
  // as a person chose it before
  await page.addInitScript((choice) => {
    if (localStorage.getItem("palpate.drawer") === null) {
      localStorage.setItem("palpate.drawer", JSON.stringify({ choice }));
    }
  }, drawer);
}
await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
// limits are for what never comes: software GL on a busy machine takes its time
page.setDefaultTimeout(120_000);
const complaints = [];
page.on("pageerror", (error) => complaints.push(error.message));
page.on("console", (message) => {
  if (message.type() === "error") {
    complaints.push(message.text());
  }
});

const requests = [];
page.on("request", (request) => requests.push(request.url()));

const byTestId = (testid) => page.locator(`[data-testid="${testid}"]`).first();
const picture = () => byTestId("canvas");

/** Shows the group of the left panel that an element is in, or the settings; returns whether those came. */
async function reveal(element) {
  const where = await element.evaluate((each) => ({
    tab: each.closest("[role=tabpanel][hidden]")?.getAttribute("aria-labelledby") ?? null,
    settings: each.closest("[data-testid=settings]:not([open])") !== null,
  }));
  if (where.tab !== null) {
    await page.locator(`[id="${where.tab}"]`).click();
  }
  if (where.settings) {
    await byTestId("open-settings").click();
  }
  return where.settings;
}

/** Does something with an element, as a person who looks for it first; settings are put away again. */
async function withElement(element, act) {
  const opened = await reveal(element);
  const answer = await act(element);
  if (opened) {
    await byTestId("close-settings").click();
  }
  return answer;
}
const withTestId = (testid, act) => withElement(byTestId(testid), act);
const middleOfPicture = () => middleOf(picture());
const middleOf = async (element) => {
  const { x, y, width, height } = await element.boundingBox();
  return [x + width / 2, y + height / 2];
};
// what has no action of its own: fingers, pens, keyboards of other layouts, dropped files
const devtools = await page.context().newCDPSession(page);
let pen = null;
let film = null;

/** Draws the mouse, which no film of a page shows, and rings where its button is held. */
function drawMouse() {
  const dot = document.createElement("div");
  Object.assign(dot.style, {
    position: "fixed", zIndex: "100000", pointerEvents: "none", width: "14px", height: "14px",
    margin: "-7px 0 0 -7px", borderRadius: "50%", background: "#fffd", border: "2px solid #000a",
  });
  document.body.append(dot);
  const follow = (event) => {
    Object.assign(dot.style, { left: `${event.clientX}px`, top: `${event.clientY}px` });
    dot.style.boxShadow = event.buttons === 0 ? "" : "0 0 0 5px #ffb3";
  };
  for (const type of ["pointermove", "pointerdown", "pointerup"]) {
    window.addEventListener(type, follow, true);
  }
}

const actions = {
  async open({ url, width = 720, height = 480, seconds = 120 }) {
    await page.setViewportSize({ width, height });
    await page.goto(url, { waitUntil: "domcontentloaded" });
    await page
      .waitForFunction(
        () =>
          window.palpate?.ready === true ||
          document.querySelector("[data-testid=message] h1, [data-testid=open-page]") !== null,
        null,
        {
          timeout: seconds * 1000,
        },
      )
      .catch(() => undefined);
    return { firstPicture: await page.evaluate(() => window.palpate?.firstPicture ?? null) };
  },
  async wait({ for: expression, seconds = 60 }) {
    // asked from here: the page's security policy allows no evaluation inside it
    const ends = Date.now() + seconds * 1000;
    // a page that loads itself anew has no answer meanwhile
    const ask = () => page.evaluate(expression).catch((error) => {
      if (!String(error).includes("navigation")) throw error;
    });
    while (!(await ask())) {
      if (Date.now() > ends) {
        const reads = await page.evaluate("document.body.innerText.replace(/\\s+/g, ' ').slice(0, 3000)");
        throw new Error(`not true within ${seconds} s; the page reads: ${reads}`);
      }
      await page.waitForTimeout(30);
    }
    return {};
  },
  async read({ expression }) {
    return { value: await page.evaluate(expression) };
  },
  async text({ testid }) {
    return { value: (await byTestId(testid).textContent())?.trim() ?? "" };
  },
  async screenshot({ path, testid }) {
    // of an element only what it draws itself: nothing that lies over the picture, or passes by
    const own = `[data-testid="${testid}"]`;
    const over = `${own} ~ *, ${own} > *, [popover]`;
    const others = `main > :not(:has(${own})), main > * > :not(canvas, ${own}, :has(${own})), ${over}`;
    const style = testid === undefined ? "" : `${others} { visibility: hidden !important }`;
    if (testid === undefined) {
      await page.screenshot({ path, style });
    } else {
      await withTestId(testid, (element) => element.screenshot({ path, style }));
    }
    return {};
  },
  async doubleClick({ x, y }) {
    await picture().dblclick({ position: { x, y } });
    return {};
  },
  async drag({ x = 0, y = 0, steps = 10 }) {
    const box = await picture().boundingBox();
    const [startX, startY] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(startX, startY);
    await page.mouse.down();
    await page.mouse.move(startX + x, startY + y, { steps });
    await page.mouse.up();
    return {};
  },
  async altDrag(options) {
    await page.keyboard.down("Alt");
    await actions.drag(options);
    await page.keyboard.up("Alt");
    return {};
  },
  async stroke(options) {
    const box = await picture().boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.keyboard.down("Shift");
    await page.mouse.down();
    await page.keyboard.up("Shift");
    await actions.touch(options);
    if (options.held !== true) {
      await page.mouse.up();
    }
    return {};
  },
  async release() {
    await page.mouse.up();
    return {};
  },
  async point({ x, y }) {
    await page.mouse.move(x, y);
    return {};
  },
  async mouse({ down }) {
    await (down ? page.mouse.down() : page.mouse.up());
    return {};
  },
  async hold({ key, up = false }) {
    await (up ? page.keyboard.up(key) : page.keyboard.down(key));
    return {};
  },
  async clickAt({ testid, x, y }) {
    await withTestId(testid, async (element) => {
      const box = await element.boundingBox();
      await element.click({ position: { x: x * box.width, y: y * box.height } });
    });
    return {};
  },
  async doubleClickAt({ testid, x, y }) {
    const box = await byTestId(testid).boundingBox();
    await byTestId(testid).dblclick({ position: { x: x * box.width, y: y * box.height } });
    return {};
  },
  async clickText({ text }) {
    await withElement(page.getByRole("button", { name: text, includeHidden: true }).first(), () =>
      page.getByRole("button", { name: text }).click(),
    );
    return {};
  },
  async wheelOver({ testid, x = 0, y = 0, times = 1, every = 0 }) {
    return withTestId(testid, async (element) => {
      await element.hover();
      const begun = Date.now();
      for (let turn = 0; turn < times; ++turn) {
        await page.waitForTimeout(Math.max(0, begun + turn * every - Date.now()));
        await page.mouse.wheel(x, y);
      }
      return { value: Date.now() - begun };
    });
  },
  async dragElement({ testid, x = 0, y = 0, steps = 10, from = [0, 0], button = "left", hold = false }) {
    await reveal(byTestId(testid));
    const box = await byTestId(testid).boundingBox();
    const [startX, startY] = [box.x + box.width / 2 + from[0], box.y + box.height / 2 + from[1]];
    await page.mouse.move(startX, startY);
    await page.mouse.down({ button });
    await page.mouse.move(startX + x, startY + y, { steps });
    if (!hold) {
      await page.mouse.up({ button });
    }
    return {};
  },
  async fingers({ testid, from, to = from, steps = 10, hold = false }) {
    const [middleX, middleY] = await (testid === undefined ? middleOfPicture() : middleOf(byTestId(testid)));
    const touch = (type, share) =>
      devtools.send("Input.dispatchTouchEvent", {
        type,
        touchPoints: from.map(([x, y], id) => ({
          x: middleX + x + (to[id][0] - x) * share,
          y: middleY + y + (to[id][1] - y) * share,
          id,
        })),
      });
    await touch("touchStart", 0);
    for (let step = 1; step <= steps; ++step) {
      await touch("touchMove", step / steps);
    }
    return hold ? {} : actions.fingersUp();
  },
  async fingersUp() {
    await devtools.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    return {};
  },
  async pen({ x = 0, y = 0, force }) {
    const [middleX, middleY] = await middleOfPicture();
    pen = { x: middleX + x, y: middleY + y, pointerType: "pen", button: "left", force, clickCount: 1 };
    await devtools.send("Input.dispatchMouseEvent", { ...pen, type: "mousePressed", buttons: 1 });
    return {};
  },
  async penUp() {
    await devtools.send("Input.dispatchMouseEvent", { ...pen, type: "mouseReleased", force: 0 });
    return {};
  },
  async paintLine({ points }) {
    const box = await picture().boundingBox();
    const at = ([x, y]) => [box.x + box.width / 2 + x, box.y + box.height / 2 + y];
    await page.mouse.move(...at(points[0]));
    await page.mouse.down();
    for (const point of points.slice(1)) {
      await page.mouse.move(...at(point), { steps: 4 });
    }
    await page.mouse.up();
    return {};
  },
  async touch({ x = 0, y = 0, depth = 0, steps = 10 }) {
    const box = await picture().boundingBox();
    const [startX, startY] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(startX, startY);
    await page.keyboard.down("Shift");
    for (let step = 1; step <= steps; ++step) {
      await page.mouse.move(startX + (x * step) / steps, startY + (y * step) / steps);
      if (depth !== 0) {
        await page.mouse.wheel(0, depth / steps);
      }
    }
    await page.keyboard.up("Shift");
    return {};
  },
  async wheel({ y }) {
    const box = await picture().boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.wheel(0, y);
    return {};
  },
  async click({ testid }) {
    await withTestId(testid, (element) => element.click());
    return {};
  },
  async choose({ testid, value }) {
    await withTestId(testid, (element) => element.selectOption(value));
    return {};
  },
  async slide({ testid, value }) {
    return withTestId(testid, async (slider) => {
      await slider.scrollIntoViewIfNeeded();
      const [box, low, high] = [await slider.boundingBox(), ...(await slider.evaluate(({ min, max }) => [+min, +max]))];
      // the middle of the thumb, 14 pixels wide, stays inside of the track
      const at = (share) => [box.x + 7 + share * (box.width - 14), box.y + box.height / 2];
      await page.mouse.move(...at((Number(await slider.inputValue()) - low) / (high - low)));
      await page.mouse.down();
      await page.mouse.move(...at((value - low) / (high - low)), { steps: 8 });
      await page.mouse.up();
      return { value: Number(await slider.inputValue()) };
    });
  },
  async download({ testid, path }) {
    const click = withTestId(testid, (element) => element.click());
    const [download] = await Promise.all([page.waitForEvent("download"), click]);
    await download.saveAs(path);
    return { name: download.suggestedFilename() };
  },
  async give({ testid, path }) {
    await byTestId(testid).setInputFiles(path);
  },
  async drop({ paths }) {
    const data = { items: [], files: paths, dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"]) {
      await devtools.send("Input.dispatchDragEvent", { type, x: 300, y: 300, data });
    }
    return {};
  },
  async fill({ testid, text }) {
    await withTestId(testid, async (element) => {
      await element.fill(text);
      // as a person does who goes on to something else
      await element.blur();
    });
    return {};
  },
  async type({ text }) {
    await page.keyboard.type(text);
    return {};
  },
  async film({ folder }) {
    await page.evaluate(drawMouse);
    film = { frames: [], written: [] };
    const { frames, written } = film;
    film.take = ({ data, metadata, sessionId }) => {
      const name = `${String(frames.length).padStart(5, "0")}.jpg`;
      frames.push([metadata.timestamp, name]);
      written.push(writeFile(`${folder}/${name}`, Buffer.from(data, "base64")));
      void devtools.send("Page.screencastFrameAck", { sessionId });
    };
    devtools.on("Page.screencastFrame", film.take);
    await devtools.send("Page.startScreencast", { format: "jpeg", quality: 85 });
    return {};
  },
  async cut() {
    await devtools.send("Page.stopScreencast");
    devtools.off("Page.screencastFrame", film.take);
    await Promise.all(film.written);
    return { value: film.frames };
  },
  async requests({ about }) {
    return { value: requests.filter((url) => url.includes(about)).length };
  },
  async beforeOpen({ script }) {
    await page.addInitScript(script);
    return {};
  },
  async freeze({ on }) {
    await devtools.send("Page.setWebLifecycleState", { state: on ? "frozen" : "active" });
    return {};
  },
  async media(options) {
    await page.emulateMedia(options);
    return {};
  },
  async axe() {
    await page.evaluate(await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8"));
    const violations = await page.evaluate(async () => {
      const found = await globalThis.axe.run({ resultTypes: ["violations"] });
      return found.violations.map(({ id, impact, nodes }) => ({
        id,
        impact,
        places: nodes.map(({ html, failureSummary }) => `${html} ${failureSummary}`),
      }));
    });
    return { value: violations };
  },
  async press({ key }) {
    await page.keyboard.press(key);
    return {};
  },
  async key({ key, code, alt = false, control = false, shift = false, repeats = 0 }) {
    const modifiers = Number(alt) + 2 * Number(control) + 8 * Number(shift);
    for (let press = 0; press <= repeats; ++press) {
      const autoRepeat = press > 0;
      await devtools.send("Input.dispatchKeyEvent", { type: "rawKeyDown", key, code, modifiers, autoRepeat });
    }
    await devtools.send("Input.dispatchKeyEvent", { type: "keyUp", key, code, modifiers });
    return {};
  },
  async resize({ width, height }) {
    await page.setViewportSize({ width, height });
    return {};
  },
};

for await (const line of createInterface({ input: process.stdin })) {
  const { do: action, ...options } = JSON.parse(line);
  let answer;
  try {
    answer = await actions[action](options);
  } catch (error) {
    answer = { error: String(error) };
  }
  process.stdout.write(`${JSON.stringify({ ...answer, complaints: complaints.splice(0) })}\n`);
}
await browser.close();
