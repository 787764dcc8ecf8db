/**
 * A hand that opens a scan in Palpate or another program, brings bone into the picture and touches it, where it
 * can; each of its acts is counted. Takes a picture at the end.
 *
 *   node peers.mjs palpate|ohif|niivue URL PICTURE [what is dropped]
 *
 * Prints a line of JSON: {"acts": [{"towards": "open", "does": …}], "seconds": from the first act to the last picture}
 */
import { launchChromium } from "./chromium.mjs";

const SIZE = { width: 1366, height: 768 };
// for what never comes: software GL holds a page up for minutes
const PATIENCE = 600_000;
const BETWEEN = 5_000;

const [program, url, picture, dropped] = process.argv.slice(2);
const browser = await launchChromium();
const page = await browser.newPage({ viewport: SIZE });
page.setDefaultTimeout(PATIENCE);
page.on("pageerror", ({ message }) => console.error(message));

const acts = [];
let began;

/**
 * Does one thing that a hand does, and counts it: to "open", for "bone", to "touch" it, for a "force", for the
 * "layout".
 */
async function act(towards, does, how) {
  began ??= Date.now();
  await how();
  acts.push({ towards, does });
}

async function drop(path) {
  const session = await page.context().newCDPSession(page);
  const data = { items: [], files: [path], dragOperationsMask: 1 };
  for (const type of ["dragEnter", "dragOver", "drop"]) {
    await session.send("Input.dispatchDragEvent", { type, x: 300, y: 300, data });
  }
  await session.detach();
}

const click = (selector) => page.locator(selector).first().click();

/** Presses what the probe is at: holds Shift, moves the mouse and turns the wheel until the force is 1 N. */
async function press(x, y) {
  await page.keyboard.down("Shift");
  await page.mouse.move(x + 1, y);
  const force = () => page.evaluate(() => Math.hypot(...window.palpate.state.force));
  for (const began = Date.now(); (await force()) < 1; ) {
    if (Date.now() - began > PATIENCE) throw new Error("nothing is felt");
    await page.mouse.wheel(0, -20);
    await page.waitForTimeout(1000);
  }
  await page.keyboard.up("Shift");
}

/** Takes pictures until one is as the one before: nothing loads or gets finer any more. */
async function picturedAtRest() {
  await page.waitForLoadState("networkidle");
  for (let before = null, now = null; before === null || !now.equals(before); ) {
    await page.waitForTimeout(BETWEEN);
    before = now;
    now = await page.screenshot({ path: picture });
  }
}

const programs = {
  async palpate() {
    await page.goto(url);
    await page.locator("[data-testid=open-page]").waitFor();
    await act("open", "drops the folder", () => drop(dropped));
    await page.waitForFunction(() => window.palpate?.ready === true);
    await page.evaluate(() => window.palpate.setJitter(false));
    await act("layout", "clicks four panes", () => click("[data-testid=layout-four]"));
    await page.waitForFunction(() => window.palpate.finished);
    const box = await page.locator("[data-testid=canvas]").boundingBox();
    // the breastbone, a little up and left of the middle
    const [x, y] = [box.x + 0.42 * box.width, box.y + 0.4 * box.height];
    await act("touch", "double-clicks bone", () => page.mouse.dblclick(x, y));
    await act("force", "presses by Shift and the wheel", () => press(x, y));
    await page.waitForFunction(() => window.palpate.finished);
  },

  async ohif() {
    await page.goto(url);
    await act("open", "confirms the notice", () => click("[data-cy=confirm-and-hide-button]"));
    await act("open", "clicks the study", () => click("text=LIDC"));
    await act("open", "clicks Basic Viewer", () => click("text=Basic Viewer"));
    await act("open", "skips the tour", () => click("text=Skip all"));
    await act("bone", "clicks the layouts", () => click("[data-cy=Layout]"));
    await act("bone", "clicks 3D four up", () => click("text=3D four up"));
  },

  async niivue() {
    await page.goto(url);
    await page.locator("body[data-ready]").waitFor();
    await act("open", "drops the file", () => drop(dropped));
    await page.locator("body[data-loaded]").waitFor();
    await act("bone", "clicks a colour map", () => click("text=ct_bones"));
  },
};

await programs[program]();
await picturedAtRest();
console.log(JSON.stringify({ acts, seconds: (Date.now() - began) / 1000 }));
await browser.close();
