"""The board's image on the model, for anybody to try: prints the serial port of the board's link.

Usage: serve.py IMAGE [--clock-ppm PPM] [--triggers-every S]

The receiver gives time pulses, and the trigger line an edge every S seconds. With host-sim:

    host-sim camera --device serial:/dev/pts/7 prepare --camera FILE --settings FILE
"""

import argparse

from board import CYCLES_PER_S, Board


def main():
    parser = argparse.ArgumentParser(description="Runs the board's image on a model of its chip")
    parser.add_argument("image", help="the image, such as target/firmware/nucleo-h743zi")
    parser.add_argument("--clock-ppm", type=float, default=0.0, help="error of the board's clock")
    parser.add_argument("--triggers-every", type=float, default=0.0, metavar="S")
    arguments = parser.parse_args()
    board = Board(arguments.image, ppm=arguments.clock_ppm)
    board.bench.start_pulses()
    if arguments.triggers_every > 0.0:
        trigger_for_ever(board, arguments.triggers_every)
    print(f"serial:{board.open_port()}", flush=True)
    try:
        board.serve(lambda: True)
    except KeyboardInterrupt:
        print()


def trigger_for_ever(board, interval_s):
    """Gives a trigger, and plans the next."""

    def trigger():
        board.bench.trigger(board.now)
        board.processor.after(round(interval_s * CYCLES_PER_S), trigger)

    board.processor.after(round(interval_s * CYCLES_PER_S), trigger)


if __name__ == "__main__":
    main()
