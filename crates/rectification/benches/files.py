"""Processor time from file to file of `host-sim rectify`, OpenCV and vips, one frame, one thread each, in turns.

    python files.py HOST_SIM CAMERA.toml FOLDER [ROUNDS [PYTHON…]]

Needs numpy, opencv-python-headless and "pyvips[binary]"; each further PYTHON is another Python with OpenCV of another
version. FOLDER gets up to 10 GB. The frame has the sensor of the camera, RGB of 16 bits and texture; uncompressed with
strips of 64 rows, and with Deflate and predictor. OpenCV reads it, makes its maps from the mesh of `host-sim mesh`,
resamples (INTER_CUBIC, INTER_LINEAR) and writes; vips has its map ready in a file, reads, resamples and writes. Prints
CSV: least and median ns per pixel (user and system time), and the ratio of host-sim's to it by the least and by the
median; then how far the other images are from host-sim's, counts RMS.
"""

import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

EXPOSURE = ["--vh", "0.05", "--exposure", "0.002"]


def places(folder):
    """Returns the maps of all pixels from a mesh of every 16th: cv2.resize places its samples half a pixel off."""
    import cv2
    import numpy

    mesh = json.loads((folder / "mesh.json").read_text())
    width, height = mesh["size_px"]
    maps = []
    for name in mesh["files"]:
        rough = numpy.fromfile(folder / name, "<f4").reshape(mesh["rows"], mesh["columns"])
        down, along = numpy.gradient(rough.astype(float))
        rough = (rough - (down + along) / 32).astype(numpy.float32)
        fine = cv2.resize(rough, (16 * mesh["columns"], 16 * mesh["rows"]), interpolation=cv2.INTER_LINEAR)
        maps.append(numpy.ascontiguousarray(fine[8:8 + height, 8:8 + width]))
    return maps


def compression(name):
    return {"none": 1, "deflate": 8}[name]


def by_opencv(folder, kernel, codec):
    import cv2

    cv2.setNumThreads(1)
    frame = cv2.imread(str(folder / f"{codec}.tif"), cv2.IMREAD_UNCHANGED)
    kernel = {"bilinear": cv2.INTER_LINEAR, "bicubic": cv2.INTER_CUBIC}[kernel]
    image = cv2.remap(frame, *places(folder), kernel, borderMode=cv2.BORDER_CONSTANT)
    options = [cv2.IMWRITE_TIFF_COMPRESSION, compression(codec), cv2.IMWRITE_TIFF_ROWSPERSTRIP, 64]
    if not cv2.imwrite(str(folder / "opencv.tif"), image, options):
        sys.exit(1)


def by_vips(folder, kernel, codec):
    import pyvips

    frame = pyvips.Image.new_from_file(str(folder / f"{codec}.tif"))
    index = pyvips.Image.new_from_file(str(folder / "map.v"))
    image = frame.mapim(index, interpolate=pyvips.Interpolate.new(kernel))
    image.tiffsave(str(folder / "vips.tif"), compression=codec, predictor="horizontal" if codec == "deflate" else "none")


def prepare(folder, host_sim, camera):
    """Writes mesh, maps of vips and frames."""
    import cv2
    import numpy
    import pyvips

    subprocess.run([host_sim, "mesh", "--camera", camera, *EXPOSURE, "--spacing", "16", "--format", "opencv", "--out", folder],
                   check=True)
    maps = numpy.dstack(places(folder))
    pyvips.Image.new_from_array(maps).copy(interpretation="multiband").write_to_file(str(folder / "map.v"))
    height, width, _ = maps.shape
    random = numpy.random.default_rng(1)
    # Texture of all sizes, and noise of 40 counts.
    frame = numpy.full((height, width), 20_000, numpy.float32)
    for size in (4, 16, 64, 256):
        rough = random.normal(0, 200 * size**0.5, (height // size + 2, width // size + 2)).astype(numpy.float32)
        frame += cv2.resize(rough, (width, height), interpolation=cv2.INTER_CUBIC)
    bands = []
    for band in range(3):
        noise = random.normal(0, 40, (height, width)).astype(numpy.float32)
        bands.append(numpy.clip(frame * (0.9 + 0.1 * band) + noise, 0, 65535).astype(numpy.uint16))
    frame = numpy.dstack(bands)
    for codec in ("none", "deflate"):
        options = [cv2.IMWRITE_TIFF_COMPRESSION, compression(codec), cv2.IMWRITE_TIFF_ROWSPERSTRIP, 64]
        cv2.imwrite(str(folder / f"{codec}.tif"), frame, options)
    return width * height


def cpu_s(command):
    """Runs a program and returns its processor time, s."""
    child = subprocess.Popen(command, env={**os.environ, "VIPS_CONCURRENCY": "1"}, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        sys.exit(f"{command} failed")
    return usage.ru_utime + usage.ru_stime


def differences(folder):
    """Prints how far OpenCV's and vips' images are from host-sim's, away from the edge."""
    import cv2
    import numpy

    inner = (slice(200, -200), slice(200, -200))
    image = cv2.imread(str(folder / "out/none.tif"), cv2.IMREAD_UNCHANGED)[inner].astype(numpy.float32)
    for name in ("opencv", "vips"):
        other = cv2.imread(str(folder / f"{name}.tif"), cv2.IMREAD_UNCHANGED)[inner]
        print(f"difference from {name},{float(numpy.sqrt(numpy.mean((image - other) ** 2))):.1f}")


def main(host_sim, camera, folder, rounds=3, *pythons):
    folder = Path(folder)
    folder.mkdir(exist_ok=True)
    pixels = prepare(folder, host_sim, camera)
    print("contender,least_ns_per_px,median_ns_per_px,least_ratio,median_ratio")
    for codec, kernel in (("deflate", "bicubic"), ("none", "bilinear"), ("none", "bicubic")):
        rectify = [host_sim, "rectify", "--camera", camera, *EXPOSURE, "--centre", "frame", "--threads", "1",
                   "--resample", kernel, "--out", folder / "out", folder / f"{codec}.tif"]
        contenders = {"host-sim": rectify}
        for python in (sys.executable, *pythons):
            version = subprocess.check_output([python, "-c", "import cv2; print(cv2.__version__)"], text=True).strip()
            contenders[f"OpenCV {version}"] = [python, __file__, "by_opencv", folder, kernel, codec]
        contenders["vips"] = [sys.executable, __file__, "by_vips", folder, kernel, codec]
        times = {name: [] for name in contenders}
        for _ in range(int(rounds)):
            for name, command in contenders.items():
                times[name].append(cpu_s(command))
        least, median = ({name: pick(time) for name, time in times.items()} for pick in (min, statistics.median))
        for name in times:
            ns = [1e9 * pick[name] / pixels for pick in (least, median)]
            ratios = [pick["host-sim"] / pick[name] for pick in (least, median)]
            print(f"{name} {codec} {kernel},{ns[0]:.2f},{ns[1]:.2f},{ratios[0]:.3f},{ratios[1]:.3f}", flush=True)
    differences(folder)


if __name__ == "__main__":
    if sys.argv[1] in ("by_opencv", "by_vips"):
        globals()[sys.argv[1]](Path(sys.argv[2]), *sys.argv[3:])
    else:
        main(*sys.argv[1:])
