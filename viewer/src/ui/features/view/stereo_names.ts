/** What the ways of stereo are called on the page. */
import type { StereoMode } from "../../../core/view/stereo";

export const stereoNames: Readonly<Record<StereoMode, { readonly name: string; readonly title: string }>> = {
  off: { name: "One, no stereo", title: "One picture for both eyes" },
  anaglyph: { name: "Red–cyan anaglyph", title: "Both pictures in one, for glasses that are red at the left and cyan at the right" },
  side: { name: "Side by side", title: "The left eye's picture beside the right eye's" },
  stacked: { name: "Top–bottom", title: "The left eye's picture above the right eye's" },
};
