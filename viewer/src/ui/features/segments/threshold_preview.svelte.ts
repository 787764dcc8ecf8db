/**
 * The range of a threshold segment while its slider is dragged, before the engine is asked.
 */
type Range = readonly [number, number];

export class ThresholdPreview {
  private shown = $state.raw<{ readonly id: number; readonly range: Range } | null>(null);

  show(id: number, range: Range): void {
    this.shown = { id, range };
  }

  /** The range that a segment is shown with; null where its slider is not dragged. */
  rangeOf(id: number): Range | null {
    return this.shown?.id === id ? this.shown.range : null;
  }

  /** Shows a segment with the engine's range again. */
  end(id: number): void {
    if (this.shown?.id === id) {
      this.shown = null;
    }
  }
}
