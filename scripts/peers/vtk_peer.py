#!/usr/bin/env python3
"""VTK's fixed-point ray caster, or its ray caster for GPUs, on a volume that burrhole_bench wrote, for a row beside our own of the same run.

  vtk_peer.py --raw FILE --dims X Y Z --edge-mm E E E --origin-mm X Y Z --eye X Y Z --target X Y Z --up X Y Z --fov-deg F
              --size W H --box X Y Z SIDE [--step VOXELS] [--budget S] [--threads N] [--mapper fixed|gpu] [--shade on|off]
              [--picture OUT.ppm]

FILE holds bytes, x fastest: density x 255. Opacity is the density per voxel length, colour one ivory, Phong shading by a headlight, linear
interpolation, samples --step voxels apart, one ray a pixel, no multisampling. Positions in mm in the frame of the volume.
The change is a box of SIDE^3 voxels at index X Y Z set to 0 and back: VTK is told that its array was modified.
Prints one JSON object: VTK's version, median CPU (all threads) and wall milliseconds of a frame and of a frame after the change.

Needs Debian's python3-vtk9 and a display (xvfb-run). Exit 77: VTK is not installed.
"""
import argparse
import json
import sys
import time

try:
    import numpy as np
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (factory of windows)
    import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401 (factory of mappers)
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkVersion
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
    from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume, vtkVolumeProperty,
                                             vtkWindowToImageFilter)
    from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
    from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper
except ImportError as missing:
    print(f"{missing} (Debian: python3-vtk9)", file=sys.stderr)
    sys.exit(77)


def median_ms(draw, budget_s, at_least=5, at_most=200):
    """Draws once unmeasured, then until the budget is spent. @returns medians of CPU and wall time in ms."""
    draw()
    cpu, wall, start = [], [], time.perf_counter()
    while len(wall) < at_least or (time.perf_counter() - start < budget_s and len(wall) < at_most):
        c, w = time.process_time(), time.perf_counter()
        draw()
        cpu.append((time.process_time() - c) * 1e3)
        wall.append((time.perf_counter() - w) * 1e3)
    return {"cpu_ms": float(np.median(cpu)), "wall_ms": float(np.median(wall)), "runs": len(wall)}


def make_image(a):
    voxels = np.fromfile(a.raw, dtype=np.uint8)
    if voxels.size != a.dims[0] * a.dims[1] * a.dims[2]:
        sys.exit(f"{a.raw} holds {voxels.size} bytes, not {a.dims[0]} x {a.dims[1]} x {a.dims[2]}")
    image = vtkImageData()
    image.SetDimensions(*a.dims)
    image.SetSpacing(*a.edge_mm)
    image.SetOrigin(*a.origin_mm)
    array = numpy_to_vtk(voxels, deep=False)
    image.GetPointData().SetScalars(array)
    return image, array, voxels.reshape(a.dims[2], a.dims[1], a.dims[0])


def make_volume(a, image):
    edge = min(a.edge_mm)
    opacity, colour, look = vtkPiecewiseFunction(), vtkColorTransferFunction(), vtkVolumeProperty()
    opacity.AddPoint(0, 0.0)
    opacity.AddPoint(255, 1.0)
    colour.AddRGBPoint(0, 0.93, 0.88, 0.76)
    colour.AddRGBPoint(255, 0.93, 0.88, 0.76)
    look.SetScalarOpacity(opacity)
    look.SetColor(colour)
    look.SetScalarOpacityUnitDistance(edge)
    look.SetInterpolationTypeToLinear()
    look.SetShade(a.shade == "on")
    look.SetAmbient(0.35)
    look.SetDiffuse(0.75)
    look.SetSpecular(0.0)
    if a.mapper == "gpu":
        mapper = vtkOpenGLGPUVolumeRayCastMapper()
        mapper.UseJitteringOff()
    else:
        mapper = vtkFixedPointVolumeRayCastMapper()
        mapper.SetInteractiveSampleDistance(a.step * edge)
        if a.threads:
            mapper.SetNumberOfThreads(a.threads)
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.SetSampleDistance(a.step * edge)
    mapper.SetImageSampleDistance(1.0)
    mapper.SetBlendModeToComposite()
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look)
    return volume


def make_window(a, volume):
    scene, window = vtkRenderer(), vtkRenderWindow()
    scene.SetBackground(0, 0, 1)  # no bone is as blue: who reads the picture tells bone from background by it
    scene.AddVolume(volume)
    window.SetMultiSamples(0)
    window.SetOffScreenRendering(1)
    window.SetSize(*a.size)
    window.AddRenderer(scene)
    window.SetDesiredUpdateRate(0.0001)
    camera = scene.GetActiveCamera()
    camera.SetFocalPoint(*a.target)
    camera.SetPosition(*a.eye)
    camera.SetViewUp(*a.up)
    camera.SetViewAngle(a.fov_deg)
    scene.ResetCameraClippingRange()
    return window


def write_ppm(window, size, path):
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(size[1], size[0], -1)[::-1, :, :3]
    with open(path, "wb") as out:
        out.write(b"P6\n%d %d\n255\n" % (size[0], size[1]) + pixels.tobytes())


def read_arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--raw", required=True)
    p.add_argument("--dims", type=int, nargs=3, required=True)
    for name in ("edge-mm", "origin-mm", "eye", "target", "up"):
        p.add_argument("--" + name, type=float, nargs=3, required=True)
    p.add_argument("--fov-deg", type=float, required=True)
    p.add_argument("--size", type=int, nargs=2, required=True)
    p.add_argument("--box", type=int, nargs=4, required=True)
    p.add_argument("--step", type=float, default=1.0)
    p.add_argument("--budget", type=float, default=3.0, help="seconds a measurement")
    p.add_argument("--threads", type=int, default=0, help="0: VTK's own choice")
    p.add_argument("--mapper", choices=("fixed", "gpu"), default="fixed", help="gpu: by OpenGL, in software where there is no GPU")
    p.add_argument("--shade", choices=("on", "off"), default="on")
    p.add_argument("--picture", default="")
    return p.parse_args()


def main():
    a = read_arguments()
    image, array, voxels = make_image(a)
    window = make_window(a, make_volume(a, image))

    def frame():
        window.Render()
        window.WaitForCompletion()

    row = {"peer": "VTK " + vtkVersion().GetVTKVersion(), "frame": median_ms(frame, a.budget)}
    if a.picture:
        write_ppm(window, a.size, a.picture)
    x, y, z, side = a.box
    part = voxels[z:z + side, y:y + side, x:x + side]
    kept, gone = part.copy(), [False]

    def drill():
        gone[0] = not gone[0]
        part[...] = 0 if gone[0] else kept
        array.Modified()
        image.Modified()
        frame()

    row["frame_after_change"] = median_ms(drill, a.budget)
    print(json.dumps(row))
    window.Finalize()


if __name__ == "__main__":
    main()
