/**
 * Tells steps of undo where gestures end: a press of the mouse or a key begins another one, and a control that was
 * let go has ended its own. A key that is held goes on.
 */
import type { PageSteps } from "../../state/page_steps.svelte";

/** Listens until the returned function is called. */
export function followGestures(steps: PageSteps): () => void {
  const aborter = new AbortController();
  // before what is pressed takes it
  const when = { signal: aborter.signal, capture: true };
  const end = (): void => {
    steps.endGesture();
  };
  window.addEventListener("pointerdown", end, when);
  window.addEventListener("change", end, when);
  window.addEventListener(
    "keydown",
    ({ repeat }) => {
      if (repeat) steps.resumeGesture();
      else steps.endGesture();
    },
    when,
  );
  return () => {
    aborter.abort();
  };
}
