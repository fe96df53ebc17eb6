# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""`bus`, `sync` and `heartbeat` of ros_canopen as `bus` here."""
import re

from .output import Section, number_text, quoted
from .refusal import Refusal

RATES = (10000, 20000, 50000, 125000, 250000, 500000, 800000, 1000000)
FRAME = re.compile(r"^([0-9a-f]{1,8})#((?:[0-9a-f]{2}\.?)*)$", re.IGNORECASE)
SOCKETCAN, DUMMY = "can::SocketCANInterface", "can::DummyInterface"
SIMPLE, EXTERNAL = "canopen::SimpleMaster::Allocator", "canopen::ExternalMaster::Allocator"
LONGEST_NAME = 15
MASTER, HEARTBEAT_S = 127, 0.1


class Bus:
    """What is said of the bus as a whole."""

    def __init__(self, root, report, bitrate=None):
        self.report, self.bitrate = report, bitrate
        self.interface = (None, "")
        self.sync = None            # "external"
        self.period = (0.01, "")    # s
        self.counter = (0, "")
        self.master = (MASTER, "")
        self.heartbeat = (HEARTBEAT_S, "ros_canopen sent none; drives stop when the master falls "
                                       "silent")
        self._bus(root.get("bus"))
        self._sync(root)
        self._heartbeat(root.get("heartbeat"))

    def _bus(self, section):
        device = section.get("device") if section is not None else None
        if section is not None:
            section.map()
        if device is None:
            self.interface = ("can0", "not given: set it to yours")
            self.report.about(("", "bus/device"), "is not given in these files (a launch file does "
                              "that): can0 is written")
        else:
            if not 0 < len(device.string()) <= LONGEST_NAME:
                device.refuse(f"must be the name of an interface, at most {LONGEST_NAME} letters")
            self.interface = (device.string(), "bus/device")
            self.report.done(device, "bus/interface")
        if section is not None:
            self._details(section)

    def _details(self, section):
        report = self.report
        loopback, plugin = section.get("loopback"), section.get("driver_plugin")
        if loopback is not None and loopback.flag():
            report.none(loopback, "the node does not hear its own "
                                  "frames", "other programs on this computer do")
        elif loopback is not None:
            report.done(loopback, "the same")
        if plugin is not None and plugin.string() == DUMMY:
            self.interface = ("sim", "bus/driver_plugin can::DummyInterface")
            report.about(plugin, "simulated drives (`interface: sim`) take its place")
        elif plugin is not None and plugin.string() != SOCKETCAN:
            report.none(plugin, "the driver speaks SocketCAN "
                                "alone", "use an adapter with a driver of the kernel")
        elif plugin is not None:
            report.done(plugin, "SocketCAN, as here")
        allocator = section.get("master_allocator")
        if allocator is not None and allocator.string() == EXTERNAL:
            self.sync = "external"
            report.done(allocator, "bus/sync: external")
        elif allocator is not None and allocator.string() == SIMPLE:
            report.done(allocator, "bus/sync: own")
        elif allocator is not None:
            report.none(allocator, "SYNC is sent by the node itself, or followed (`sync: external`)")

    def _sync(self, root):
        section = root.get("sync")
        interval = section.get("interval_ms") if section is not None else None
        overflow = section.get("overflow") if section is not None else None
        silence = section.get("silence_us") if section is not None else None
        update = root.get("update_ms")
        milliseconds = interval.whole(0, 1000) if interval is not None else 0
        if milliseconds:
            self.period = (milliseconds / 1000, "sync/interval_ms")
            self.report.done(interval, "bus/sync_period")
            if update is not None:
                self.report.done(update, "counts for nothing beside sync/interval_ms")
        else:
            self._without_sync(interval, update)
        if overflow is not None:
            counter = overflow.whole(0, 240)
            if counter == 1:
                overflow.refuse("must be 0 or 2 to 240 (CiA 301, 1019h)")
            self.counter = (counter, "sync/overflow")
            self.report.done(overflow, "bus/sync_counter")
        if silence is not None:
            self.report.none(silence, "ros_canopen does not heed it any more", "leave it out")

    def _without_sync(self, interval, update):
        where = interval if interval is not None else ("", "sync/interval_ms")
        if update is not None and update.whole(1, 1000):
            self.period = (update.whole(1, 1000) / 1000, "update_ms")
            self.report.about(update, "is the period of SYNC here, for the driver has no cycle without "
                                      "SYNC")
        else:
            self.period = (0.01, "not given: 10 ms")
            self.report.about(where, "no period is given in these files: 10 ms is written")
        if update is not None and interval is not None:
            self.report.about(interval, "there is no cycle without SYNC here: the drives get one every "
                              "update_ms")

    def _heartbeat(self, section):
        rate = section.get("rate") if section is not None else None
        message = section.get("msg") if section is not None else None
        if rate is None and message is None:
            self.report.about(("", "heartbeat"), "is not given, so ros_canopen sent none: here the "
                              f"master sends one every {HEARTBEAT_S} s and asks one of each drive "
                              "(`heartbeat: 0` does neither)")
            return
        if rate is None or rate.number() <= 0:
            place = (rate or message).place
            raise Refusal(f"{place}: heartbeat/rate: must be greater than 0 (Hz) where `heartbeat` is "
                          "given; give it, or leave `heartbeat` out")
        period = max(0.001, round(1 / rate.number(), 3))
        if period > 65.535:
            rate.refuse("is slower than a heartbeat can be: 65.535 s at most")
        self.heartbeat = (period, "1 / heartbeat/rate")
        if abs(period * rate.number() - 1) > 1e-9:
            self.report.about(rate, f"is {period} s in whole milliseconds; each drive is asked for "
                                    "one, too")
        else:
            self.report.done(rate, "bus/heartbeat; each drive is asked for one, too")
        if message is not None:
            self._message(message)

    def _message(self, message):
        match = FRAME.match(message.string().strip())
        if match is None:
            message.refuse("is no frame as cansend takes it; write 77f#05")
        identifier, data = int(match[1], 16), match[2].replace(".", "")
        if not 0x701 <= identifier <= 0x77F or len(data) != 2:
            self.report.none(message, "is no heartbeat of a "
                                      "node", "the node sends 0x700 + bus/node_id with its "
                             "own state")
            return
        self.master = (identifier - 0x700, "heartbeat/msg")
        if data == "05":
            self.report.done(message, "bus/node_id")
        else:
            self.report.about(message, "bus/node_id; the state in it is the node's own")

    def settle(self, nodes):
        """What needs all drives: a node-ID that none of them has, and the bit rate."""
        taken = {node.id for node in nodes}
        if self.master[0] in taken:
            free = next(number for number in range(127, 0, -1) if number not in taken)
            self.report.about(("", "bus/node_id"),
                              f"{self.master[0]} is that of a drive: the master gets {free}")
            self.master = (free, "the highest that no drive has")
        if self.bitrate is not None:
            self.bitrate = (self.bitrate, "--bitrate")
            return
        told = {}
        for node in nodes:
            rate = node.eds.commissioning("Baudrate")
            if rate and rate * 1000 in RATES:
                told[rate * 1000] = f"{node.eds.name}: Baudrate"
        if len(told) == 1:
            self.bitrate = next(iter(told.items()))
            self.report.about((self.bitrate[1], f"{self.bitrate[0]}"), "bus/bitrate; ros_canopen does "
                              "not heed it: compare with `ip -details link show`, --bitrate gives "
                              "another")
            return
        self.bitrate = (1000000, "not said in ros_canopen: set it to that of the drives")
        text = "is not in these files: 1000000 is written, --bitrate gives another"
        if told:
            text = f"the DCFs say several: {', '.join(map(str, sorted(told)))}; --bitrate gives one"
        self.report.about(("", "bus/bitrate"), text)

    def section(self):
        bus = Section()
        bus.add("interface", quoted(self.interface[0]), self.interface[1])
        bus.add("bitrate", str(self.bitrate[0]), self.bitrate[1])
        bus.add("sync_period", number_text(self.period[0]), self.period[1])
        bus.add("sync_counter", str(self.counter[0]),
                self.counter[1] or "as in ros_canopen without sync/overflow")
        if self.sync:
            bus.add("sync", self.sync, "bus/master_allocator")
        bus.add("node_id", str(self.master[0]), self.master[1] or "of the master")
        bus.add("heartbeat", number_text(self.heartbeat[0]), self.heartbeat[1])
        return bus
