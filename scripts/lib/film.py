#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Films the demo robot in RViz while it follows the trajectory of demo.py.

Usage: film.py DISPLAY FILE.gif

Needs launch/demo.launch running (or about to) with rviz:=true, in full screen on an X display of its own.
Exit status 0 only if the robot was seen and followed.
"""
import os
import sys
import threading
import time

import rosgraph
import rospy
from PIL import Image, ImageGrab

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import demo  # noqa: E402

PERIOD = 0.2  # s between frames
PAUSE = 1.5  # s that the last one stays
SHRINK = 2  # pixels of the screen, in each direction, for one of the film: smooth edges
COLOURS = 64
RVIZ_DEADLINE = 120.0  # s, for a first start without a graphics card
SEEN = 40  # pixels of the finger's colour; it is the last link, so all others are there as well


def finger_pixels(picture):
    """How many pixels have the colour of the finger (demo.urdf), in light or shade."""
    return sum(count for count, (red, green, blue) in picture.getcolors(picture.width * picture.height)
               if red > 120 and 0.6 * red < green < 0.85 * red and blue < 0.45 * red)


class Film:
    """Frames of an X display, taken by a thread from start() to stop()."""

    def __init__(self, display):
        self._display = display
        self._frames = []
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def look(self):
        return ImageGrab.grab(xdisplay=self._display).convert("RGB")

    def start(self):
        self._thread.start()

    def stop(self):
        self._over.set()
        self._thread.join()

    def _run(self):
        due = time.monotonic()
        while not self._over.wait(max(0.0, due - time.monotonic())):
            self._frames.append(self.look())
            due += PERIOD

    def write(self, path):
        """@return (frames, bytes)."""
        size = tuple(side // SHRINK for side in self._frames[0].size)
        frames = [frame.resize(size, Image.LANCZOS) for frame in self._frames]
        # One table of colours for all, or they flicker: that of some frames side by side.
        some = frames[::max(1, len(frames) // 4)]
        sheet = Image.new("RGB", (size[0], size[1] * len(some)))
        for i, frame in enumerate(some):
            sheet.paste(frame, (0, size[1] * i))
        table = sheet.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)
        frames = [frame.quantize(palette=table, dither=Image.Dither.NONE) for frame in frames]
        times = [int(1000 * PERIOD)] * len(frames)
        times[-1] = int(1000 * PAUSE)
        frames[0].save(path, save_all=True, append_images=frames[1:], duration=times, loop=0,
                       optimize=True)
        return len(frames), os.path.getsize(path)


def tell(display, path):
    film = Film(display)
    demo.wait_until(rosgraph.is_master_online, demo.START_DEADLINE, "There is no ROS master.")
    rospy.init_node("film", disable_signals=True)
    recorder, errors = demo.Recorder(), demo.Errors()
    demo.wait_for_drives()
    demo.ask("home")
    demo.ask("enable")
    demo.wait_until(lambda: finger_pixels(film.look()) >= SEEN, RVIZ_DEADLINE,
                    "The robot does not appear in RViz.")
    demo.say("Filming the trajectory")
    film.start()
    samples = demo.follow(recorder, errors)
    film.stop()
    _, complaints = demo.judge(samples)
    demo.ask("disable")
    if complaints:
        raise demo.Failure("; ".join(complaints))
    demo.say("Wrote {0}: {1} frames, {2} bytes".format(path, *film.write(path)))


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        tell(sys.argv[1], sys.argv[2])
    except (demo.Failure, rospy.ServiceException) as failure:
        demo.say(f"No film: {failure}")
        sys.exit(1)


if __name__ == "__main__":
    main()
