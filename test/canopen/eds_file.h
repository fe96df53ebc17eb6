// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "canopen/eds/eds.h"
#include "folders.h"

namespace cia402::canopen::test {

/// The EDS file of that name in test/canopen/eds/. What is wrong in each is told in its first
/// lines; the files carry the damage of real ones.
inline Eds readFile(const std::string& name, std::optional<NodeId> node_id = NodeId{5}) {
  std::ifstream file(cia402::test::testFolder() + "/canopen/eds/" + name, std::ios::binary);
  EXPECT_TRUE(file) << name;
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  return readEds(text, node_id);
}

}  // namespace cia402::canopen::test
