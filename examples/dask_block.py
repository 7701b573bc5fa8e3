"""Rectifies the frames of a block with Dask, one frame per task.

    pip install "dask[distributed]"
    python examples/dask_block.py --camera my.toml --records records.csv \
        --frames frames.csv --out rectified [--scheduler tcp://HOST:8786] [-- --resample keys6]

Folders are named as the workers see them. Without --scheduler, one worker per processor is started
on this machine. Options after `--` go on to `host-sim rectify`.

A frame that is bad input (exit code 2) is a result: it would fail again, and is listed at the end.
An I/O failure (3) is an exception, and the task is retried. A worker that dies has its task run
elsewhere; what it was writing is never seen, since files get their names when they are complete.
Exit code: 0, or that of the worst frame.
"""

import argparse
import csv
import os
import subprocess
import sys

from dask.distributed import Client, LocalCluster, as_completed

RETRIES = 3


def rectify(host_sim, options, file):
    """Rectifies one frame; returns its exit code and what was said."""
    command = [host_sim, "rectify", *options, "--resume", "--threads", "1", file]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode in (0, 2):
        return done.returncode, done.stderr.strip()
    raise OSError(f"{file}: exit code {done.returncode}: {done.stderr.strip()}")


def frames_of(table):
    """Returns the files of a table with the columns file and sequence."""
    folder = os.path.dirname(os.path.abspath(table))
    with open(table, newline="", encoding="utf-8-sig") as source:
        for row in csv.DictReader(source, skipinitialspace=True):
            file = row["file"].strip()
            beside = os.path.join(folder, file)
            yield beside if os.path.exists(beside) else os.path.abspath(file)


def main():
    arguments = sys.argv[1:]
    extra = []
    if "--" in arguments:
        place = arguments.index("--")
        arguments, extra = arguments[:place], arguments[place + 1 :]
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--camera", required=True)
    parser.add_argument("--records", required=True)
    parser.add_argument("--frames", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--host-sim", default="host-sim")
    parser.add_argument("--scheduler")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    args = parser.parse_args(arguments)

    options = ["--camera", os.path.abspath(args.camera)]
    options += ["--records", os.path.abspath(args.records)]
    options += ["--frames", os.path.abspath(args.frames)]
    options += ["--out", os.path.abspath(args.out), *extra]
    cluster = None
    if args.scheduler is None:
        cluster = LocalCluster(n_workers=args.workers, threads_per_worker=1)
    worst = 0
    with Client(args.scheduler or cluster) as client:
        tasks = {
            client.submit(
                rectify, args.host_sim, options, file, retries=RETRIES, pure=False
            ): file
            for file in frames_of(args.frames)
        }
        for done in as_completed(tasks):
            try:
                code, text = done.result()
            except Exception as error:  # any failure of a task is that of its frame
                code, text = 3, str(error)
            if code != 0:
                print(f"{tasks[done]}: {text}", file=sys.stderr)
            worst = max(worst, code)
    if cluster is not None:
        cluster.close()
    print(f"{len(tasks)} frames, exit code {worst}", file=sys.stderr)
    return worst


if __name__ == "__main__":
    sys.exit(main())
