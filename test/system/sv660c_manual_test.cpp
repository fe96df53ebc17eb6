// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The simulated SV660C, and its profile, against a table of the manual's pages of parameters
// (sv660c_parameters.csv), which was made from its text and from neither of them.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;

struct Sv660cPrinted {
  fieldbus::ObjectId id;
  std::string name, type, change, effect;
  unsigned digits = 0;
  std::int64_t lowest = 0, highest = 0;
  std::string standard;  ///< empty: printed in two ways
  unsigned bits() const { return type.compare(type.size() - 2, 2, "16") == 0 ? 16 : 32; }
  bool withSign() const { return type[0] == 'i'; }
};

std::vector<Sv660cPrinted> readManual() {
  std::ifstream file(test::testFolder() + "/system/sv660c_parameters.csv");
  std::vector<Sv660cPrinted> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line[0] == 'o') continue;
    std::vector<std::string> cells;
    std::istringstream words(line + ",");
    for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
    EXPECT_EQ(cells.size(), 9U) << line;
    Sv660cPrinted row;
    row.id = fieldbus::parseObjectId(cells[0]).value();
    row.name = cells[1];
    row.type = cells[2];
    row.digits = static_cast<unsigned>(std::stoul(cells[3]));
    row.lowest = std::strtoll(cells[4].c_str(), nullptr, 10);
    row.highest = std::strtoll(cells[5].c_str(), nullptr, 10);
    row.standard = cells[6];
    row.change = cells[7];
    row.effect = cells[8];
    rows.push_back(row);
  }
  EXPECT_EQ(rows.size(), 476U);
  return rows;
}

std::vector<std::uint8_t> sv660cBytes(const Sv660cPrinted& row, std::int64_t number) {
  std::vector<std::uint8_t> bytes;
  for (unsigned i = 0; i < row.bits(); i += 8) {
    bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> i));
  }
  return bytes;
}

std::int64_t sv660cValue(const Sv660cPrinted& row, std::uint64_t number) {
  const bool negative = row.withSign() && (number >> (row.bits() - 1)) != 0;
  return static_cast<std::int64_t>(number) -
         (negative ? static_cast<std::int64_t>(std::uint64_t{1} << row.bits()) : 0);
}

struct Sv660cManual : testing::Test {
  Sv660cManual() : scene(loadText(sv660cJoint())), rows(readManual()) {}
  sim::ObjectDictionary& dictionary() { return scene.drive("joint").dictionary(); }
  Scene scene;
  std::vector<Sv660cPrinted> rows;
};

// After H02.31 = 1, as the simulated drive is otherwise as a person has set it at its panel.
TEST_F(Sv660cManual, PrintsTheParametersThatTheDriveHasAndTheirDefaults) {
  EXPECT_EQ(dictionary().write({0x2002, 0x20}, {1, 0}), 0U);
  for (const Sv660cPrinted& row : rows) {
    const sim::Entry* entry = dictionary().find(row.id);
    ASSERT_NE(entry, nullptr) << row.name;
    EXPECT_EQ(fieldbus::toString(entry->type), row.type) << row.name;
    if (row.standard.empty()) continue;
    EXPECT_EQ(std::to_string(sv660cValue(row, entry->number)), row.standard) << row.name;
  }
}

// Others are printed narrower than what the same page describes: DO functions go to 31
// [L4474-4668], H05.41 has three bits [L5442-5473], H0A.33 a 2 [L8104-8120]; 8 of H0C.08 means
// nothing [L9283]. The highest of H00.67 and the lowest of H00.69 do not fit their objects and
// their defaults.
TEST_F(Sv660cManual, PrintsTheRangesThatTheDriveTakes) {
  const std::set<std::string> otherwise = {"H04.00", "H04.02", "H04.04", "H04.06", "H04.08",
                                           "H05.41", "H0A.33", "H0C.08", "H00.67", "H00.69"};
  for (const Sv660cPrinted& row : rows) {
    if (row.change == "RO" || otherwise.count(row.name) != 0) continue;
    const std::int64_t all = (std::int64_t{1} << (row.bits() - (row.withSign() ? 1 : 0))) - 1;
    const std::int64_t least = row.withSign() ? -all - 1 : 0;
    if (row.highest < all) {
      EXPECT_EQ(dictionary().write(row.id, sv660cBytes(row, row.highest + 1)), 0x06090031U)
          << row.name;
    }
    if (row.lowest > least) {
      EXPECT_EQ(dictionary().write(row.id, sv660cBytes(row, row.lowest - 1)), 0x06090032U)
          << row.name;
    }
  }
}

TEST_F(Sv660cManual, PrintsWhenTheDriveTakesThem) {
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(drive::ProcedureKind::enable).success) << scene.told();
  for (const Sv660cPrinted& row : rows) {
    const auto same =
        sv660cBytes(row, static_cast<std::int64_t>(dictionary().find(row.id)->number));
    const std::uint32_t wanted = row.change == "RO"  ? 0x06010002U
                                 : row.change == "S" ? 0x08000022U
                                                     : 0U;
    EXPECT_EQ(dictionary().write(row.id, same), wanted) << row.name << " " << row.change;
  }
}

// Each is written anew with the number that it holds: at once, once the motor has no power, once
// the drive's power was off.
TEST_F(Sv660cManual, PrintsWhenTheDriveGoesByThem) {
  ASSERT_TRUE(scene.boot()) << scene.told();
  const auto write = [this](const Sv660cPrinted& row, std::int64_t number) {
    EXPECT_EQ(dictionary().write(row.id, sv660cBytes(row, number)), 0U) << row.name;
  };
  for (const Sv660cPrinted& row : rows) {
    if (row.change == "RO") continue;
    const sim::Entry& entry = *dictionary().find(row.id);
    write(row, sv660cValue(row, entry.number));
    EXPECT_EQ(entry.waits, row.effect == "P" || row.effect == "D") << row.name;
  }
}

// H17.00 to H17.31 and H17.33 to H17.64: functions and logic of virtual inputs and outputs
// [L11922-13089].
TEST_F(Sv660cManual, PrintsThatVirtualTerminalsCountOnceItHasStopped) {
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(drive::ProcedureKind::enable).success) << scene.told();
  unsigned waiting = 0;
  for (unsigned number = 0; number <= 64; ++number) {
    const sim::Entry* entry = dictionary().find({0x2017, static_cast<std::uint8_t>(number + 1)});
    ASSERT_NE(entry, nullptr) << number;
    if (dictionary().write(entry->id, {1, 0}) != 0) continue;  // while stopped only
    EXPECT_EQ(entry->number, 1U) << number;
    EXPECT_EQ(entry->acting(), 0U) << number;
    ++waiting;
  }
  EXPECT_EQ(waiting, 16U) << "the functions of the virtual inputs";
  ASSERT_TRUE(scene.procedure(drive::ProcedureKind::disable).success) << scene.told();
  scene.run(100ms);
  for (unsigned number = 0; number < 32; number += 2) {
    const sim::Entry* entry = dictionary().find({0x2017, static_cast<std::uint8_t>(number + 1)});
    EXPECT_EQ(entry->acting(), 1U) << number;
  }
  for (unsigned number = 0; number <= 64; ++number) {
    const sim::Entry* entry = dictionary().find({0x2017, static_cast<std::uint8_t>(number + 1)});
    const bool shown_only = number == 32;  // the levels
    EXPECT_EQ(dictionary().write(entry->id, {1, 0}), shown_only ? 0x06010002U : 0U) << number;
    EXPECT_EQ(entry->waits, !shown_only) << number;
  }
}

// All that wait, with other numbers than they hold.
TEST_F(Sv660cManual, PrintsWhatIsReadAtOnceAndGoneByLater) {
  ASSERT_TRUE(scene.boot()) << scene.told();
  ASSERT_TRUE(scene.procedure(drive::ProcedureKind::enable).success) << scene.told();
  const auto change = [this](const char* effect) {
    for (const Sv660cPrinted& row : rows) {
      if (row.change == "RO" || row.effect != effect) continue;
      const sim::Entry& entry = *dictionary().find(row.id);
      const std::uint64_t before = entry.number;
      const std::int64_t other =
          sv660cValue(row, before) == row.lowest ? row.lowest + 1 : row.lowest;
      EXPECT_EQ(dictionary().write(row.id, sv660cBytes(row, other)), 0U) << row.name;
      EXPECT_EQ(sv660cValue(row, entry.number), other) << row.name;
      EXPECT_EQ(entry.acting(), before) << row.name;
    }
  };
  const auto waiting = [this](const char* effect) {
    return std::count_if(rows.begin(), rows.end(), [&](const Sv660cPrinted& row) {
      return row.effect == effect && dictionary().find(row.id)->waits;
    });
  };
  change("D");
  scene.run(500ms);
  EXPECT_EQ(waiting("D"), 24);
  ASSERT_TRUE(scene.procedure(drive::ProcedureKind::disable).success) << scene.told();
  scene.run(100ms);
  EXPECT_EQ(waiting("D"), 0);
  change("P");
  scene.run(500ms);
  EXPECT_EQ(waiting("P"), 51);
  scene.inject("joint", "power_cycle");
  scene.run(1s);
  EXPECT_EQ(waiting("P"), 0);
}

TEST_F(Sv660cManual, PrintsWhatTheProfileSaysOfEffectAndDigits) {
  const drive::DriveProfile& profile = *scene.axis("joint").config().profile;
  for (const Sv660cPrinted& row : rows) {
    EXPECT_EQ(profile.after_power.find(row.id) != nullptr, row.effect == "P") << row.name;
    const unsigned* digits = profile.parameter_names.decimals.find(row.id);
    EXPECT_EQ(digits == nullptr ? 0U : *digits, row.digits) << row.name;
    EXPECT_EQ(profile.parameter_names.nameOf(row.id), row.name);
    const auto type = profile.parameter_names.typeOf(row.id, row.bits() / 8);
    ASSERT_TRUE(type) << row.name;
    EXPECT_EQ(fieldbus::toString(*type), row.type) << row.name;
  }
}

}  // namespace
}  // namespace cia402
