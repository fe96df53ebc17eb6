// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/memory_pages.h"

#include <sys/mman.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Under these sanitizers mlock() does nothing.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace cia402::bus {
namespace {

/// A part of this process' memory as /proc/self/smaps tells it.
struct MappedPart {
  std::string name;
  bool readable = false, locked = false;
};

std::vector<MappedPart> mappedParts() {
  std::vector<MappedPart> parts;
  std::ifstream smaps("/proc/self/smaps");
  for (std::string line; std::getline(smaps, line);) {
    std::istringstream words(line);
    std::string first, rights, offset, device, inode, name;
    words >> first >> rights;
    if (first.find('-') != std::string::npos) {
      words >> offset >> device >> inode >> name;
      parts.push_back({name, rights.front() == 'r', false});
    } else if (first == "VmFlags:" && !parts.empty()) {
      parts.back().locked = line.find(" lo") != std::string::npos;
    }
  }
  return parts;
}

class MemoryPages : public testing::Test {
 protected:
  void SetUp() override {
    munlockall();
    char byte[64] = {};
    if (mlock(byte, sizeof byte) != 0) GTEST_SKIP() << "this system lets nobody lock memory";
    munlockall();
  }
  void TearDown() override { munlockall(); }
};

TEST_F(MemoryPages, OfTheProgramAndOfTheLibrariesThatItsCycleUsesStay) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  touchProgram();
  int of_program = 0, of_library = 0;
  for (const MappedPart& part : mappedParts()) {
    const bool library = part.name.find("/libc.so") != std::string::npos;
    if (!part.readable || (part.name != program && !library)) continue;
    ++(library ? of_library : of_program);
    EXPECT_TRUE(part.locked) << part.name;
  }
  EXPECT_GT(of_program, 0);
  EXPECT_GT(of_library, 0);
}

TEST_F(MemoryPages, OfTheHeapStay) {
  touchHeap();
  for (const MappedPart& part : mappedParts()) {
    if (part.name == "[heap]") {
      EXPECT_TRUE(part.locked);
    }
  }
}

}  // namespace
}  // namespace cia402::bus

#endif
