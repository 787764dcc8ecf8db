/**
 * How fine the 3-D view is drawn, as a person has chosen it; remembered.
 */
import { firstQuality, saneQuality, type QualityChoice } from "../../../core/view/quality";
import { recall, remember } from "../../state/remembered";

export class QualityControl {
  choice: QualityChoice;

  /** @param software whether the CPU draws. */
  constructor(software: boolean) {
    const first = firstQuality(software);
    this.choice = $state.raw(saneQuality(recall("quality", first), first));
  }

  choose(part: Partial<QualityChoice>): void {
    this.choice = { ...this.choice, ...part };
    remember("quality", this.choice);
  }
}
