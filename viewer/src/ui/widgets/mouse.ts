/**
 * What presses and turns of the mouse mean, for everything that is clicked, dragged or scrolled in the picture.
 */

/** A press that moved by less is a click [CSS pixels]. */
export const clickReach = 4;

/** A move of two fingers on a trackpad that counts as a notch of a wheel [CSS pixels]. */
const pixelsPerNotch = 40;
/** Lines of a notch, where a browser counts those. */
const linesPerNotch = 3;
/** What `wheelDeltaY` counts for a notch, and for a pixel of a trackpad. */
const [deltaPerNotch, deltaPerPixel] = [120, 3] as const;

/** What is told of a turn of the wheel. */
type Turn = Pick<WheelEvent, "deltaX" | "deltaY" | "deltaMode" | "shiftKey"> & {
  /** Told by all browsers, though it is no standard. */
  readonly wheelDeltaY?: number;
};

const [byLines, byPages] = [1, 2] as const;

/** Pixels of a wheel event, which may count lines or pages; none of a swipe to the side. */
export function wheelPixels(event: Turn): number {
  const unit = event.deltaMode === byLines ? 33 : event.deltaMode === byPages ? 400 : 1;
  return Math.max(-400, Math.min(400, upright(event) * unit));
}

/** Notches of a wheel event: whole ones of most mice, parts of one of a trackpad; none of a swipe to the side. */
export function wheelNotches(event: Turn): number {
  const turned = upright(event);
  if (turned === 0 || event.deltaMode === byPages) {
    return Math.sign(turned);
  }
  if (event.deltaMode === byLines) {
    return Math.sign(turned) * Math.max(1, Math.round(Math.abs(turned) / linesPerNotch));
  }
  // a wheel that Shift turns sideways tells nothing of its own here
  const counted = Math.abs(event.wheelDeltaY ?? 0);
  const isTrackpad = counted === 0 || Math.abs(counted - deltaPerPixel * Math.abs(turned)) <= deltaPerPixel;
  return isTrackpad ? turned / pixelsPerNotch : (Math.sign(turned) * counted) / deltaPerNotch;
}

/** The turn that is meant up or down: with Shift held some browsers turn the wheel into a sideways one. */
function upright({ deltaX, deltaY, shiftKey }: Turn): number {
  if (shiftKey && deltaY === 0) {
    return deltaX;
  }
  return Math.abs(deltaX) > Math.abs(deltaY) ? 0 : deltaY;
}
