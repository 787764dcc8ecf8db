/**
 * The direction in which the needle goes in: that of the push, or one that is set and follows the planned path or the
 * view. Scene.
 */
import type { Camera } from "../../../core/geometry/camera";
import { distance, normalize, scale, subtract, type Vec3 } from "../../../core/geometry/vector";
import type { State } from "../../../core/protocol";
import type { NeedlePlan } from "../../../core/tools/needle_plan";
import type { Session } from "../../state/session.svelte";

/** What the direction follows. */
export type Follows = "push" | "plan" | "view";

export const followed: readonly Follows[] = ["push", "plan", "view"];

/** Directions that differ by less are one: the engine makes them of length 1 anew. */
const same = 1e-6;

export class NeedleDirectionControl {
  /** What the person has chosen; null as long as nobody has on this page, or another page has set it since. */
  private chosen = $state.raw<Follows | null>(null);
  /** The direction that was sent last, and to which engine; undefined before the first. */
  private sent: Vec3 | null | undefined = undefined;
  private sentTo = 0;
  /** Whether the engine has told the one that was sent. */
  private confirmed = false;

  constructor(
    private readonly session: Session,
    private readonly guide: { readonly plan: NeedlePlan | null },
    private readonly camera: () => Camera | null,
  ) {
    session.onState((state) => {
      this.follow(state);
    });
  }

  /** What it follows; null where the direction was set elsewhere, such as by a script. */
  get follows(): Follows | null {
    const set = this.session.live?.needle.set_direction ?? null;
    return this.chosen ?? (set === null ? "push" : null);
  }

  /** Whether there is a planned path to follow. */
  get hasPlan(): boolean {
    return this.guide.plan !== null;
  }

  choose(follows: Follows): void {
    this.chosen = follows;
    this.tell();
  }

  private follow({ needle: { set_direction: told } }: State): void {
    if (this.chosen === null) {
      return;
    }
    const isOurs = this.sent !== undefined && areSame(told, this.sent);
    const isSameEngine = this.sentTo === this.session.greetings;
    if (this.confirmed && !isOurs && isSameEngine) {
      this.chosen = null;
      this.confirmed = false;
      return;
    }
    this.confirmed = isOurs;
    this.tell();
  }

  /** Sends the direction where it is another one now. */
  private tell(): void {
    if (this.chosen === "plan" && this.guide.plan === null) {
      this.chosen = "push";
    }
    const wanted = this.wanted();
    if (this.sent !== undefined && areSame(wanted, this.sent) && this.sentTo === this.session.greetings) {
      return;
    }
    this.sent = wanted;
    this.sentTo = this.session.greetings;
    this.confirmed = false;
    this.session.send({ type: "needle_direction", direction: wanted });
  }

  private wanted(): Vec3 | null {
    const { plan } = this.guide;
    const camera = this.camera();
    switch (this.chosen) {
      case "plan":
        return plan === null ? null : normalize(subtract(plan[0], plan[1]));
      case "view":
        return camera === null ? null : scale(camera.back, -1);
      default:
        return null;
    }
  }
}

function areSame(one: Vec3 | null, other: Vec3 | null): boolean {
  return one === null || other === null ? one === other : distance(one, other) < same;
}
