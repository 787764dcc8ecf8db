/**
 * Brings changes of the page's and the engine's state to the picture. Each effect follows what it names first; what it
 * starts then is not followed.
 */
import { untrack } from "svelte";
import type { Session } from "../state/session.svelte";
import type { Stage } from "./stage";

/** To be called while the component is made that holds the stage. */
export function followScene(session: Session, stage: Stage): void {
  $effect(() => {
    const { appearance } = stage.scene;
    untrack(() => {
      stage.picture.setAppearance(appearance);
    });
  });
  $effect(() => {
    const { segments } = stage.scene;
    void stage.scene.inside;
    untrack(() => {
      stage.picture.setSegments(segments);
    });
  });
  $effect(() => {
    void session.segments;
    void session.labels;
    untrack(() => {
      stage.showLabels();
    });
  });
  $effect(() => {
    const { shown } = stage.player;
    if (shown !== null) {
      untrack(() => {
        stage.followPlayed(shown);
      });
    }
  });
}
