# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What cannot be converted at all."""


class Refusal(Exception):
    """A sentence for the user: file, key, value, and what to do."""
