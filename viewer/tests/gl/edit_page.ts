/**
 * Runs in the browser: edits a picture, and tells what was sent to the GPU.
 */
import { brickRanges, labelledBricks } from "../../src/core/scan/bricks";
import { lookFrom } from "../../src/core/geometry/camera";
import type { Changed, Segment, SegmentSurface } from "../../src/core/protocol";
import type { Vec3 } from "../../src/core/geometry/vector";
import { ShownEdits } from "../../src/ui/features/scan/shown_edits.svelte";
import { segment } from "../support/volumes";
import { fieldOf, appearanceOf, outlineOf, viewport, type MarchTest } from "./scenes_page";
import { finished, pictureOf } from "./screen_page";

/** An edit of a picture: a box of voxels gets a value and a label, a surface other patches. */
export interface EditTest {
  readonly scan: MarchTest;
  readonly low: Vec3;
  readonly high: Vec3;
  readonly value: number | null;
  readonly label: number | null;
  /** Of the segments, in the order of their ids. */
  readonly appearances: readonly Partial<Segment>[];
  readonly before?: readonly SegmentSurface[];
  readonly surfaces?: readonly SegmentSurface[];
}

export interface EditResult {
  readonly before: number[];
  readonly after: number[];
  /** The same, drawn by a new picture from what the page holds after the edit. */
  readonly afresh: number[];
  /** Boxes that were sent to 3-D textures by the edit: x, y, z, width, height, depth. */
  readonly uploads: readonly (readonly number[])[];
  /** Calls that sent whole textures or buffers. */
  readonly buffers: number;
  readonly complaints: readonly string[];
  readonly milliseconds: number | null;
}

export async function edit(test: EditTest): Promise<EditResult> {
  const complaints: string[] = [];
  const edits = new ShownEdits({
    complain: (text) => complaints.push(text),
    download: ({ dimensions }) => {
      const ids = new Uint8Array(dimensions[0] * dimensions[1] * dimensions[2]);
      return Promise.resolve({ ids, dimensions, bricks: labelledBricks(ids, dimensions) });
    },
  });
  const volume = fieldOf(test.scan);
  const held = { volume, bricks: brickRanges(volume) };
  const extent = outlineOf(test.scan);
  const segments = test.appearances.map((appearance, i) => ({ ...segment, id: i + 1, ...appearance }));
  const open = (): ReturnType<typeof pictureOf> => {
    const drawn = pictureOf(false);
    drawn.picture.contents.setScan(volume, held.bricks);
    drawn.picture.contents.setAppearance(appearanceOf(test.scan));
    drawn.picture.setCamera(lookFrom(test.scan.from, extent, viewport), extent);
    edits.showAll(drawn.picture);
    drawn.picture.contents.setSegments(segments);
    return drawn;
  };
  const changed = (part: Partial<Changed>): Changed => ({
    type: "changed",
    edit: 1,
    applied: null,
    voxels: [],
    surfaces: [],
    displaced: null,
    ...part,
  });
  edits.add(changed({ surfaces: test.before ?? [] }), performance.now());
  edits.show(held, null);
  if (test.label !== null) {
    // no voxel has a label yet
    await edits.showLabels(1, volume, () => null);
  }
  const drawn = open();
  const before = await finished(drawn);

  const count = test.high.reduce((product, end, axis) => product * (end - (test.low[axis] ?? 0)), 1);
  const { value, label } = test;
  edits.add(
    changed({
      voxels: [
        {
          low: test.low,
          high: test.high,
          stored: value === null ? null : new Uint8Array(new Int16Array(count).fill(value).buffer),
          labels: label === null ? null : new Uint8Array(count).fill(label),
        },
      ],
      surfaces: test.surfaces ?? [],
    }),
    performance.now(),
  );
  const watched = watchUploads(drawn.gl);
  edits.show(held, drawn.picture);
  const { uploads, buffers } = watched();
  const after = await finished(drawn);
  drawn.picture.dispose();
  const again = open();
  const afresh = await finished(again);
  again.picture.dispose();
  return { before, after, afresh, uploads, buffers, complaints, milliseconds: edits.lastMilliseconds };
}

/** Notes what is sent to 3-D textures and buffers until the returned function is called. */
function watchUploads(gl: WebGL2RenderingContext): () => { uploads: number[][]; buffers: number } {
  const uploads: number[][] = [];
  let buffers = 0;
  const { texSubImage3D, bufferData } = gl;
  gl.texSubImage3D = (...call: unknown[]): void => {
    // target, level, then the box
    uploads.push(call.slice(2, 8) as number[]);
    texSubImage3D.apply(gl, call as Parameters<typeof texSubImage3D>);
  };
  gl.bufferData = (...call: unknown[]): void => {
    buffers += 1;
    (bufferData as (...call: unknown[]) => void).apply(gl, call);
  };
  return () => {
    Object.assign(gl, { texSubImage3D, bufferData });
    return { uploads, buffers };
  };
}
