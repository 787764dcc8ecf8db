/**
 * All that makes the picture, put together: the controls, the scan, and what is drawn on the canvas. Joins the
 * engine's state (`Session`) with the GPU (`Picture`). Features are given single controls of it.
 */
import type { Scan } from "../../core/protocol";
import type { ShownTouch } from "../../core/touch/shown_touch";
import { downloadLabels } from "../../live/volume_download";
import { MarkVisibility } from "../features/marks/mark_visibility.svelte";
import { ScanLoader } from "../features/scan/scan_loader.svelte";
import { ShownEdits } from "../features/scan/shown_edits.svelte";
import { ImageControl } from "../features/view/image_control.svelte";
import { makeControls, type Controls, type Surroundings } from "./controls";
import { DrawnScene } from "./drawn_scene.svelte";
import { Picker } from "./picker";
import { PictureHost } from "./picture_host.svelte";
import { ScanOpener } from "./scan_opener";

/**
 * How a large scan is shown while it arrives: where the CPU draws, that takes of the time in which the whole one
 * could be there.
 */
const shownParts = { gpu: { parts: 8, soon: 1000 }, software: { parts: 4, soon: 4000 } } as const;

/** What is shown of the scan, and where it is drawn. */
interface Shown {
  /** The scan, on its way or here. */
  readonly loader: ScanLoader;
  /** Edits of the voxels, and the surfaces of segments. */
  readonly edits: ShownEdits;
  /** Segments and appearance as the picture shall show them. */
  readonly scene: DrawnScene;
  /** What is where in the picture. */
  readonly picker: Picker;
  /** Which marks something stands before. */
  readonly markVisibility: MarkVisibility;
  /** The picture on its canvas. */
  readonly picture: PictureHost;
  /** Pictures and animations of it as files. */
  readonly images: ImageControl;
}

/** What concerns several controls at once. */
interface JointActs {
  /** Downloads a scan and shows it. */
  readonly open: (scan: Scan) => Promise<void>;
  /** Shows the segments that are no threshold, by the engine's latest labels. */
  readonly showLabels: () => void;
  /** Takes the slices and the line of the way along with a scenario's tool. */
  readonly followPlayed: (shown: ShownTouch) => void;
  /** Takes the brush and shows slices to paint in, or puts it away. */
  readonly toggleBrush: () => void;
  /** Waits for a loop on the picture, whatever the mouse was to do before. */
  readonly takeScissors: () => void;
  /** Waits for clicks on pairs of points, and shows slices to set them in. */
  readonly placePairs: () => void;
  /** Waits for clicks on target and entry of a needle, and shows slices to set them in. */
  readonly planPath: () => void;
  /** Moves the picture so that the probe is in its middle. */
  readonly centreOnProbe: () => void;
}

export interface Stage extends Controls, Shown, JointActs {}

export function makeStage(surroundings: Surroundings): Stage {
  const controls = makeControls(surroundings);
  const edits = makeEdits(surroundings);
  const scene = new DrawnScene(surroundings.session, { ...controls, edits });
  const { opener, ...shown } = drawScene(surroundings, controls, { edits, scene });
  const stage = { ...controls, ...shown, ...jointActs(surroundings, controls, opener) };
  listen(surroundings, stage);
  return stage;
}

function makeEdits({ session }: Surroundings): ShownEdits {
  return new ShownEdits({
    complain: (text) => {
      session.notify("error", text);
    },
    download: downloadLabels,
  });
}

/** The scan on its way to the canvas, and what can be found in the picture. */
function drawScene(
  { session, support }: Surroundings,
  controls: Controls,
  made: Pick<Shown, "edits" | "scene">,
): Shown & { readonly opener: ScanOpener } {
  const loader: ScanLoader = new ScanLoader({
    largestEdge: support.largestEdge,
    preview: (volume, bricks, scan) => opener.preview(volume, bricks, scan),
    refine: (volume, { bricks, arrived }) => {
      picture.drawn?.contents.refineScan(volume, bricks, arrived);
    },
    shownParts: support.software ? shownParts.software : shownParts.gpu,
    show: (held, scan) => {
      opener.show(held, scan);
    },
    warn: (text) => {
      session.notify("warning", text);
    },
  });
  const parts = { ...controls, ...made, session, loader };
  const picker = new Picker(parts, session);
  const markVisibility = new MarkVisibility(controls.marks, picker.hides.bind(picker));
  const picture: PictureHost = new PictureHost({ ...parts, markVisibility }, support);
  const images = new ImageControl({ ...controls, session, pane: () => controls.slices.savedPane, picture });
  const opener = new ScanOpener({ ...parts, picture });
  return { ...made, loader, picker, markVisibility, picture, images, opener };
}

function jointActs({ session }: Surroundings, controls: Controls, opener: ScanOpener): JointActs {
  const { brush, cutting, growing, marks, registration, scissors, slices, touch, view } = controls;
  return {
    open: (scan) => opener.open(scan),
    showLabels: () => {
      opener.showLabels();
    },
    followPlayed: ({ time, proxy }) => {
      touch.add(time, proxy);
      if (slices.habits.follows) {
        slices.goTo(proxy);
      }
    },
    toggleBrush: () => {
      brush.arm(!brush.armed);
      if (brush.armed) {
        slices.reveal();
      }
    },
    takeScissors: () => {
      cutting.cancel();
      marks.cancel();
      growing.armed = false;
      brush.escape();
      scissors.start();
    },
    placePairs: () => {
      marks.cancel();
      growing.armed = false;
      registration.startPair();
      slices.reveal();
    },
    planPath: () => {
      growing.armed = false;
      registration.cancel();
      marks.start("path");
      slices.reveal();
    },
    centreOnProbe: () => {
      const { latest } = session;
      if (latest !== null) {
        view.centreOn(latest.proxy);
      }
    },
  };
}

/** Takes what the engine reports. */
function listen({ session }: Surroundings, stage: Stage): void {
  const { edits, picture, player, registration, second, slices, touch } = stage;
  session.onSecond((report) => {
    registration.follow(report.scan?.identity ?? null);
    void second.take(report);
  });
  session.onRegistration((report) => {
    registration.take(report);
  });
  session.onChanged((changed, arrived) => {
    edits.add(changed, arrived);
    picture.takeEdits();
  });
  session.onState((state) => {
    if (!player.showing) {
      touch.add(state.time, state.proxy);
      slices.follow(state.proxy);
    }
  });
}
