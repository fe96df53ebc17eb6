# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""actionlib's client, which hears also of what becomes of a goal at once."""
import threading

import actionlib


class GoalClient(actionlib.SimpleActionClient):
    """That of actionlib drops what it hears of a goal before its send_goal() has returned, and waits
    for ever where that was the result. Here news wait until it has."""

    def __init__(self, name, action):
        self._sending = threading.RLock()
        super().__init__(name, action)

    def send_goal(self, *arguments, **more):
        with self._sending:
            super().send_goal(*arguments, **more)

    def _handle_transition(self, gh):
        with self._sending:
            super()._handle_transition(gh)
