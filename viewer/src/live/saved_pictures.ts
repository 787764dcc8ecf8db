/** Asks the engine for pictures that are to be saved. */
import type { DrawnPicture } from "../core/protocol";
import { Strips, type PictureWish } from "../core/view/saved_pictures";
import { apiAddress } from "./connection";

/** Strips of the pictures, from left to right, as they are drawn; leaving it ends the work. Throws why it failed. */
export async function* savedPictures(
  wish: PictureWish,
  signal: AbortSignal,
): AsyncGenerator<DrawnPicture> {
  const answer = await fetch(apiAddress("/api/picture"), { method: "POST", body: JSON.stringify(wish), signal });
  if (!answer.ok || answer.body === null) {
    throw new Error(await answer.text());
  }
  const strips = new Strips();
  const reader = answer.body.getReader();
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) {
        return;
      }
      yield* strips.take(value);
    }
  } finally {
    // whoever needs no more
    await reader.cancel();
  }
}
