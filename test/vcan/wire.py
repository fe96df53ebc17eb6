# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Listens on a CAN interface with a raw socket: what really is on the wire, and when."""
import socket
import struct
import threading
import time

CAN_RTR_FLAG = 0x40000000
PRE_OPERATIONAL = 0x7F
NMT_PRE_OPERATIONAL = 0x80


class Wire:
    """Collects (monotonic time, identifier, data) of all data frames, and of remote frames the time
    and the identifier."""

    def __init__(self, interface="vcan0"):
        self._socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self._socket.bind((interface,))
        self._socket.settimeout(0.1)
        self.frames = []
        self.remote = []
        self._open = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while self._open:
            try:
                raw = self._socket.recv(16)
            except socket.timeout:
                continue
            except OSError:  # the interface went down
                time.sleep(0.05)
                continue
            identifier, size = struct.unpack_from("=IB", raw)
            if identifier & CAN_RTR_FLAG:
                self.remote.append((time.monotonic(), identifier & 0x1FFFFFFF))
                continue
            self.frames.append((time.monotonic(), identifier & 0x1FFFFFFF, raw[8:8 + size]))

    def close(self):
        self._open = False
        self._thread.join()
        self._socket.close()

    def since(self, when):
        return [frame for frame in list(self.frames) if frame[0] >= when]

    def first(self, when, condition):
        """Time of the first frame since then with condition(identifier, data), or None."""
        return next((at for at, identifier, data in self.since(when)
                     if condition(identifier, data)), None)

    def statusword(self, node, since=0.0):
        """The newest one of a node (first object of its TPDO 1), or None."""
        words = [struct.unpack_from("<H", data)[0] for _, identifier, data in self.since(since)
                 if identifier == 0x180 + node]
        return words[-1] if words else None
