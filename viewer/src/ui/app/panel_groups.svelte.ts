/**
 * The groups of the left panel, by what people do: one of them is shown at a time.
 */
import { recall, remember } from "../state/remembered";

export const groups = [
  { name: "scan", title: "Scan" },
  { name: "segments", title: "Segments" },
  { name: "view", title: "View" },
  { name: "marks", title: "Marks" },
] as const;
export type Group = (typeof groups)[number]["name"];

export class PanelGroups {
  shown = $state.raw<Group>(sane(recall<{ shown: unknown }>("group", { shown: "scan" }).shown));

  show(group: Group): void {
    this.shown = group;
    remember("group", { shown: group });
  }
}

function sane(kept: unknown): Group {
  return groups.find(({ name }) => name === kept)?.name ?? "scan";
}
