/** Cameras of a turntable: the view turning about the body's long axis. */
import { orbit, type Camera } from "../geometry/camera";

export interface Turntable {
  readonly seconds: number;
  readonly turns: number;
  readonly framesPerSecond: number;
}

/** Where the camera stands for each frame; after the last one it is back where it began. */
export function turntable(camera: Camera, { seconds, turns, framesPerSecond }: Turntable): Camera[] {
  const frames = Math.max(2, Math.round(seconds * framesPerSecond));
  return Array.from({ length: frames }, (_, i) => orbit(camera, (2 * Math.PI * turns * i) / frames, 0));
}
