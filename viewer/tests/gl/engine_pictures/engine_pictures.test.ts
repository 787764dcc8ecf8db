import { expect, test } from "vitest";
import type { DrawnPicture, DrawPicture, PictureLook } from "../../../src/core/protocol";
import { EnginePictures, type EngineView } from "../../../src/gl/engine_pictures/engine_pictures";

const size = [300, 200] as const;
const axes = { right: [1, 0, 0], up: [0, 0, 1], back: [0, -1, 0] } as const;

function viewAt(distance: number): EngineView {
  return {
    camera: { ...axes, target: [0, 0, 0], distance, field: 0.4, parallel: null },
    extent: { outline: [], centre: [0, 0, 0], radius: 1 },
  };
}

function drawn(number: number, finished = false): DrawnPicture {
  const bytes = new Uint8Array();
  return {
    type: "drawn_picture", number, size: [100, 67], divisor: 3, samples: 1, finished, milliseconds: 1,
    colours: bytes, depths: bytes, nearest: 0, farthest: 1,
  };
}

function started(): { pictures: EnginePictures; sent: (DrawPicture | PictureLook)[]; asked: () => DrawPicture[] } {
  const sent: (DrawPicture | PictureLook)[] = [];
  const pictures = new EnginePictures((message) => sent.push(message));
  pictures.setLook({ type: "picture_look" } as PictureLook);
  return { pictures, sent, asked: () => sent.filter((message) => message.type === "draw_picture") };
}

test("nothing is asked for before it is known how it looks", () => {
  const pictures = new EnginePictures(() => { throw new Error("asked"); });
  pictures.ask(true, viewAt(1), size, 0);
});

test("a camera that moves is asked for in haste, and finely once it rests", () => {
  const { pictures, asked } = started();
  const view = viewAt(500);
  pictures.ask(true, view, size, 0);
  pictures.ask(false, view, size, 50);
  expect(asked().map(({ moving }) => moving)).toEqual([true]);
  pictures.ask(false, view, size, 95);
  pictures.ask(false, view, size, 200);
  expect(asked().map(({ moving }) => moving)).toEqual([true, false]);
});

test("what changes under a camera that rests is asked for finely at once", () => {
  const { pictures, asked } = started();
  const view = viewAt(500);
  pictures.ask(true, view, size, 0);
  pictures.ask(false, view, size, 100);
  pictures.ask(true, view, size, 200);
  expect(asked().at(-1)?.moving).toBe(false);
});

test("a look goes out once, and again to another engine", () => {
  const { pictures, sent } = started();
  pictures.ask(true, viewAt(1), size, 0);
  pictures.ask(true, viewAt(2), size, 1);
  expect(sent.filter(({ type }) => type === "picture_look")).toHaveLength(1);
  pictures.forget();
  pictures.ask(true, viewAt(3), size, 2);
  expect(sent.filter(({ type }) => type === "picture_look")).toHaveLength(2);
});

test("a picture is shown with the camera that it was asked with", () => {
  const { pictures } = started();
  pictures.ask(true, viewAt(1), size, 0);
  pictures.ask(true, viewAt(2), size, 1);
  pictures.take(drawn(1));
  expect(pictures.next(size)?.view.camera.distance).toBe(1);
  expect(pictures.next(size)).toBeNull();
  expect(pictures.finished).toBe(false);
});

test("it is known which request the picture on display answers", () => {
  const { pictures } = started();
  pictures.ask(true, viewAt(1), size, 0);
  pictures.ask(true, viewAt(2), size, 1);
  expect([pictures.requested, pictures.answered]).toEqual([2, 0]);
  pictures.take(drawn(1));
  pictures.next([301, 200]);
  expect(pictures.answered).toBe(0);
  pictures.take(drawn(2));
  pictures.next(size);
  expect(pictures.answered).toBe(2);
});

test("a picture of another size, or that nobody asked for, is left out", () => {
  const { pictures } = started();
  pictures.ask(true, viewAt(1), size, 0);
  pictures.take(drawn(1));
  expect(pictures.next([301, 200])).toBeNull();
  pictures.take(drawn(99));
  expect(pictures.next(size)).toBeNull();
});

test("it is finished with the last picture of the last request", () => {
  const { pictures } = started();
  pictures.ask(true, viewAt(1), size, 0);
  pictures.ask(false, viewAt(1), size, 100);
  pictures.take(drawn(2, true));
  pictures.next(size);
  expect(pictures.finished).toBe(true);
  pictures.ask(true, viewAt(1), size, 200);
  expect(pictures.finished).toBe(false);
});
