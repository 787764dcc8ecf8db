/**
 * Saves the scene with the view that this page has of it, and takes the view of one that was opened.
 */
import { saneCamera, type Camera } from "../../../core/geometry/camera";
import type { Scan } from "../../../core/protocol";
import { isPoint, type Vec3 } from "../../../core/geometry/vector";
import { apiAddress } from "../../../live/connection";
import { fetchFile, tellSaved } from "../../state/download";
import { handOver, takeHandover } from "../../state/page_handover";
import { bringLayout, keptLayout, recall, remember } from "../../state/remembered";
import type { Session } from "../../state/session.svelte";

/** What of the page a scene's file keeps and brings back. */
interface KeptPage {
  readonly open: (scan: Scan) => Promise<void>;
  readonly view: { camera: Camera | null };
  readonly slices: { readonly crosshair: Vec3 | null; readonly goTo: (point: Vec3) => void };
}

export class SceneKeeper {
  saving = $state.raw(false);
  /** The scan goes into the file, which then stands alone. */
  withScan = $state.raw(recall("scene", { withScan: false }).withScan);

  /** What the page before this one had shown when its engine ended; null where there was none. */
  private passed = takeHandover();
  /** The view of the opened scene, on its way from the beginning on: a page takes it once. */
  private asked: Promise<Response> | null;

  constructor(
    private readonly session: Session,
    private readonly page: KeptPage,
  ) {
    this.asked = fetch(apiAddress("/api/view"));
    // whoever takes it sees the error
    this.asked.catch(() => undefined);
  }

  chooseWithScan(on: boolean): void {
    this.withScan = on;
    remember("scene", { withScan: on });
  }

  /** Has the engine make the scene's file, and the browser keep it. */
  async save(): Promise<void> {
    const { scan } = this.session;
    if (scan === null || this.saving) {
      return;
    }
    this.saving = true;
    try {
      const view = this.viewNow;
      const { name } = await fetchFile("/api/scene", { view, copy: this.withScan }, "scene.palpate");
      tellSaved(this.session, name);
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      this.session.notify("error", `The scene was not saved: ${reason}`);
    } finally {
      this.saving = false;
    }
  }

  /** Keeps the view for the page that takes the place of this one once the engine is back. */
  passOn(): void {
    const { scan } = this.session;
    if (scan !== null) {
      handOver({ scan: scan.identity, view: this.viewNow });
    }
  }

  /** Whether this page goes on with a scan that was open when the engine ended. */
  goesOnWith(scan: Scan | null): boolean {
    return this.passed !== null && scan !== null && this.passed.scan === scan.identity;
  }

  /** Opens a scan, the first time as the scene that was opened has it, or the page before has shown it. */
  async open(scan: Scan): Promise<void> {
    const saved = await this.view();
    const view = this.goesOnWith(scan) ? { ...this.passed?.view } : saved;
    bringLayout(view["remembered"]);
    await this.page.open(scan);
    const camera = saneCamera(view["camera"]);
    if (camera !== null) {
      this.page.view.camera = camera;
    }
    const crosshair = view["crosshair"];
    if (isPoint(crosshair)) {
      this.page.slices.goTo(crosshair);
    }
  }

  /** What this page shows, as scenes keep it. */
  get viewNow(): Record<string, unknown> {
    const { slices, view } = this.page;
    return { camera: view.camera, crosshair: slices.crosshair, remembered: keptLayout() };
  }

  private async view(): Promise<Record<string, unknown>> {
    const { asked } = this;
    if (asked === null) {
      return {};
    }
    this.asked = null;
    const answer = await asked;
    const told: unknown = answer.status === 200 ? await answer.json() : {};
    return typeof told === "object" && told !== null ? { ...told } : {};
  }
}
