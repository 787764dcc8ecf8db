/**
 * Where a click in a slice goes: to a pair of points or a mark that waits for it; else it says what is there. A press
 * goes to a region that is to grow.
 */
import type { SliceClicks } from "../../features/slices/slice_input";
import type { Stage } from "../stage";

export function sliceClicks({ growing, marks, picker, readout, registration }: Stage): SliceClicks {
  return {
    get marking() {
      return marks.placing !== null || registration.placing !== null;
    },
    get area() {
      return marks.drawsArea ? marks : null;
    },
    growing,
    put: (point) => {
      if (registration.placing !== null) {
        registration.put(point);
      } else if (marks.placing !== null) {
        marks.put(point);
      } else {
        return false;
      }
      return true;
    },
    describe: (pane, point) => {
      const name = picker.segmentAt(point)?.name ?? null;
      readout.show({ pane, point, value: picker.valueAt(point), name, scan: "first" });
    },
    close: () => {
      readout.close();
    },
  };
}
