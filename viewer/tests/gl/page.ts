/**
 * Runs in the browser: what the tests ask of it.
 */
import { arriving } from "./arriving_page";
import { edit } from "./edit_page";
import { errorOf, reading, usualFilter } from "./formats_page";
import { light } from "./light_page";
import { march } from "./march_page";
import { programs } from "./programs_page";
import {
  bored,
  hasty,
  refined,
  resizedEyes,
  resizedMiddle,
  screen,
  show,
  steps,
  turned,
  withoutFrames,
} from "./screen_page";
import { second } from "./second_page";
import { cancelled, snapshot } from "./snapshot_page";
import { coarseLevel, detailed, drawnTriangles, embodied } from "./surface_page";
import { timed } from "./timed_page";

const glTests = {
  ...{ arriving, programs, march, light, second, screen, show, hasty, snapshot, cancelled },
  ...{ refined, resizedEyes, resizedMiddle, edit, drawnTriangles, coarseLevel, detailed, embodied, turned },
  ...{ reading, errorOf, usualFilter, bored, steps, withoutFrames, timed },
};

declare global {
  interface Window {
    glTests?: typeof glTests;
  }
}

window.glTests = glTests;
