// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "input.h"

namespace {

// NOLINTNEXTLINE: the name of the fuzz target is the name of the suite
#define CIA402_FUZZ_TEST(suite) TEST(suite, RunsOverItsCorpusAndOverPiecesOfIt)
#define CIA402_FUZZ_TEST_OF(suite) CIA402_FUZZ_TEST(suite)

void runOn(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

// Each file as it is, cut off at some places, and with some bytes changed, the same ones each time.
CIA402_FUZZ_TEST_OF(CIA402_FUZZ_NAME) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(CIA402_CORPUS)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    ASSERT_FALSE(bytes.empty()) << entry.path();
    SCOPED_TRACE(entry.path());
    ++files;
    runOn(bytes);
    for (std::size_t i = 1; i < 8; ++i) {
      runOn(bytes.substr(0, bytes.size() * i / 8));
      std::string changed = bytes;
      for (std::size_t at = i; at < changed.size(); at += 61 * i) changed[at] ^= '\x15';
      runOn(changed);
    }
  }
  EXPECT_GE(files, 1U) << "no corpus in " << CIA402_CORPUS;
}

}  // namespace
