/**
 * What is looked for in the settings: each setting asks whether it is meant.
 */
import { getContext, setContext } from "svelte";
import { isMeant, settings, type SettingName } from "../../core/base/settings";

const key = Symbol("settings");

export class SettingSearch {
  typed = $state("");

  finds(name: SettingName): boolean {
    return isMeant(settings[name], this.typed);
  }
}

/** Gives the search to all settings in a component. */
export function offerSearch(search: SettingSearch): void {
  setContext(key, search);
}

export function searchAround(): SettingSearch {
  return getContext<SettingSearch>(key);
}
