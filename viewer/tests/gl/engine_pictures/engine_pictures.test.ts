import { describe, expect, test } from "vitest";
import type { DrawnPicture, DrawPicture, PictureLook } from "../../../src/core/protocol";
import { EnginePictures, type EngineView } from "../../../src/gl/engine_pictures/engine_pictures";

const frame = { size: [300, 200], asides: [0] } as const;
const axes = { right: [1, 0, 0], up: [0, 0, 1], back: [0, -1, 0] } as const;

const anyLook = { type: "picture_look", segments: [] } as unknown as PictureLook;

function viewAt(distance: number): EngineView {
  return {
    camera: { ...axes, target: [0, 0, 0], distance, field: 0.4, parallel: null },
    extent: { outline: [], centre: [0, 0, 0], radius: 1 },
  };
}

function drawn(number: number, finished = false): DrawnPicture {
  const bytes = new Uint8Array();
  return {
    type: "drawn_picture", number, size: [100, 67], eyes: 1, part: null, over: null, state: 0,
    divisor: 3, samples: 1, finished, milliseconds: 1, coding: "raw",
    colours: bytes, brightest: 2, depths: bytes, depth_every: 1, nearest: 0, farthest: 1,
  };
}

function started() {
  const sent: (DrawPicture | PictureLook)[] = [];
  let now = 0;
  const pictures = new EnginePictures((message) => sent.push(message), () => now);
  pictures.setLook(anyLook);
  return {
    pictures,
    sent,
    asked: () => sent.filter((message) => message.type === "draw_picture"),
    at: (milliseconds: number) => (now = milliseconds),
  };
}

test("nothing is asked for before it is known how it looks", () => {
  const pictures = new EnginePictures(() => { throw new Error("asked"); });
  pictures.ask(true, viewAt(1), frame);
});

test("a camera that moves is asked for in haste, and finely once it rests", () => {
  const { pictures, asked, at } = started();
  const view = viewAt(500);
  pictures.ask(true, view, frame);
  pictures.take(drawn(1));
  at(40);
  pictures.ask(false, view, frame);
  expect(asked().map(({ moving }) => moving)).toEqual([true]);
  at(55);
  pictures.ask(false, view, frame);
  at(200);
  pictures.ask(false, view, frame);
  expect(asked().map(({ moving }) => moving)).toEqual([true, false]);
});

test("one picture at a time is asked for, the next one at once in the newest view", () => {
  const { pictures, asked } = started();
  for (let distance = 1; distance <= 9; distance += 1) {
    pictures.ask(true, viewAt(distance), frame);
  }
  expect(asked().map(({ cameras: [camera] }) => camera?.distance)).toEqual([1]);
  pictures.take(drawn(1));
  expect(asked().map(({ cameras: [camera] }) => camera?.distance)).toEqual([1, 9]);
});

test("a view that moves again does not wait for finer pictures of one that is seen", () => {
  const { pictures, asked, at } = started();
  const view = viewAt(1);
  pictures.ask(true, view, frame);
  pictures.take(drawn(1));
  at(60);
  pictures.ask(false, view, frame);
  pictures.ask(true, viewAt(2), frame);
  expect(asked().map(({ moving }) => moving)).toEqual([true, false, true]);
});

test("what changes under a camera that rests is asked for finely at once", () => {
  const { pictures, asked } = started();
  const view = viewAt(500);
  pictures.ask(true, view, frame);
  pictures.take(drawn(1));
  pictures.ask(true, view, frame);
  expect(asked().at(-1)?.moving).toBe(false);
});

test("a look goes out once, and again to another engine", () => {
  const { pictures, sent } = started();
  pictures.ask(true, viewAt(1), frame);
  pictures.take(drawn(1));
  pictures.ask(true, viewAt(2), frame);
  expect(sent.filter(({ type }) => type === "picture_look")).toHaveLength(1);
  pictures.forget();
  pictures.ask(true, viewAt(3), frame);
  expect(sent.filter(({ type }) => type === "picture_look")).toHaveLength(2);
});

test("two eyes are asked for at once, each with its own camera", () => {
  const { pictures, asked } = started();
  pictures.ask(true, viewAt(1), { ...frame, asides: [-0.1, 0.1] });
  expect(asked().map(({ cameras }) => cameras.map(({ aside }) => aside))).toEqual([[-0.1, 0.1]]);
});

test("a picture is shown with the camera that it was asked with", () => {
  const { pictures } = started();
  pictures.ask(true, viewAt(1), frame);
  pictures.ask(true, viewAt(2), frame);
  pictures.take(drawn(1));
  expect(pictures.next(frame)?.view.camera.distance).toBe(1);
  expect(pictures.next(frame)).toBeNull();
  expect(pictures.finished).toBe(false);
});

test("it is known which request the picture on display answers, also while the next is due", () => {
  const { pictures } = started();
  pictures.ask(true, viewAt(1), frame);
  pictures.ask(true, viewAt(2), frame);
  expect([pictures.requested, pictures.answered]).toEqual([1, 0]);
  pictures.take(drawn(1));
  pictures.next(frame);
  expect(pictures.answered).toBe(1);
  pictures.take(drawn(2));
  pictures.next(frame);
  expect(pictures.answered).toBe(2);
});

test("a picture that nobody asked for is left out; one of another size stands in, and is not the last", () => {
  const { pictures } = started();
  pictures.take(drawn(99));
  expect(pictures.next(frame)).toBeNull();
  pictures.ask(true, viewAt(1), frame);
  pictures.take(drawn(1, true));
  expect(pictures.next({ ...frame, size: [301, 200] })?.frame).toEqual(frame);
  expect(pictures.finished).toBe(false);
});

test("a picture differs from what is seen now by the view alone, unless anything else has changed since", () => {
  const { pictures } = started();
  expect(pictures.differsByView).toBe(false);
  const view = viewAt(1);
  pictures.ask(true, view, frame);
  pictures.take(drawn(1));
  pictures.ask(true, viewAt(2), frame);
  expect(pictures.differsByView).toBe(true);
  const last = viewAt(3);
  pictures.ask(true, last, frame);
  // an edit, say
  pictures.ask(true, last, frame);
  expect(pictures.differsByView).toBe(false);
  pictures.take(drawn(2));
  expect(pictures.differsByView).toBe(false);
  pictures.take(drawn(3));
  expect(pictures.differsByView).toBe(true);
  pictures.setLook({ ...anyLook, mode: "mip" });
  expect(pictures.differsByView).toBe(false);
});

test("it is finished with the last picture of the last request", () => {
  const { pictures, at } = started();
  const view = viewAt(1);
  pictures.ask(true, view, frame);
  pictures.take(drawn(1));
  at(100);
  pictures.ask(false, view, frame);
  pictures.take(drawn(2, true));
  pictures.next(frame);
  expect(pictures.finished).toBe(true);
  pictures.ask(true, view, frame);
  expect(pictures.finished).toBe(false);
});

test("where no picture comes for long, or word that none does, it has failed; the next picture mends that", () => {
  const { pictures, at } = started();
  const view = viewAt(1);
  pictures.ask(true, view, frame);
  at(9_000);
  pictures.ask(false, view, frame);
  expect(pictures.failure).toBeNull();
  at(10_001);
  pictures.ask(false, view, frame);
  expect(pictures.failure).toBe("the engine sent no picture for 10 s");
  pictures.probe(view, frame);
  pictures.take(drawn(2));
  expect(pictures.failure).toBeNull();
  pictures.take({ type: "picture_failed", number: 3, text: "not enough memory" });
  expect(pictures.failure).toBe("not enough memory");
});

test("it tells how long moving pictures took until they came", () => {
  const { pictures, at } = started();
  const times: number[] = [];
  pictures.onAnswer = (milliseconds) => times.push(milliseconds);
  pictures.ask(true, viewAt(1), frame);
  at(70);
  pictures.take(drawn(1));
  expect(times).toEqual([70]);
});

describe("edits under a view at rest", () => {
  const view = viewAt(500);

  /** A picture of an edit is on display, and another edit has been asked for. */
  function edited(state = 7) {
    const all = started();
    all.pictures.ask(true, view, frame);
    all.pictures.take({ ...drawn(1), state });
    all.pictures.next(frame);
    all.pictures.ask(true, view, frame);
    return all;
  }

  test("tell what is on display, so that their part of it can come first", () => {
    const { asked, pictures } = edited();
    expect(asked().map(({ over }) => over)).toEqual([null, { state: 7, divisor: 3 }]);
    pictures.take({ ...drawn(2), part: [8, 16], over: 7, state: 9 });
    expect(pictures.next(frame)?.picture.part).toEqual([8, 16]);
    pictures.ask(true, view, frame);
    expect(asked().at(-1)?.over).toEqual({ state: 9, divisor: 3 });
  });

  test.each<[string, (pictures: EnginePictures) => void]>([
    ["another look", (pictures) => { pictures.setLook({ ...anyLook, mode: "mip" }); }],
    ["another drew over it", (pictures) => { pictures.cover(); }],
    ["another fineness", (pictures) => { pictures.resting = { stepsPerVoxel: 4, passes: 16 }; }],
    ["jitter is switched off", (pictures) => { pictures.jitter = false; }],
  ])("tell nothing after %s", (_, change) => {
    const { asked, pictures } = edited();
    pictures.take({ ...drawn(2), state: 9 });
    pictures.next(frame);
    change(pictures);
    pictures.ask(true, view, frame);
    expect(asked().at(-1)?.over).toBeNull();
  });

  test("tell nothing in another view or size", () => {
    const { asked, pictures } = edited();
    pictures.take({ ...drawn(2), state: 9 });
    pictures.next(frame);
    pictures.ask(true, view, { ...frame, size: [301, 200] });
    expect(asked().at(-1)?.over).toBeNull();
    pictures.take({ ...drawn(3), state: 9 });
    pictures.next({ ...frame, size: [301, 200] });
    pictures.ask(true, viewAt(400), frame);
    expect(asked().at(-1)?.over).toBeNull();
  });

  test.each([
    ["a later edit than is on display", { part: [0, 0], over: 8 }],
    ["a picture of another resolution", { part: [0, 0], over: 7, divisor: 1 }],
  ] satisfies [string, Partial<DrawnPicture>][])("a part over %s is not shown", (_, of) => {
    const { pictures } = edited();
    pictures.take({ ...drawn(2), ...of });
    expect(pictures.next(frame)).toBeNull();
  });

  test("that a segment is edited from now on is no other look", () => {
    const { asked, pictures } = edited();
    const look = (isEdited: boolean): PictureLook =>
      ({ type: "picture_look", segments: [{ id: 1, edited: isEdited }] }) as unknown as PictureLook;
    pictures.setLook(look(false));
    pictures.take({ ...drawn(2), state: 9 });
    pictures.ask(true, view, frame);
    pictures.take({ ...drawn(3), state: 9 });
    pictures.next(frame);
    pictures.setLook(look(true));
    pictures.ask(true, view, frame);
    expect(asked().at(-1)?.over).toEqual({ state: 9, divisor: 3 });
  });

  test("the same look told again is no other look", () => {
    const { asked, pictures, sent } = edited();
    pictures.setLook({ ...anyLook });
    pictures.take({ ...drawn(2), state: 9 });
    pictures.next(frame);
    pictures.ask(true, view, frame);
    expect(asked().at(-1)?.over).toEqual({ state: 9, divisor: 3 });
    expect(sent.filter(({ type }) => type === "picture_look")).toHaveLength(1);
  });
});
