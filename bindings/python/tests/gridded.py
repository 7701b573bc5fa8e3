"""A camera with residual grids of lens and sensor, made here."""

import struct
import zlib

import numpy as np

CAMERA = """name = "Small camera"
principal_distance_mm = 20.0
principal_point_mm = [0.02, -0.01]
[sensor]
width_px = 600
height_px = 440
pixel_um = 20.0
[distortion]
k1 = -1.0e-4
p1 = 2.0e-5
[fmc]
axis = "+y"
stroke_mm = 4.0
flatness_um = [0.0, 5.0]
"""


def grid(carrier, phase, amplitude_um):
    """The bytes of a grid of 24 x 24 nodes with waves; carrier 0 is the lens, 1 the sensor."""
    header = struct.pack("<4sHHHHffff", b"FMCG", 1, carrier, 24, 24, -11.5, -11.5, 1.0, 1e-6)
    row, column = np.mgrid[:24, :24]
    along = np.stack([0.7 * column + 0.3 * row, 0.5 * row - 0.6 * column], axis=-1)
    nodes = np.round(1000.0 * amplitude_um * np.sin(along + phase)).astype("<i2").tobytes()
    return header + nodes + struct.pack("<I", zlib.crc32(header + nodes))


def write(folder):
    """Writes camera and grids, and returns the path of the camera."""
    text = CAMERA + "[grid]\n"
    for carrier, (name, phase) in enumerate([("lens", 0.3), ("sensor", 1.9)]):
        data = grid(carrier, phase, 2.0)
        (folder / f"{name}.fmcg").write_bytes(data)
        # The last four bytes are the CRC-32 of the others.
        (crc,) = struct.unpack("<I", data[-4:])
        text += f'{name} = "{name}.fmcg"\n{name}_crc32 = "{crc:08x}"\n'
    path = folder / "camera.toml"
    path.write_text(text)
    return path
