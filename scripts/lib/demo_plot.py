# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Draws how the axes of the demo robot followed their trajectory."""
import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

COMMANDED = "#1b1e23"
MEASURED = ["#0072b2", "#d55e00", "#009e73", "#a2558c", "#b8860b"]  # told apart by the colour-blind, too
GREY = "#5b6470"
STYLE = {
    "font.family": "DejaVu Sans", "font.size": 10, "text.color": COMMANDED,
    "axes.edgecolor": "#c4c9d0", "axes.labelcolor": GREY, "axes.linewidth": 0.8,
    "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#e8ebef", "grid.linewidth": 0.8,
    "xtick.color": GREY, "ytick.color": GREY, "xtick.labelsize": 9, "ytick.labelsize": 9,
}


def draw(path, joints, samples, worst):
    """@param joints (name, what drives it), five of them.
    @param samples (time in s, commanded, measured) with positions in rad, in order of `joints`.
    @param worst largest distance of commanded and measured position of each joint, in rad."""
    with pyplot.rc_context(STYLE):
        figure = pyplot.figure(figsize=(11, 10.0), dpi=110)
        outer = figure.add_gridspec(3, 2, left=0.065, right=0.985, top=0.895, bottom=0.055,
                                    wspace=0.16, hspace=0.3)
        figure.text(0.065, 0.966, "Five drive families follow one trajectory", fontsize=15,
                    weight="bold")
        figure.text(0.065, 0.94, "Each joint has a drive of another maker, simulated after its manual, "
                    "all on one CAN bus", color=GREY)
        for i, (joint, drive) in enumerate(joints):
            cell = outer[i // 2, i % 2].subgridspec(2, 1, height_ratios=[3.2, 1], hspace=0.1)
            top = figure.add_subplot(cell[0])
            bottom = figure.add_subplot(cell[1], sharex=top)
            draw_joint(top, bottom, samples, i, MEASURED[i % len(MEASURED)])
            top.set_title(f"$\\bf{{{joint}}}$  {drive}", loc="left", fontsize=10)
            top.set_title(f"at most {1e3 * worst[i]:.1f} mrad apart", loc="right", color=GREY,
                          fontsize=9)
            if i % 2 == 0:
                top.set_ylabel("position (rad)")
                bottom.set_ylabel("error\n(mrad)")
            if i + 2 >= len(joints):
                bottom.set_xlabel("time (s)")
        explain(figure.add_subplot(outer[len(joints) // 2, len(joints) % 2]))
        figure.savefig(path)
        pyplot.close(figure)


def explain(place):
    """The legend, where there is no joint."""
    place.axis("off")
    handles = [pyplot.Line2D([], [], color=MEASURED[0], lw=4, alpha=0.55),
               pyplot.Line2D([], [], color=COMMANDED, lw=1.2, ls=(0, (4, 2.5))),
               pyplot.Rectangle((0, 0), 1, 1, color=MEASURED[0], alpha=0.25)]
    place.legend(handles, ["measured, as the drive tells", "commanded",
                           "error: commanded minus measured"],
                 loc="center left", frameon=False, fontsize=10, labelspacing=1.0)


def draw_joint(top, bottom, samples, index, colour):
    begin = samples[0][0]
    times = [stamp - begin for stamp, _, _ in samples]
    commanded = [desired[index] for _, desired, _ in samples]
    measured = [actual[index] for _, _, actual in samples]
    errors = [1e3 * (a - b) for a, b in zip(commanded, measured)]
    top.plot(times, measured, color=colour, lw=4, alpha=0.55, solid_capstyle="round")
    top.plot(times, commanded, color=COMMANDED, lw=1.2, ls=(0, (4, 2.5)))
    top.tick_params(labelbottom=False, length=0)
    top.margins(x=0.0, y=0.12)
    bottom.axhline(0.0, color="#c4c9d0", lw=0.8)
    bottom.fill_between(times, errors, 0.0, color=colour, alpha=0.25, lw=0)
    bottom.plot(times, errors, color=colour, lw=1.0)
    bottom.tick_params(length=0)
    reach = 1.25 * max(1.0, max(abs(error) for error in errors))
    bottom.set_ylim(-reach, reach)
