/**
 * Controls that show what is: the browser shows what a person asked for at once, also where that is refused, or taken
 * back before the page is drawn anew, which then finds nothing to change.
 */

/** Until an answer of the engine is there, nearly always [ms]; a control does not jump to and fro meanwhile. */
const patience = 1000;

/** Has a control show what is, some time after it was used, if it is still on the page. */
export function revertInput(control: HTMLElement, show: () => void): void {
  setTimeout(() => {
    if (control.isConnected) show();
  }, patience);
}
