/**
 * Who draws the 3-D view, as a person has chosen it; remembered. And who does now, and why.
 */
import {
  engineObstacle,
  saneDrawer,
  wantsEngine,
  type DrawerChoice,
  type ShownThings,
} from "../../../core/appearance/who_draws";
import { recall, remember } from "../../state/remembered";

export class DrawerControl {
  choice = $state.raw<DrawerChoice>(saneDrawer(recall("drawer", { choice: "auto" }).choice));
  /** Why the engine does not draw though it should; null where it does or should not. */
  obstacle = $state.raw<string | null>(null);

  /** @param software whether the CPU draws in this browser. */
  constructor(private readonly software: boolean) {}

  get wantsEngine(): boolean {
    return wantsEngine(this.choice, this.software);
  }

  /** Whether the engine draws. */
  get engineDraws(): boolean {
    return this.wantsEngine && this.obstacle === null;
  }

  choose(choice: DrawerChoice): void {
    this.choice = choice;
    remember("drawer", { choice });
  }

  /** Takes what is shown now; tells whether the engine draws it. */
  follow(shown: ShownThings): boolean {
    const obstacle = this.wantsEngine ? engineObstacle(shown) : null;
    if (obstacle !== this.obstacle) {
      this.obstacle = obstacle;
    }
    return this.engineDraws;
  }
}
