/**
 * Tells when the GPU has finished what it was given, and how long that took [ms].
 */
const pollMilliseconds = 3;

export class GpuClock {
  private fence: WebGLSync | null = null;

  constructor(private readonly gl: WebGL2RenderingContext) {}

  /** Work is under way. */
  get busy(): boolean {
    return this.fence !== null;
  }

  /** Starts the clock after commands were issued; calls back once they are done. */
  start(done: (milliseconds: number) => void): void {
    const fence = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (fence === null) {
      // the context is lost
      return;
    }
    this.fence = fence;
    this.gl.flush();
    const begun = performance.now();
    const poll = (): void => {
      if (this.fence !== fence) {
        return;
      }
      if (this.gl.getSyncParameter(fence, this.gl.SYNC_STATUS) !== this.gl.SIGNALED) {
        setTimeout(poll, pollMilliseconds);
        return;
      }
      this.forget();
      done(performance.now() - begun);
    };
    setTimeout(poll, 0);
  }

  /** Forgets what is under way. */
  forget(): void {
    if (this.fence !== null) {
      this.gl.deleteSync(this.fence);
      this.fence = null;
    }
  }
}
