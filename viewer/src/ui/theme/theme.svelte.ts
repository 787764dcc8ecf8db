/**
 * Dark or light: what a person has chosen, or what the system has. The colours are in `theme.css`;
 * the picture stays dark in both, as films and monitors of radiology are.
 */
import { recall, remember } from "../state/remembered";

export type Choice = "dark" | "light" | "system";

/** What can be chosen. */
export const themes: readonly { readonly choice: Choice; readonly name: string }[] = [
  { choice: "dark", name: "Dark" },
  { choice: "light", name: "Light" },
  { choice: "system", name: "Same as the system" },
];

export class ThemeControl {
  choice = $state.raw<Choice>(sane(recall<{ choice: unknown }>("theme", { choice: "dark" }).choice));
  private systemLight = $state.raw(false);

  /** What is shown now. */
  get light(): boolean {
    return this.choice === "light" || (this.choice === "system" && this.systemLight);
  }

  choose(choice: Choice): void {
    this.choice = choice;
    remember("theme", { choice });
  }

  /** Follows the system until the returned function is called. */
  listen(): () => void {
    const query = window.matchMedia("(prefers-color-scheme: light)");
    const follow = (): void => {
      this.systemLight = query.matches;
    };
    follow();
    query.addEventListener("change", follow);
    return () => {
      query.removeEventListener("change", follow);
    };
  }
}

function sane(choice: unknown): Choice {
  return themes.find((known) => known.choice === choice)?.choice ?? "dark";
}

/** A colour of `theme.css` by its name, as it is when it is asked for: for what is drawn and not styled. */
export function themeColour(name: string): () => string {
  return () => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** The page's theme: one for all of its parts. */
export const theme = new ThemeControl();
