/**
 * What a value of a scan stands for, where nothing else tells.
 */
import type { Scan } from "../protocol";

/**
 * Upper ends of what CT tells apart [HU]; bone begins where the scan's own does. Kalender, "Computed Tomography"
 * (2011). @texts
 */
const tissues = [
  { below: -900, name: "air" },
  { below: -250, name: "lung" },
  { below: -20, name: "fat" },
  { below: 20, name: "fluid" },
] as const;

/** "fat" or "bone" of a CT in HU; of other scans only whether it is dark or bright. @texts */
export function tissueName(
  value: number,
  { unit, soft_tissue, bone }: Pick<Scan, "unit" | "soft_tissue" | "bone">,
): string {
  if (unit !== "HU") {
    const dark = soft_tissue - (bone - soft_tissue);
    return value >= bone ? "bright tissue" : value >= dark ? "tissue" : "dark";
  }
  return tissues.find(({ below }) => value < below)?.name ?? (value < bone ? "soft tissue" : "bone");
}
