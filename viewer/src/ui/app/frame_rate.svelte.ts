/** Frames per second, as a number that changes once a second. */
export class FrameRate {
  perSecond = $state.raw(0);
  private frames = 0;
  private countedAt = 0;

  /** Counts a frame; `now` [ms]. */
  count(now: number): void {
    this.frames += 1;
    if (now - this.countedAt >= 1000) {
      this.perSecond = Math.round((1000 * this.frames) / (now - this.countedAt));
      this.frames = 0;
      this.countedAt = now;
    }
  }
}
