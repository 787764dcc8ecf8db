/** Puts a popover beside its button, on the side where there is more room. */
export function placePopover(popover: HTMLElement, button: Element): void {
  const { left, right, top, bottom } = button.getBoundingClientRect();
  const { innerWidth, innerHeight } = window;
  const fromLeft = left < innerWidth / 2;
  const below = top < innerHeight / 2;
  const zoom = Number(getComputedStyle(popover).zoom);
  const pixels = (length: number): string => `${String(Math.max(12, length) / zoom)}px`;
  popover.style.left = fromLeft ? pixels(left) : "auto";
  popover.style.right = fromLeft ? "auto" : pixels(innerWidth - right);
  popover.style.top = below ? pixels(bottom + 8) : "auto";
  popover.style.bottom = below ? "auto" : pixels(innerHeight - top + 8);
}
