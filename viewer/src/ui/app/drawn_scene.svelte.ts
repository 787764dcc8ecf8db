/**
 * What the picture shall show of the scan and its segments, as the engine's state and the page's controls have it.
 */
import type { Appearance } from "../../core/appearance/appearance";
import { insideBeside, lookBeside, withoutUnfelt } from "../../core/appearance/felt_look";
import { KeepEqual } from "../../core/base/keep_equal";
import type { Segment } from "../../core/protocol";
import {
  drawnKey,
  LastRanges,
  rangesInside,
  showable,
  shownRanges,
  type InsideModes,
} from "../../core/segments/shown_segments";
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
    const shown = withoutUnfelt(segments, this.sources.appearance.unfelt);
    return this.sameSegments.of(shown, drawnKey(shown));
  });

  /** How the voxels of each look inside the volume. */
  readonly inside = $derived.by((): InsideModes => {
    const { inside, unfelt } = this.sources.appearance;
    return insideBeside(inside, unfelt);
  });

  /** The appearance that the page's controls ask for; null before there is a scan. */
  readonly appearance = $derived.by((): Appearance | null => {
    const { scan } = this.session;
    const { parts, unfelt } = this.sources.appearance;
    if (scan === null || parts === null) {
      return null;
    }
    const { inside, segments } = this;
    const ranges = rangesInside(shownRanges(segments, scan), inside);
    const look = lookBeside(parts, scan, { segments, modes: inside, choice: unfelt });
    const appearance = { ...look, ranges };
    return this.sameAppearance.of(appearance, JSON.stringify(appearance));
  });
}
