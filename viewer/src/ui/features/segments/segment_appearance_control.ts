/**
 * The appearance of segments and whether they are touched, as a person asks for it: each change is a step of undo, one
 * of many segments too. The engine holds them for all pages, so a step takes back only what nobody has changed since.
 */
import type { Segment } from "../../../core/protocol";
import {
  askedFor,
  changedForAll,
  nameOfPart,
  partsInPlace,
  presentParts,
  shownAlone,
  type AppearanceParts,
  type SegmentAppearance,
} from "../../../core/segments/segment_appearance";
import type { PageSteps, StepOwner } from "../../state/page_steps.svelte";
import type { Session } from "../../state/session.svelte";

/** What of an appearance has a slider. */
const degrees: readonly (keyof SegmentAppearance)[] = ["opacity", "smoothing", "ambient", "specular"];

export class SegmentAppearanceControl implements StepOwner<AppearanceParts> {
  /** What was asked for and is not answered yet: the next change must not take it back. */
  private asked: Readonly<Record<number, Partial<SegmentAppearance>>> = {};
  private unanswered = 0;

  constructor(
    private readonly session: Session,
    private readonly steps: PageSteps,
  ) {}

  /** Changes one; degrees have sliders, on which a held key is one gesture. */
  change(segment: Segment, part: Partial<SegmentAppearance>): void {
    const slides = degrees.some((degree) => degree in part);
    this.step(`${nameOfPart(part)} of ${segment.name}`, { [segment.id]: part }, slides);
  }

  /** Changes all of these together. */
  changeAll(segments: readonly Segment[], part: Partial<SegmentAppearance>): void {
    const ids = new Set(segments.map(({ id }) => id));
    const parts = changedForAll(this.now.filter(({ id }) => ids.has(id)), part);
    this.step(`${nameOfPart(part)} of segments`, parts);
  }

  /** Shows one alone, or all again where it is alone already. */
  showAlone(id: number): void {
    this.step("visibility of segments", shownAlone(this.now, id));
  }

  hold(parts: AppearanceParts, instead: AppearanceParts): void {
    this.send(partsInPlace(this.now, parts, instead));
  }

  stands(parts: AppearanceParts): boolean {
    return Object.keys(partsInPlace(this.now, parts, parts)).length > 0;
  }

  /** The segments as they will be once the engine has answered. */
  private get now(): readonly Segment[] {
    return this.session.segments.map((segment) => ({ ...segment, ...this.asked[segment.id] }));
  }

  private step(name: string, after: AppearanceParts, inGesture = false): void {
    const before = presentParts(this.now, after);
    this.send(after);
    this.steps.add(this, { name, before, after }, inGesture);
  }

  private send(parts: AppearanceParts): void {
    for (const message of askedFor(this.now, parts)) {
      this.session.send(message);
    }
    const asked = Object.entries(parts).map(([id, part]) => [id, { ...this.asked[Number(id)], ...part }] as const);
    this.asked = { ...this.asked, ...Object.fromEntries(asked) };
    this.unanswered += 1;
    this.session.whenAnswered(() => {
      this.unanswered -= 1;
      if (this.unanswered === 0) {
        this.asked = {};
      }
    });
  }
}
