/**
 * The tour: which step it is at, and whether that is done. It comes by itself at the first visit, and again when it is
 * asked for.
 */
import { isDone, since, stepNames, type StepName, type TourMoment } from "../../../core/tour/tour_steps";
import { recall, remember } from "../../state/remembered";

/** So long a step that is done says so [ms]. */
const rest = 1200;

export class TourControl {
  /** Null where there is no tour. */
  step = $state.raw<StepName | null>(null);
  /** The step was done, and the next one comes. */
  done = $state(false);
  /** Whether a person has asked for it: then its card takes the focus. */
  asked = $state(false);
  private before: TourMoment | null = null;
  private going: ReturnType<typeof setTimeout> | undefined;
  // a program that drives the page needs no tour, unless it says so
  private wanted = !recall("tour", { seen: navigator.webdriver }).seen;

  /** Begins at a step, where it was never seen. */
  offer(step: StepName): void {
    if (this.wanted && this.step === null) {
      this.begin(step);
    }
  }

  /** Begins at a step, since a person asks for it. */
  start(step: StepName): void {
    this.asked = true;
    this.begin(step);
  }

  next(): void {
    const following = stepNames[stepNames.indexOf(this.step ?? "undo") + 1];
    if (following === undefined) {
      this.leave();
    } else {
      this.begin(following);
    }
  }

  /** Ends it: it does not come by itself any more. */
  leave(): void {
    if (this.step === null) {
      return;
    }
    clearTimeout(this.going);
    this.wanted = false;
    this.asked = false;
    this.step = null;
    remember("tour", { seen: true });
  }

  /** Learns what is now. */
  follow(now: TourMoment): void {
    const { step } = this;
    if (step === null || this.done) {
      return;
    }
    this.before = since(this.before ?? now, now);
    if (isDone(step, this.before, now)) {
      this.done = true;
      this.going = setTimeout(() => {
        this.next();
      }, rest);
    }
  }

  private begin(step: StepName): void {
    clearTimeout(this.going);
    this.step = step;
    this.done = false;
    this.before = null;
  }
}
