/**
 * Where a tooltip stands: below what it belongs to, or above where there is no room. CSS pixels of the window.
 */

interface Box {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

interface Size {
  readonly width: number;
  readonly height: number;
}

/** From its owner, and from the window's edges. */
const gap = 6;
const edge = 4;
/** Beside the pointer in owners that are wider. */
const wide = 160;

/** Upper left corner of a tooltip. @param pointer how far right the pointer is; null where a key led there. */
export function tooltipPlace(
  owner: Box,
  pointer: number | null,
  { width, height }: Size,
  window: Size,
): { readonly left: number; readonly top: number } {
  const middle = owner.right - owner.left > wide && pointer !== null ? pointer : (owner.left + owner.right) / 2;
  const left = Math.max(edge, Math.min(middle - width / 2, window.width - width - edge));
  const below = owner.bottom + gap;
  const fits = below + height + edge <= window.height;
  return { left, top: fits ? below : Math.max(edge, owner.top - gap - height) };
}
