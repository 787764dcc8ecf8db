/**
 * Where a click in a slice goes: to a pair of points, a mark or a region that waits for it; else it says what is there.
 */
import type { SliceClicks } from "../features/slices/slice_input";
import type { Stage } from "./stage";

export function sliceClicks({ growing, marks, picker, readout, registration }: Stage): SliceClicks {
  return {
    get marking() {
      return marks.placing !== null || registration.placing !== null;
    },
    get area() {
      return marks.drawsArea ? marks : null;
    },
    get growing() {
      return growing.armed;
    },
    put: (point) => {
      if (registration.placing !== null) {
        registration.put(point);
      } else if (marks.placing !== null) {
        marks.put(point);
      } else if (growing.armed) {
        growing.from(point);
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
