/**
 * Pictures of the engine come in parts, so that states need not wait for a whole one; here they are joined.
 */
import type { PicturePart } from "../core/protocol";

export class PictureParts {
  private serial = -1;
  private parts: Uint8Array[] = [];

  /** Takes the next part; returns the packed picture with its last one. */
  take({ serial, last, packed }: PicturePart): ArrayBuffer | null {
    if (serial !== this.serial) {
      // the rest of the one before never comes
      this.serial = serial;
      this.parts = [];
    }
    this.parts.push(packed);
    if (!last) {
      return null;
    }
    const joined = new Uint8Array(this.parts.reduce((length, part) => length + part.length, 0));
    let at = 0;
    for (const part of this.parts) {
      joined.set(part, at);
      at += part.length;
    }
    this.parts = [];
    return joined.buffer;
  }
}
