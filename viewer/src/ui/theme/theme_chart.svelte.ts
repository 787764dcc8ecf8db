/** Charts that ask for their colours with every drawing follow the theme. */
import type uPlot from "uplot";
import { theme } from "./theme.svelte";

/**
 * Draws a chart again as soon as the theme is another: by the next frame its colours are there. To be called while a
 * component is made.
 */
export function followTheme(plot: () => uPlot | null): void {
  $effect(() => {
    void theme.light;
    const frame = requestAnimationFrame(() => plot()?.redraw(false, true));
    return () => {
      cancelAnimationFrame(frame);
    };
  });
}
