/**
 * vtk.js draws what the page draws, for `palpate bench render`: put into the page by the benchmark, shipped
 * with nothing. The same values, camera, transfer function and step; light is its own.
 */
import "@kitware/vtk.js/Rendering/Profiles/Volume";
import vtkDataArray from "@kitware/vtk.js/Common/Core/DataArray";
import vtkImageData from "@kitware/vtk.js/Common/DataModel/ImageData";
import vtkPiecewiseFunction from "@kitware/vtk.js/Common/DataModel/PiecewiseFunction";
import vtkColorTransferFunction from "@kitware/vtk.js/Rendering/Core/ColorTransferFunction";
import vtkRenderer from "@kitware/vtk.js/Rendering/Core/Renderer";
import vtkRenderWindow from "@kitware/vtk.js/Rendering/Core/RenderWindow";
import vtkRenderWindowInteractor from "@kitware/vtk.js/Rendering/Core/RenderWindowInteractor";
import vtkVolume from "@kitware/vtk.js/Rendering/Core/Volume";
import vtkVolumeMapper from "@kitware/vtk.js/Rendering/Core/VolumeMapper";
import vtkOpenGLRenderWindow from "@kitware/vtk.js/Rendering/OpenGL/RenderWindow";
import { sample } from "../src/core/appearance/transfer_function";
import type { TimedPicture, TimedWish } from "../src/gl/picture/timed_picture";
import type { BenchScene } from "../src/ui/app/hooks/bench_hooks";

export type VtkMode = "composite" | "shaded" | "mip";

export interface VtkHooks {
  readonly open: (scene: BenchScene) => void;
  readonly draw: (mode: VtkMode, wish: TimedWish) => TimedPicture;
}

declare global {
  interface Window {
    vtkDoor?: VtkHooks;
  }
}

/** Points that a curve is sampled at. */
const curvePoints = 512;
/** Thickness that opacities are told for [mm]. */
const unit = 1;

let drawn: ReturnType<typeof opened> | null = null;
let smallestSpacing = 1;

function opened(scene: BenchScene) {
  const renderWindow = vtkRenderWindow.newInstance();
  const renderer = vtkRenderer.newInstance({ background: [0, 0, 0] });
  renderWindow.addRenderer(renderer);
  const view = vtkOpenGLRenderWindow.newInstance();
  const container = document.createElement("div");
  view.setContainer(container);
  renderWindow.addView(view);
  // it asks an interactor whether it is animating
  const interactor = vtkRenderWindowInteractor.newInstance();
  interactor.setView(view);
  interactor.initialize();

  const image = vtkImageData.newInstance();
  image.setDimensions([...scene.dimensions]);
  image.setSpacing([...scene.spacing]);
  image.setOrigin([...scene.origin]);
  const [x, y, z] = scene.axes;
  image.setDirection(...x, ...y, ...z);
  image.getPointData().setScalars(vtkDataArray.newInstance({ numberOfComponents: 1, values: scene.values }));

  const mapper = vtkVolumeMapper.newInstance();
  mapper.setInputData(image);
  mapper.setAutoAdjustSampleDistances(false);
  mapper.setMaximumSamplesPerRay(100_000);
  const volume = vtkVolume.newInstance();
  volume.setMapper(mapper);
  const property = volume.getProperty();
  const [colours, opacities] = curves(scene);
  property.setRGBTransferFunction(0, colours);
  property.setScalarOpacity(0, opacities);
  property.setScalarOpacityUnitDistance(0, unit);
  property.setInterpolationTypeToLinear();
  renderer.addVolume(volume);

  const camera = renderer.getActiveCamera();
  camera.setPosition(...(scene.eye as [number, number, number]));
  camera.setFocalPoint(...(scene.target as [number, number, number]));
  camera.setViewUp(...(scene.up as [number, number, number]));
  camera.setViewAngle((scene.field * 180) / Math.PI);
  renderer.resetCameraClippingRange();
  return { renderWindow, view, mapper, property };
}

function curves({ points }: BenchScene): readonly [vtkColorTransferFunction, vtkPiecewiseFunction] {
  const colours = vtkColorTransferFunction.newInstance();
  const opacities = vtkPiecewiseFunction.newInstance();
  const [low, high] = [points[0]?.value ?? 0, points.at(-1)?.value ?? 1];
  for (let i = 0; i < curvePoints; ++i) {
    const value = low + ((high - low) * i) / (curvePoints - 1);
    const { colour, extinction } = sample(points, value);
    colours.addRGBPoint(value, ...colour);
    opacities.addPoint(value, 1 - Math.exp(-extinction * unit));
  }
  return [colours, opacities];
}

window.vtkDoor = {
  open: (scene) => {
    smallestSpacing = scene.smallestSpacing;
    drawn = opened(scene);
    // the context is there after the first picture
    drawn.renderWindow.render();
  },
  draw: (mode, { width, height, stepsPerVoxel }) => {
    if (drawn === null) {
      throw new Error("no scene");
    }
    const { renderWindow, view, mapper, property } = drawn;
    view.setSize(width, height);
    mapper.setSampleDistance(smallestSpacing / stepsPerVoxel);
    property.setShade(mode === "shaded");
    mapper.setBlendMode(mode === "mip" ? 1 : 0);
    const gl = view.getCanvas()?.getContext("webgl2");
    if (!gl) {
      throw new Error("no WebGL2");
    }
    const read = (w: number, h: number): Uint8Array => {
      const bytes = new Uint8Array(4 * w * h);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      return bytes;
    };
    read(1, 1);
    const begun = performance.now();
    renderWindow.render();
    read(1, 1);
    const milliseconds = performance.now() - begun;
    const bytes = read(width, height);
    const colours = Float32Array.from(
      { length: 3 * width * height },
      (_, i) => (bytes[4 * Math.floor(i / 3) + (i % 3)] ?? 0) / 255,
    );
    return { milliseconds, colours };
  },
};
