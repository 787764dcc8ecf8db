/**
 * How fine the 3-D view is drawn: at rest by a choice of few, while it moves by the time of a frame.
 */

/** From quick to fine. */
export const qualities = ["fast", "balanced", "fine", "still"] as const;
export type Quality = (typeof qualities)[number];

/** A picture at rest, the same wherever it is drawn. */
export interface RestingPicture {
  /** Steps of a ray per smallest voxel edge. */
  readonly stepsPerVoxel: number;
  /** Pictures, each shifted within the pixel, that are averaged. */
  readonly passes: number;
}

export const restingPictures: Readonly<Record<Quality, RestingPicture>> = {
  fast: { stepsPerVoxel: 1, passes: 1 },
  balanced: { stepsPerVoxel: 1, passes: 4 },
  fine: { stepsPerVoxel: 2, passes: 16 },
  still: { stepsPerVoxel: 5, passes: 24 },
};

/** Whether a picture is drawn in haste: with so few steps that shade from the nearest voxels is more than they tell. */
export function isInHaste(stepsPerVoxel: number): boolean {
  return stepsPerVoxel < 2 / 3;
}

export interface QualityChoice {
  readonly quality: Quality;
  /** Time for a picture while the view moves [ms]. */
  readonly frameBudget: number;
}

/** Frame budgets that can be chosen [ms]. */
export const frameBudgets = { least: 8, most: 200 } as const;

/**
 * While the view moves thirty pictures a second by a GPU, and eight by a CPU, which are much finer then; at rest what a
 * renderer does within half a second or a few.
 */
export function firstQuality(software: boolean): QualityChoice {
  return software ? { quality: "fast", frameBudget: 110 } : { quality: "balanced", frameBudget: 33 };
}

/** A choice that was kept, where it can be one; else as it is at first. */
export function saneQuality({ quality, frameBudget }: QualityChoice, first: QualityChoice): QualityChoice {
  return {
    quality: qualities.includes(quality) ? quality : first.quality,
    frameBudget:
      frameBudget >= frameBudgets.least && frameBudget <= frameBudgets.most ? frameBudget : first.frameBudget,
  };
}
