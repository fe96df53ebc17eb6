# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Controllers of ros_control as groups, modes and topics here."""
from .drives import MODES
from .limits import read_joint_limits
from .nodes import graph_name
from .output import Section, flow, number_text, quoted
from .report import contents
from .tree import leaves

JOINT_STATES = "JointStateController"
TRAJECTORY = "JointTrajectoryController"
COMMANDS = ("JointGroupPositionController", "JointGroupVelocityController",
            "JointGroupEffortController", "JointPositionController", "JointVelocityController",
            "JointEffortController", "JointGroupCommandController", "ForwardCommandController",
            "ForwardJointGroupCommandController")
CYCLIC = ("cyclic_position", 8), ("interpolated_position", 7)
MOST_DEPTH = 4


def find(value, depth=0):
    """All mappings below that have a `type: package/Class`, as controllers have."""
    for entry in (value.entries or {}).values():
        kind = entry.get("type")
        if kind is not None and kind.text and "/" in kind.text and not kind.text.startswith("/"):
            yield entry
        elif depth < MOST_DEPTH:
            yield from find(entry, depth + 1)


class Controllers:
    """What the controllers want of the axes."""

    def __init__(self, root, nodes, report):
        self.nodes = {node.joint: node for node in nodes}
        self.report = report
        self.rate = None   # (Hz, where from)
        self.groups = []   # (name, controller, joints)
        for controller in find(root):
            self._read(controller)

    def _read(self, controller):
        kind = controller.get("type").string().rsplit("/", 1)[1]
        if kind == JOINT_STATES:
            self._joint_states(controller)
        elif kind.endswith(TRAJECTORY):
            self._trajectory(controller, kind)
        else:
            self._commands(controller, kind)

    def _joint_states(self, controller):
        self.report.done(controller.get("type"), "the node publishes joint_states itself")
        rate = controller.get("publish_rate")
        if rate is None:
            return
        if not 0 < rate.number() <= 1000:
            rate.refuse("must be greater than 0 and at most 1000 (Hz)")
        self.rate = (rate.number(), rate.path)
        self.report.done(rate, "joint_state_rate")

    # Which joints, in which modes

    def _joints(self, controller):
        """Names of joints that are among the nodes; others are told."""
        names = []
        if controller.get("joints") is not None:
            section = controller.get("joints")
            names = section.texts() if section.is_list() else [section.string()]
            self.report.done(section, "joints")
        elif controller.get("joint") is not None:
            names = [controller.get("joint").string()]
            self.report.done(controller.get("joint"), "joint")
        strange = [name for name in names if name not in self.nodes]
        if strange:
            self.report.none((controller.place, controller.path), f"takes {', '.join(strange)}, which "
                             "is none of `nodes`", "joints of another bus stay in its own controllers")
        return [name for name in names if name in self.nodes]

    def _modes(self, controller, joints):
        """{joint: number of its mode}"""
        one, several = controller.get("required_drive_mode"), controller.get("required_drive_modes")
        found = {}
        if one is not None:
            number = one.whole(-128, 127)
            if number in MODES and number != 6:
                found = {joint: number for joint in joints}
            else:
                self.report.none(one, "is no mode of CiA 402 that commands are "
                                      "for", "give `mode` of the axes")
        for joint, value in (several.map() if several is not None else {}).items():
            number = value.whole(-128, 127)
            if number not in MODES or number == 6:
                self.report.none(value, "is no mode of CiA 402 that commands are for",
                                 "give `mode` of the axis")
            elif joint in self.nodes:
                found[joint] = number
                self._mode_name(value, self.nodes[joint], number)
            else:
                self.report.none(value, f"`{joint}` is none of `nodes`")
        if one is not None and not one.told:
            names = {self.nodes[joint].profile.mode(number) for joint, number in found.items()} - {None}
            self.report.done(one, f"mode {', '.join(sorted(names)) or MODES[one.whole(-128, 127)]}")
        return {joint: number for joint, number in found.items()
                if self._known(controller, joint, number)}

    def _mode_name(self, value, node, number):
        self.report.done(value, f"mode {node.profile.mode(number) or MODES[number]}")

    def _known(self, controller, joint, number):
        node = self.nodes[joint]
        if node.profile.mode(number) is not None:
            node.required.add(number)
            return True
        self.report.none((controller.place, controller.path), f"{node.profile.name} has no mode "
                         f"{MODES[number]} for "
                         f"{joint}", "choose one of the profile's (docs/drives/README.md)")
        return False

    def _start(self, joint, number, controller, strong):
        node = self.nodes[joint]
        if node.start is None or (strong and not node.start[2]):
            node.start = (number, controller.path, strong)

    # Controllers that forward commands, and all others

    def _commands(self, controller, kind):
        joints = self._joints(controller)
        known = kind in COMMANDS
        if not joints and not known:
            joints = sorted({leaf for leaf in _texts(controller) if leaf in self.nodes})
        modes = self._modes(controller, joints)
        for joint, number in modes.items():
            self._start(joint, number, controller, False)
        if not known:
            self._strange(controller, kind, joints)
            return
        topics = ", ".join(f"~{self.nodes[joint].axis}/command" for joint in joints) or "no topic"
        if kind.startswith("JointGroup") or controller.get("joints") is not None:
            self.report.about(controller.get("type"), f"each joint has a topic of its own: {topics}; "
                              "`set_mode` takes the place of starting the controller")
        else:
            self.report.done(controller.get("type"), f"{topics}; `set_mode` takes the place of "
                             "starting the controller")

    def _strange(self, controller, kind, joints):
        """A controller that nothing here is like."""
        topics = ", ".join(f"~{self.nodes[joint].axis}/command" for joint in joints)
        inside = contents(controller)
        for leaf in leaves(controller):
            leaf.told = True
        self.report.none((controller.place, controller.path),
                         f"there is no {kind} here (in it: {inside})",
                         f"a node of its own can do the same by {topics}" if topics else "")

    # Trajectories

    def _trajectory(self, controller, kind):
        joints = self._joints(controller)
        modes = self._modes(controller, joints)
        capable = [joint for joint in joints if self._streams(joint, modes.get(joint), controller)]
        package = controller.get("type").string().split("/")[0]
        if kind != TRAJECTORY or package not in ("position_controllers", "pos_vel_controllers"):
            self.report.about(controller.get("type"), "a group follows trajectories by positions, with "
                              "the rules of joint_trajectory_controller (docs/coming_from.md)")
        else:
            self.report.done(controller.get("type"), "groups")
        if capable:
            self.groups.append((self._group_name(controller), controller, capable))
        else:
            self.report.none((controller.place, controller.path),
                             "no joint is left that could follow a trajectory")
        self._limits(controller, capable)

    def _streams(self, joint, number, controller):
        """Gives the axis a mode that follows a stream of positions. @return whether it has one"""
        node = self.nodes[joint]
        names = node.profile.cyclic_positions()
        name = node.profile.mode(number) if number is not None else None
        if name in names:
            self._start(joint, number, controller, True)
            return True
        bits = node.eds.supported_modes()
        for other, mode in CYCLIC:
            if other in names and (bits is None or bits >> (mode - 1) & 1):
                node.required.add(mode)
                self._start(joint, mode, controller, True)
                said = "no mode is given"
                if number in MODES:
                    said = f"{MODES[number]} follows no stream of positions"
                self.report.about((controller.place, controller.path), f"{said}: {joint} gets {other}")
                return True
        if names and not node.profile.generic():
            node.start = (names[0], controller.path, True)
            self.report.about((controller.place, controller.path), f"{joint} follows trajectories in "
                              f"the mode {names[0]} of {node.profile.name}")
            return True
        self.report.none((controller.place, controller.path), f"{joint} has no mode that follows a "
                         "stream of positions (csp, ip)", "command it by its topic")
        return False

    def _group_name(self, controller):
        name = graph_name(controller.path.rsplit("/", 1)[-1])
        taken = {node.axis for node in self.nodes.values()} | {group[0] for group in self.groups}
        while name in taken:
            name += "_group"
        return name

    def _limits(self, controller, joints):
        """A controller of Pilz has limits of its own."""
        section = controller.get("limits")
        for joint in joints if section is not None and section.is_map() else []:
            read_joint_limits(section, joint, self.nodes[joint].limits, self.report)

    def sections(self):
        groups = Section()
        for name, controller, joints in self.groups:
            groups.add(name, self._group(controller, joints))
        return groups

    def _group(self, controller, joints):
        group = Section(controller.path)
        group.add("joints", flow(joints))
        partial, duration = controller.get("allow_partial_joints_goal"), \
            controller.get("stop_trajectory_duration")
        if partial is not None:
            group.add("allow_partial_joints_goal", "true" if partial.flag() else "false")
            self.report.done(partial, "allow_partial_joints_goal")
        if duration is not None:
            if duration.number() < 0:
                duration.refuse("must not be below 0 (s)")
            group.add("stop_trajectory_duration", number_text(duration.number()), "s")
            self.report.done(duration, "stop_trajectory_duration")
        constraints = self._constraints(controller.get("constraints"), joints)
        if not constraints.empty():
            group.add("constraints", constraints)
        return group

    def _constraints(self, section, joints):
        found = Section()
        for name, value in (section.map() if section is not None else {}).items():
            if name in ("goal_time", "stopped_velocity_tolerance"):
                self._tolerance(value, value)
                found.add(name, number_text(value.number()))
            elif name in joints:
                parts = []
                for key, number in value.map().items():
                    if key in ("trajectory", "goal"):
                        self._tolerance(number, number)
                        parts.append(f"{key}: {number_text(number.number())}")
                if parts:
                    found.add(quoted(name), "{" + ", ".join(parts) + "}")
        return found

    def _tolerance(self, value, where):
        if value.number() < 0:
            value.refuse("must not be below 0")
        self.report.done(where, "constraints")


def _texts(value):
    """All texts at or below a value."""
    for entry in (value.entries or {}).values():
        yield from _texts(entry)
    for item in value.items or []:
        yield from _texts(item)
    if value.text is not None:
        yield value.text
