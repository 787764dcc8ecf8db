import { expect, test } from "vitest";
import { QuickerDrawer } from "../../../src/core/drawing/quicker_drawer";

function started() {
  let now = 0;
  const quicker = new QuickerDrawer(() => now);
  const engine = (...times: number[]) => { times.forEach((time) => { quicker.learnEngine(time); }); };
  return { quicker, engine, pass: (milliseconds: number) => (now += milliseconds) };
}

test("the engine begins, and as long as it is quick the browser is not looked at", () => {
  const { quicker, engine, pass } = started();
  expect([quicker.drawer, quicker.due]).toEqual(["engine", null]);
  engine(900, 80, 90, 80);
  pass(1e6);
  expect([quicker.drawer, quicker.due]).toEqual(["engine", null]);
  expect(quicker.reason).toBe(
    "it takes 90\u202fms for a picture while the view turns, this browser has no graphics card",
  );
});

test("where the engine is slow the browser is timed, and draws if it is much quicker", () => {
  const { quicker, engine } = started();
  engine(700, 800);
  expect(quicker.due).toBeNull();
  engine(900);
  expect(quicker.due).toBe("browser");
  quicker.learnBrowser(600);
  expect([quicker.drawer, quicker.due]).toEqual(["engine", null]);
  quicker.forget();
  engine(700, 800, 900);
  quicker.learnBrowser(300);
  expect(quicker.drawer).toBe("browser");
});

test("while the browser draws the engine is tried now and then, and takes over once it is quick again", () => {
  const { quicker, engine, pass } = started();
  engine(2000, 2000, 2000);
  quicker.learnBrowser(300);
  expect([quicker.drawer, quicker.due]).toEqual(["browser", "engine"]);
  engine(2000, 2000, 2000);
  expect([quicker.drawer, quicker.due]).toEqual(["browser", null]);
  pass(31_000);
  expect(quicker.due).toBe("engine");
  engine(90, 90, 90);
  expect([quicker.drawer, quicker.due]).toEqual(["engine", null]);
});

test("it never goes back and forth, whatever noise of a fifth there is", () => {
  for (const [own, other] of [[300, 300], [300, 150], [300, 170], [500, 240], [220, 110]] as const) {
    const { quicker, engine, pass } = started();
    const drawers: string[] = [];
    for (let i = 0; i < 200; i += 1) {
      pass(1000);
      const noise = 1 + 0.2 * Math.sin(7.3 * i);
      engine(own * noise);
      if (quicker.due === "browser") {
        quicker.learnBrowser(other * (1 + 0.2 * Math.cos(3.1 * i)));
      }
      drawers.push(quicker.drawer);
    }
    const changes = drawers.filter((drawer, i) => i > 0 && drawer !== drawers[i - 1]);
    expect(changes.length).toBeLessThanOrEqual(1);
  }
});
