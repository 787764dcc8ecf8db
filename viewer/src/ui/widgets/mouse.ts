/**
 * What presses and turns of the mouse mean, for everything that is clicked, dragged or scrolled in the picture.
 */

/** A press that moved by less is a click [CSS pixels]. */
export const clickReach = 4;

/** Pixels of a wheel event, which may count lines or pages. */
export function wheelPixels(event: WheelEvent): number {
  // with Shift held some browsers turn the wheel into a sideways one
  const delta = event.deltaY === 0 ? event.deltaX : event.deltaY;
  const unit =
    event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 400 : 1;
  return Math.max(-400, Math.min(400, delta * unit));
}
