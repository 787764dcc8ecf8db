/**
 * Who draws the 3-D view, as a person has chosen it; remembered. And who does now, and why.
 */
import { QuickerDrawer, type Drawer } from "../../../core/drawing/quicker_drawer";
import {
  engineObstacle,
  retrySeconds,
  saneDrawer,
  wantsEngine,
  type DrawerChoice,
  type EngineReach,
} from "../../../core/drawing/who_draws";
import { recall, remember } from "../../state/remembered";

/** Between two looks at what was measured, and at who is to be measured [ms]. */
const lookMilliseconds = 1000;

export class DrawerControl {
  choice = $state.raw<DrawerChoice>(saneDrawer(recall("drawer", { choice: "auto" }).choice));
  /** Why the engine does not draw though it should; null where it does or should not. */
  obstacle = $state.raw<string | null>(null);
  /** Why the one draws that does, where that was not a person's choice. */
  reason = $state.raw<string | null>(null);
  readonly quicker = new QuickerDrawer();
  private drawer = $state.raw<Drawer>("engine");
  private lookedAt = -Infinity;
  private retriedAt = -Infinity;

  /** @param software whether the CPU draws in this browser. */
  constructor(private readonly software: boolean) {}

  get wantsEngine(): boolean {
    return wantsEngine(this.choice, this.software, this.drawer);
  }

  /** Whether the engine draws. */
  get engineDraws(): boolean {
    return this.wantsEngine && this.obstacle === null;
  }

  choose(choice: DrawerChoice): void {
    this.choice = choice;
    this.lookedAt = -Infinity;
    this.retriedAt = -Infinity;
    remember("drawer", { choice });
  }

  /** Takes whether there is an engine that draws; tells whether it does. */
  follow(reach: EngineReach): boolean {
    const obstacle = this.wantsEngine ? engineObstacle(reach) : null;
    if (obstacle !== this.obstacle) {
      this.obstacle = obstacle;
    }
    return this.engineDraws;
  }

  /**
   * Goes by what was measured; tells whose picture is to be timed now, or tried again.
   *
   * @param failed the engine's pictures do not come.
   */
  look(now: number, failed: boolean): Drawer | null {
    if (now - this.lookedAt < lookMilliseconds) {
      return null;
    }
    this.lookedAt = now;
    const isMeasured = this.choice === "auto" && this.software;
    this.drawer = this.quicker.drawer;
    this.reason = isMeasured ? this.quicker.reason : this.choice === "auto" ? "this browser has a graphics card" : null;
    if (failed) {
      if (!this.wantsEngine || now - this.retriedAt < 1000 * retrySeconds) {
        return null;
      }
      this.retriedAt = now;
      return "engine";
    }
    this.retriedAt = now;
    return isMeasured ? this.quicker.due : null;
  }
}
