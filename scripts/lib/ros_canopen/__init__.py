# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Reads configurations of ros_canopen; see scripts/convert_ros_canopen."""
