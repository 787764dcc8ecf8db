import { beforeEach, describe, expect, it, vi } from "vitest";
import type { Segment } from "../../../../src/core/protocol";
import { SurfaceExport } from "../../../../src/ui/features/segments/surface_export.svelte";
import type * as download from "../../../../src/ui/state/download";
import { fetchFile } from "../../../../src/ui/state/download";
import type { Session } from "../../../../src/ui/state/session.svelte";

vi.mock("../../../../src/ui/state/download", async (original) => ({
  ...(await original<typeof download>()),
  fetchFile: vi.fn(),
}));

const bone = { id: 3, name: "bone" } as Segment;

function made() {
  const notices: [string, string][] = [];
  const session = { notify: (level: string, text: string) => notices.push([level, text]) } as unknown as Session;
  return { notices, surfaces: new SurfaceExport(session) };
}

describe("a surface as a file", () => {
  beforeEach(() => {
    vi.mocked(fetchFile).mockReset();
  });

  it("says what was written, and warns of what was lost", async () => {
    const notes = ["bone.stl: segment 'bone' of 2, 8 triangles", "it has 2 bodies"];
    vi.mocked(fetchFile).mockResolvedValue({ name: "bone.stl", notes });
    const { notices, surfaces } = made();
    await surfaces.save(bone);
    expect(vi.mocked(fetchFile).mock.calls).toEqual([["/api/surface", { segment: 3 }, "bone.stl"]]);
    expect(surfaces.written(3)).toBe("bone.stl: segment 'bone' of 2, 8 triangles");
    expect(surfaces.written(1)).toBeUndefined();
    expect(notices).toEqual([
      ["info", "Saved as bone.stl, with the downloads of this browser."],
      ["warning", "it has 2 bodies."],
    ]);
    expect(surfaces.busy).toBeNull();
  });

  it("says why nothing was written", async () => {
    vi.mocked(fetchFile).mockRejectedValue(new Error("segment 'bone' has no voxels"));
    const { notices, surfaces } = made();
    await surfaces.save(bone);
    expect(notices).toEqual([["error", "No surface was written: segment 'bone' has no voxels"]]);
    expect(surfaces.written(3)).toBeUndefined();
  });
});
