// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "drive/fake_objects.h"

namespace cia402::drive::test {

/// A drive that is only asked for objects, in virtual time.
class ObjectsFixture : public ::testing::Test {
 protected:
  /// What is queued is asked for and answered.
  void run() { objects.work(now); }
  void wait(Duration time) {
    now += time;
    run();
  }

  FakeDrive drive;
  FakeObjects objects{drive};
  Time now{};
};

}  // namespace cia402::drive::test
