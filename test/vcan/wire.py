# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Listens on a CAN interface with a raw socket: what really is on the wire, and when."""
import socket
import struct
import threading
import time

CAN_RTR_FLAG = 0x40000000
SO_TIMESTAMPNS = 35  # asm-generic/socket.h
PRE_OPERATIONAL = 0x7F
NMT_PRE_OPERATIONAL = 0x80


def clock_distance():
    """What the wall clock is ahead of the monotonic one, in seconds; exact to microseconds."""
    best = None
    for _ in range(10):  # whoever is interrupted between the readings tries again
        before = time.monotonic()
        wall = time.time()
        after = time.monotonic()
        if best is None or after - before < best[0]:
            best = (after - before, wall - (before + after) / 2.0)
        if best[0] < 20e-6:
            break
    return best[1]


class Wire:
    """Collects (monotonic time, identifier, data) of all data frames, and of remote frames the time
    and the identifier. The time is the kernel's: this process may come to read them late."""

    def __init__(self, interface="vcan0"):
        self._socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self._socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self._interface = interface
        self._socket.bind((interface,))
        self._socket.settimeout(0.1)
        self._distance = clock_distance()  # once: its system calls are dear in user-mode Linux
        self._frames = []
        self._remote = []
        self._read_until = 0.0  # monotonic: all that was sent before has been read
        self._open = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        asked = 0.0
        while self._open:
            try:
                raw, ancillary, _, _ = self._socket.recvmsg(16, socket.CMSG_SPACE(16))
            except socket.timeout:
                self._read_until = max(self._read_until, asked)
                asked = time.monotonic()
                continue
            except OSError:  # the interface went down
                time.sleep(0.05)
                continue
            seconds, nanoseconds = struct.unpack("@qq", ancillary[0][2])
            at = seconds + nanoseconds * 1e-9 - self._distance
            identifier, size = struct.unpack_from("=IB", raw)
            if identifier & CAN_RTR_FLAG:
                self._remote.append((at, identifier & 0x1FFFFFFF))
            else:
                self._frames.append((at, identifier & 0x1FFFFFFF, raw[8:8 + size]))
            self._read_until = max(self._read_until, at)

    def close(self):
        self._open = False
        self._thread.join()
        self._socket.close()

    def hear_itself(self):
        """Sends a frame of no service from another socket: who has not received that one cannot
        say that nothing was sent."""
        with socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as other:
            other.bind((self._interface,))
            other.send(struct.pack("=IB3x8s", 0x7FF, 5, b"heard"))

    def since(self, when):
        """The data frames since then, up to this call."""
        self._catch_up()
        return [frame for frame in list(self._frames) if frame[0] >= when]

    def remote_since(self, when):
        """(time, identifier) of the remote frames since then, up to this call."""
        self._catch_up()
        return [frame for frame in list(self._remote) if frame[0] >= when]

    def _catch_up(self, timeout=60.0):
        """Waits until all that was sent before this call has been read: judged is what was on the
        wire, not what a reader that got no processor time has come to see of it."""
        now = time.monotonic()
        while self._read_until < now:
            if time.monotonic() > now + timeout:
                raise AssertionError(f"the wire is read {now - self._read_until:.1f} s late")
            time.sleep(0.02)

    def first(self, when, condition):
        """Time of the first frame since then with condition(identifier, data), or None."""
        return next((at for at, identifier, data in self.since(when)
                     if condition(identifier, data)), None)

    def send(self, identifier, data):
        self._socket.send(struct.pack("=IB3x8s", identifier, len(data), data))

    def upload(self, node, index, deadline=30.0):
        """Reads an object of up to four bytes by SDO. Only where no other master lives, who would
        ask the same drive meanwhile. @return its bytes."""
        multiplexer = struct.pack("<HB", index, 0)
        asked = time.monotonic()
        self.send(0x600 + node, b"\x40" + multiplexer + bytes(4))
        while True:
            for _, identifier, data in self.since(asked - 0.001):
                if identifier == 0x580 + node and data[1:4] == multiplexer and data[0] & 0xE3 == 0x43:
                    return data[4:8 - (data[0] >> 2 & 3)]
            if time.monotonic() > asked + deadline:
                raise AssertionError(f"node {node} does not tell {index:04X}h")

    def travel(self, node, seconds=0.3):
        """What 6064h, where the motor stands, changes by meanwhile. See upload()."""
        def position():
            return int.from_bytes(self.upload(node, 0x6064), "little", signed=True)
        before = position()
        time.sleep(seconds)  # what is tested is what the motor does meanwhile
        return abs(position() - before)

    def powered(self, node):
        """Whether the drive is in "operation enabled" (6041h). See upload()."""
        return int.from_bytes(self.upload(node, 0x6041), "little") & 0x6F == 0x27

    def statusword(self, node, since=0.0):
        """The newest one of a node (first object of its TPDO 1), or None."""
        words = [struct.unpack_from("<H", data)[0] for _, identifier, data in self.since(since)
                 if identifier == 0x180 + node]
        return words[-1] if words else None
