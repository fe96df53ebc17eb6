# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""`publish` and `log` of ros_canopen: where the same numbers are to be found here."""
from .eds import object_key

TOPICS = {0x6041: "statusword of ~axis_states", 0x6061: "mode of ~axis_states",
          0x6064: "position of joint_states (rad or m)", 0x606C: "velocity of joint_states (per s)",
          0x6077: "effort of joint_states (N m or N, with "
                  "rated_torque)", 0x603F: "error_code of ~axis_states",
          0x60FD: "digital inputs of ~axis_states", 0x60F4: "following_error of ~axis_states",
          0x1003: "service error_history", 0x1018: "diagnostics (serial number)"}


def convert(node, report):
    for key in ("publish", "log", "log_warn", "log_error"):
        section = node.get(key)
        if section is None:
            continue
        found, other = [], []
        for text in section.texts():
            name = text.split("!")[0]
            number = object_key(name)
            if number is None:
                section.refuse(f"has `{text}`, which is no object; write it like 6041 or 6041!")
            if number[0] in TOPICS:
                found.append(f"{name}: {TOPICS[number[0]]}")
            else:
                other.append(name)
        if found:
            report.about(section, "; ".join(found))
        if other:
            report.none(section, "no topic has "
                                 f"{', '.join(other)}", "call read_object, or name it in `signals` of "
                        "a profile, for the diagnostics" if key == "publish" else "call read_object")
        if not found and not other:
            report.done(section, "nothing")
