// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the driver puts on the wire for an SV660C, byte by byte, and what it makes of its answers.
#include <algorithm>
#include <array>

#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using Bytes = std::vector<std::uint8_t>;

/// Everything on the bus from the first moment on.
struct Sv660cTrace : Scene {
  explicit Sv660cTrace(const std::string& yaml) : Scene(loadText(yaml)) {
    world().bus().setMonitor([this](const can::Frame& frame, Time) { frames.push_back(frame); });
  }
  /// The writes by SDO, eight bytes each, in their order.
  std::vector<Bytes> writes() const {
    std::vector<Bytes> found;
    for (const can::Frame& frame : frames) {
      if (frame.id != 0x601 || (frame.data[0] & 0xE0) != 0x20) continue;
      found.emplace_back(frame.data.begin(), frame.data.begin() + 8);
    }
    return found;
  }
  /// The words that begin the frames of an identifier, each once in a row, with a mask.
  std::vector<int> words(std::uint32_t id, int mask) const {
    std::vector<int> found;
    for (const can::Frame& frame : frames) {
      if (frame.id != id || frame.size < 2) continue;
      const int word = (frame.data[0] | frame.data[1] << 8) & mask;
      if (found.empty() || found.back() != word) found.push_back(word);
    }
    return found;
  }
  std::vector<can::Frame> frames;
};

bool isPdoCobId(const Bytes& write) {
  const int index = write[1] | write[2] << 8;
  const bool pdo = (index & 0xFFFC) == 0x1400 || (index & 0xFFFC) == 0x1800;
  return pdo && write[3] == 1;
}

// CAN-IDs are fixed: 0x200, 0x300 .. 0x500 and 0x180 .. 0x480 + node-ID; bit 30 of a TPDO stays 1.
TEST(Sv660cWire, NoWriteChangesTheIdentifierOfAPdo) {
  Sv660cTrace scene(sv660cJoint());
  ASSERT_TRUE(scene.boot()) << scene.told();
  unsigned seen = 0;
  for (const Bytes& write : scene.writes()) {
    if (!isPdoCobId(write)) continue;
    ++seen;
    EXPECT_EQ(write[0], 0x23);
    EXPECT_EQ(write[4], write[2] == 0x14 ? 0x01 : 0x81);
    EXPECT_EQ(write[5], (write[2] == 0x14 ? 0x02 : 0x01) + write[1]);
    EXPECT_EQ(write[6], 0x00);
    EXPECT_EQ(write[7] & 0x7F, write[2] == 0x14 ? 0x00 : 0x40);
  }
  EXPECT_GE(seen, 4U);
}

// L9392: what is written before that wears the memory of the drive.
TEST(Sv660cWire, SwitchesTheMemoryOffAmongItsFirstParameters) {
  Sv660cTrace scene(sv660cJoint());
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto writes = scene.writes();
  const Bytes off{0x2B, 0x0C, 0x20, 0x0E, 0x00, 0x00, 0x00, 0x00};
  const auto at = std::find(writes.begin(), writes.end(), off);
  ASSERT_NE(at, writes.end());
  for (auto write = writes.begin(); write != at; ++write) {
    const bool stop = (*write)[1] == 0x40 && (*write)[2] == 0x60;  // of a drive that is found
    EXPECT_TRUE(stop || (*write)[2] == 0x10 || (*write)[2] == 0x14 || (*write)[2] == 0x16 ||
                (*write)[2] == 0x18 || (*write)[2] == 0x1A)
        << testing::PrintToString(*write) << " is no communication parameter";
  }
}

TEST(Sv660cWire, SetsUpTheRpdoOfItsInterpolatedPositions) {
  Sv660cTrace scene(sv660cJoint(", mode: ip", {}, "0.004", "[ip]"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto writes = scene.writes();
  const Bytes steps[] = {{0x23, 0x00, 0x14, 0x01, 0x01, 0x02, 0x00, 0x80},
                         {0x2F, 0x00, 0x16, 0x00, 0x00, 0x00, 0x00, 0x00},
                         {0x23, 0x00, 0x16, 0x01, 0x10, 0x00, 0x40, 0x60},
                         {0x23, 0x00, 0x16, 0x02, 0x20, 0x01, 0xC1, 0x60},
                         {0x2F, 0x00, 0x16, 0x00, 0x02, 0x00, 0x00, 0x00},
                         {0x23, 0x00, 0x14, 0x01, 0x01, 0x02, 0x00, 0x00}};
  auto from = writes.begin();
  for (const Bytes& step : steps) {
    from = std::find(from, writes.end(), step);
    ASSERT_NE(from, writes.end()) << testing::PrintToString(step);
  }
  const auto has = [&](const Bytes& write) {
    return std::find(writes.begin(), writes.end(), write) != writes.end();
  };
  EXPECT_TRUE(has({0x2F, 0x00, 0x14, 0x02, 0x01, 0x00, 0x00, 0x00})) << "type 1 [L15961]";
  EXPECT_TRUE(has({0x2B, 0x00, 0x18, 0x03, 0x00, 0x00, 0x00, 0x00})) << "not 50 ms";
  EXPECT_TRUE(has({0x2F, 0xC2, 0x60, 0x01, 0x04, 0x00, 0x00, 0x00}));
  EXPECT_TRUE(has({0x23, 0x91, 0x60, 0x01, 0x00, 0x00, 0x04, 0x00}));
  EXPECT_TRUE(has({0x23, 0x91, 0x60, 0x02, 0x35, 0x0C, 0x00, 0x00}));
}

// Transitions 2, 3, 4 and 1, as printed [L511-536]; then bit 4 of ip.
TEST(Sv660cWire, EnablesOneStateACommandAndSeesEachInTheStatusword) {
  Sv660cTrace scene(sv660cJoint(", mode: ip"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  scene.run(100ms);
  scene.frames.clear();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success) << scene.told();
  scene.run(100ms);
  EXPECT_EQ(scene.words(0x201, 0xFFFF), (std::vector<int>{0x00, 0x06, 0x07, 0x0F, 0x1F}));
  EXPECT_EQ(scene.words(0x181, 0x3FF), (std::vector<int>{0x0250, 0x0231, 0x0233, 0x0237}));
  EXPECT_EQ(scene.state("joint").state, State::operation_enabled);
}

TEST(Sv660cWire, ResetsAFaultByOneEdgeOfBit7AndTakesItBack) {
  Sv660cTrace scene(sv660cJoint(", mode: ip"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success) << scene.told();
  scene.frames.clear();
  scene.inject("joint", "position_command");
  scene.run(500ms);
  EXPECT_EQ(scene.state("joint").state, State::fault);
  ASSERT_TRUE(scene.procedure(ProcedureKind::clear_faults, "joint").success) << scene.told();
  scene.run(100ms);
  EXPECT_EQ(scene.words(0x201, 0x80), (std::vector<int>{0, 0x80, 0}));
  const auto words = scene.words(0x181, 0x3FF);
  const std::vector<int> ends(words.end() - 2, words.end());
  EXPECT_EQ(ends, (std::vector<int>{0x0218, 0x0250}));
}

// Quick stop with 605Ah = 2: 0x0002, then the drive goes to switch on disabled by itself.
TEST(Sv660cWire, StopsQuicklyByClearingBit2) {
  Sv660cTrace scene(sv660cJoint(", mode: ip"));
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable, "joint").success) << scene.told();
  ASSERT_EQ(scene.setpoint("joint", 1.0), "");
  scene.run(600ms);
  scene.frames.clear();
  ASSERT_TRUE(scene.procedure(ProcedureKind::quick_stop, "joint").success) << scene.told();
  scene.run(200ms);
  const auto sent = scene.words(0x201, 0xFFEF);
  EXPECT_NE(std::find(sent.begin(), sent.end(), 0x0002), sent.end());
  EXPECT_EQ(scene.words(0x181, 0x3FF), (std::vector<int>{0x0237, 0x0217, 0x0250}));
}

}  // namespace
}  // namespace cia402
