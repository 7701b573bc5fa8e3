"""Rectifies a block with Dask while its workers are killed, and compares every byte.

Usage: blocks.py HOST_SIM

A flight is flown, its frames are rendered, and the block is rectified by one command. Then
examples/dask_block.py rectifies it, one frame per task, while one worker after another is killed.
All images and descriptions must be the same, and no unfinished file may be left by the run that
follows. OpenCV reads the images.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

import cv2
import psutil

CAMERA = """name = "Block camera"
principal_distance_mm = 20.0
principal_point_mm = [0.02, -0.01]
[sensor]
width_px = 1200
height_px = 900
pixel_um = 10.0
[distortion]
k1 = -1.0e-4
[fmc]
axis = "+y"
stroke_mm = 4.0
"""
FRAMES = 8
# Workers that are killed, and the longest time until the last of them is there, s.
KILLS = 2
PATIENCE_S = 60


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{command}: {done.returncode}\n{done.stderr}")


def block(host_sim, root, folder):
    """Flies and renders; returns the options of the block."""
    (folder / "camera.toml").write_text(CAMERA)
    scenario = (root / "host-sim/scenarios/mission.toml").read_text()
    lines = [
        'camera = "camera.toml"' if line.startswith("camera =") else line
        for line in scenario.splitlines()
    ]
    (folder / "mission.toml").write_text("\n".join(lines))
    mission = [host_sim, "mission", "--scenario", folder / "mission.toml"]
    run(*mission, "--exposures", str(FRAMES), "--out", folder / "flight")
    table = "file,sequence\n"
    for number in range(1, FRAMES + 1):
        scene = folder / f"scene{number}"
        exposure = ["--vh", "0.12", "--exposure", "1/300", "--seed", str(number)]
        run(host_sim, "render", "--camera", folder / "camera.toml", *exposure, "--out", scene)
        (scene / "frame.tif").rename(folder / f"f{number}.tif")
        table += f"f{number}.tif,{number}\n"
    (folder / "frames.csv").write_text(table)
    return [
        *("--camera", folder / "camera.toml"),
        *("--records", folder / "flight/records.csv"),
        *("--frames", folder / "frames.csv"),
    ]


def with_dask(host_sim, root, options, out):
    """Rectifies with Dask and kills workers; returns how many were killed."""
    script = [sys.executable, root / "examples/dask_block.py", *options, "--out", out]
    process = subprocess.Popen(
        [*script, "--host-sim", host_sim, "--workers", "2"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    killed, seen = 0, set()
    end = time.monotonic() + PATIENCE_S
    while killed < KILLS and process.poll() is None and time.monotonic() < end:
        for child in psutil.Process(process.pid).children(recursive=True):
            try:
                # A worker that is at work: it has host-sim as its child.
                names = [own.name() for own in child.children()]
                if child.pid not in seen and any("host-sim" in name for name in names):
                    seen.add(child.pid)
                    child.kill()
                    killed += 1
                    break
            except psutil.Error:
                continue
    _, said = process.communicate(timeout=PATIENCE_S * 5)
    if process.returncode != 0:
        raise RuntimeError(f"dask_block.py: {process.returncode}\n{said}")
    return killed


def contents(folder):
    files = (path for path in folder.iterdir() if path.name != "manifest.csv")
    return {path.name: path.read_bytes() for path in files}


def main():
    host_sim = pathlib.Path(sys.argv[1]).resolve()
    root = pathlib.Path(__file__).resolve().parents[3]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        options = block(host_sim, root, folder)
        run(host_sim, "rectify", *options, "--out", folder / "whole")
        killed = with_dask(host_sim, root, options, folder / "dask")
        run(host_sim, "rectify", *options, "--out", folder / "dask", "--resume")
        whole, dask = contents(folder / "whole"), contents(folder / "dask")
        if whole != dask:
            different = {name for name in whole | dask if whole.get(name) != dask.get(name)}
            print(f"different after {killed} killed workers: {sorted(different)}")
            return 1
        for number in range(1, FRAMES + 1):
            image = cv2.imread(folder / f"whole/f{number}.tif", cv2.IMREAD_UNCHANGED)
            output = json.loads(whole[f"f{number}.json"])["output"]
            if image is None or image.shape != (output["height_px"], output["width_px"]):
                print(f"f{number}.tif is not read by OpenCV {cv2.__version__}")
                return 1
        print(f"{FRAMES} frames rectified with Dask, {killed} workers killed: the same bytes")
        return 0 if killed > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
