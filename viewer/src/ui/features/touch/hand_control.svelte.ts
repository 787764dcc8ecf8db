/**
 * The hand of a person with a mouse and keys: collects its moves and tells the engine where
 * the hand is, at most once a frame.
 */
import { moveAlong, moveInDepth, moveInView } from "../../../core/touch/hand";
import type { Camera, Ray, Viewport } from "../../../core/geometry/camera";
import type { Vec3 } from "../../../core/geometry/vector";
import type { Session } from "../../state/session.svelte";
import { MouseTouch } from "./mouse_touch.svelte";

/** After a pause this long the hand is where the engine says it is [ms], as soon as it knows all moves. */
const resumeAfter = 400;

/** The view that moves of the mouse are made in. */
interface HandView {
  readonly camera: Camera | null;
  readonly viewport: Viewport;
}

export class HandControl {
  /** The mouse touches: what is pressed on, or by every move of it. */
  touchMode = $state(false);
  /** How it does that. */
  readonly mouse: MouseTouch;
  /** The person has moved the hand at least once. */
  used = $state(false);

  /** The hand moves without the probe. */
  private clutched = false;
  private hand: Vec3 | null = null;
  private movedAt = -Infinity;
  private sending = false;
  /** What is pressed on and was not sent yet. */
  private pressing: { readonly ray: Ray; readonly pressure: number } | null = null;
  /** Moves and placements that were sent, and those of them that the engine has answered. */
  private sent = 0;
  private known = 0;
  private asking = false;

  /**
   * @param takeOver has the probe follow the hand, whatever else has moved it.
   * @param drills tells whether the hand holds a drill.
   */
  constructor(
    private readonly session: Session,
    private readonly view: HandView,
    private readonly takeOver: () => void,
    drills: () => boolean,
  ) {
    this.mouse = new MouseTouch(drills);
  }

  /** Whether every move of the mouse moves the hand, no button needed. */
  get leadsByMoves(): boolean {
    return this.touchMode && this.mouse.way === "plane";
  }

  /** Moves the hand by pixels to the right, downward, and away from the viewer. */
  move(right: number, down: number, away: number): void {
    const { camera, viewport } = this.view;
    if (camera !== null) {
      this.lead((from, probe) => {
        const sideways = moveInView(from, probe, right, down, camera, viewport);
        return moveInDepth(sideways, probe, away, camera, viewport);
      });
    }
  }

  /** Moves the hand along a vector of the scene [mm]. */
  moveBy(way: Vec3): void {
    this.lead((from, probe) => moveAlong(from, probe, way));
  }

  /** Has the hand move without the probe, or with it again. */
  clutch(on: boolean): void {
    if (on !== this.clutched) {
      this.clutched = on;
      this.hand = null;
      this.session.send({ type: "clutch", on });
    }
  }

  /** Puts the hand at a point of the scene [mm]. */
  goTo(hand: Vec3): void {
    this.takeOver();
    this.hand = hand;
    this.movedAt = performance.now();
    this.used = true;
    if (!this.sending) {
      this.sending = true;
      requestAnimationFrame(() => {
        this.sending = false;
        if (this.hand !== null) {
          this.session.send({ type: "hand", target: this.hand });
          this.follow();
        }
      });
    }
  }

  /** Presses on what a ray meets first with a force [N]; the engine leads the hand meanwhile. */
  press(ray: Ray, pressure: number): void {
    this.takeOver();
    this.hand = null;
    this.used = true;
    const waiting = this.pressing !== null;
    this.pressing = { ray, pressure };
    if (!waiting) {
      requestAnimationFrame(() => {
        if (this.pressing !== null) {
          const { ray: asked, pressure: wanted } = this.pressing;
          this.pressing = null;
          this.session.send({ type: "press", origin: asked.origin, direction: asked.direction, pressure: wanted });
        }
      });
    }
  }

  /** Lifts off what is pressed on. */
  lift(): void {
    this.pressing = null;
    this.session.send({ type: "lift" });
    this.follow();
  }

  /** Brings probe, device and hand to a point, or next to it. */
  place(point: Vec3): void {
    this.takeOver();
    this.hand = null;
    this.used = true;
    this.session.send({ type: "place", point });
    this.follow();
  }

  /** Moves the hand from where it is, as far as that is known. */
  private lead(to: (from: Vec3, probe: Vec3) => Vec3): void {
    const state = this.session.latest;
    if (state === null) {
      return;
    }
    if (this.clutched || state.clutched) {
      this.hand = null;
      return;
    }
    if (this.hand === null && this.known < this.sent) {
      // where the hand was placed is not known yet
      return;
    }
    const now = performance.now();
    const rested = this.known === this.sent && now - this.movedAt > resumeAfter;
    const from = this.hand === null || rested ? state.hand : this.hand;
    this.goTo(to(from, state.proxy));
  }

  /** Learns when the engine has answered all that was sent, with one question at a time. */
  private follow(): void {
    this.sent += 1;
    this.ask();
  }

  private ask(): void {
    if (this.asking || this.known === this.sent) {
      return;
    }
    this.asking = true;
    const { sent } = this;
    this.session.whenAnswered(() => {
      this.asking = false;
      this.known = sent;
      this.ask();
    });
  }
}
