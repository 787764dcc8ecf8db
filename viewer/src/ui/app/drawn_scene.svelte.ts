/**
 * What the picture shall show of the scan and its segments, as the engine's state and the page's controls have it.
 */
import type { Appearance } from "../../core/appearance/appearance";
import { KeepEqual } from "../../core/base/keep_equal";
import type { Segment } from "../../core/protocol";
import { drawnKey, LastRanges, rangesInside, showable, shownRanges } from "../../core/segments/shown_segments";
import type { AppearanceControl } from "../features/appearance/appearance_control.svelte";
import type { ShownEdits } from "../features/scan/shown_edits.svelte";
import type { ThresholdPreview } from "../features/segments/threshold_preview.svelte";
import type { Session } from "../state/session.svelte";

/** What a scene is made from beside the engine's state. */
interface Sources {
  readonly appearance: AppearanceControl;
  readonly thresholdPreview: ThresholdPreview;
  readonly edits: ShownEdits;
}

export class DrawnScene {
  private readonly lastRanges = new LastRanges();
  private readonly sameSegments = new KeepEqual<readonly Segment[]>();
  private readonly sameAppearance = new KeepEqual<Appearance>();

  constructor(
    private readonly session: Session,
    private readonly sources: Sources,
  ) {}

  /** Segments as the picture can show them now. */
  readonly segments = $derived.by((): readonly Segment[] => {
    const { edits, thresholdPreview } = this.sources;
    const { awaitsLabels } = edits;
    const segments = this.session.segments.map((segment) =>
      showable(
        this.lastRanges.stand(segment, awaitsLabels),
        edits.sizes.has(segment.id),
        thresholdPreview.rangeOf(segment.id),
      ),
    );
    // each edit tells of other numbers of voxels, and the picture is hardly ever another one by that
    return this.sameSegments.of(segments, drawnKey(segments));
  });

  /** The appearance that the page's controls ask for; null before there is a scan. */
  readonly appearance = $derived.by((): Appearance | null => {
    const { scan } = this.session;
    const { parts, inside } = this.sources.appearance;
    if (scan === null || parts === null) {
      return null;
    }
    const ranges = rangesInside(shownRanges(this.segments, scan), inside);
    const appearance = { ...parts, ranges };
    return this.sameAppearance.of(appearance, JSON.stringify(appearance));
  });
}
