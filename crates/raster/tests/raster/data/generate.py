"""Writes the frames beside this file with tifffile: python generate.py (tifffile 2026.3.3,
imagecodecs 2026.3.6, numpy). Sample k of column x, row y is (x (3 + k) + 5 y) (1 or 257) mod 2^bits."""

import numpy
import tifffile

WIDTH, HEIGHT = 37, 29


def pixels(samples, bits):
    y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH]
    frame = numpy.stack([(x * (3 + k) + 5 * y) for k in range(samples)], -1)
    return frame.astype("u1") if bits == 8 else (frame * 257).astype("u2")


def write(name, samples, bits, **options):
    frame = pixels(samples, bits)
    if options.get("planarconfig") == "separate":
        frame = numpy.moveaxis(frame, -1, 0)
    options.setdefault("photometric", "rgb" if samples > 1 else "minisblack")
    if samples == 4:
        options["extrasamples"] = ["unspecified"]
    frame = frame[..., 0] if samples == 1 else frame
    tifffile.imwrite(name, frame, metadata=None, software=None, **options)


write("lzw-planar-big-endian.tif", 3, 16, compression="lzw", predictor=True, byteorder=">",
      planarconfig="separate", rowsperstrip=8)
write("zstd-tiles-bigtiff.tif", 4, 16, compression="zstd", predictor=True, bigtiff=True,
      tile=(16, 16))
write("old-deflate-planar-tiles.tif", 3, 8, compression="deflate", predictor=True, byteorder=">",
      planarconfig="separate", tile=(16, 32))
write("packbits-one-strip.tif", 1, 8, compression="packbits")
write("uncompressed-bigtiff-big-endian.tif", 1, 16, bigtiff=True, byteorder=">", rowsperstrip=5)
