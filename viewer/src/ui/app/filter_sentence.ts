/**
 * What the status bar tells of how the scan's values come to the picture.
 */
import type { FieldFilter } from "../../gl/march/field_filter";
import type { FieldFormat } from "../../gl/textures/field_texture";

const formats: Readonly<Record<FieldFormat, string>> = {
  r16: "The graphics interpolate the scan from 16-bit texels",
  rg8: "The graphics interpolate the scan from pairs of bytes",
  r32f: "The graphics interpolate the scan from floats, which take twice the memory",
  texels: "The page interpolates the scan itself, which takes twice as long",
};

/** One sentence, with the reason where the usual formats were not exact. */
export function toldOf({ format, errors }: FieldFilter): string {
  const refused = Object.entries(errors).filter(([tried]) => tried !== format);
  const off = refused.map(([, error]) => error.toFixed(0));
  const reason = off.length === 0 ? "" : `: measured otherwise, values are off by up to ${off.join(" and ")} of 65 536`;
  return `${formats[format]}${reason}.`;
}
