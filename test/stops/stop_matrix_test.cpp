// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every stop in every mode, with whatever may follow within 10 ms, on time and late: docs/stops.md.
//   CIA402_STOPS_WHOLE=1   plays all cases; else all that are on time, all of a stop that nothing
//                          follows, and a quarter of the other late ones
//   CIA402_STOPS_FEW=1     plays an eighth of these, and compares nothing with docs/stops.md: for
//                          sanitizers, which look at the driver's memory
//   CIA402_STOPS_WRITE=1   writes the rows of the tests that run to docs/stops.md
//   CIA402_STOPS_CASE=...  plays one case, by its words, and prints what the motor does
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>

#include "config/drive_family.h"
#include "folders.h"
#include "stops/stop_table.h"
#include "system/scene.h"

namespace cia402::stops {
namespace {

bool asked(const char* variable) { return std::getenv(variable) != nullptr; }
bool whole() { return asked("CIA402_STOPS_WHOLE"); }
bool few() { return asked("CIA402_STOPS_FEW"); }
constexpr std::size_t kFew = 8;

const LoadedRobot& robotOf(Stop stop, const Mover& mover) {
  static std::map<std::string, LoadedRobot> robots;
  const std::string yaml = yamlOf(mover, stop == Stop::empty_trajectory);
  const auto found = robots.find(yaml);
  if (found != robots.end()) return found->second;
  return robots.emplace(yaml, loadText(yaml)).first->second;
}

struct Cell {
  Stop stop;
  Mover mover;
  friend std::ostream& operator<<(std::ostream& out, const Cell& cell) {
    return out << rowName(cell.stop, cell.mover);
  }
};

std::vector<Cell> cells() {
  std::vector<Cell> made;
  for (const Stop stop : kStops) {
    for (const Mover& mover : movers()) {
      if (applies(stop, mover)) made.push_back({stop, mover});
    }
  }
  return made;
}

void print(const Trace& trace, const std::string& told) {
  for (std::size_t i = 0; i < trace.samples.size(); ++i) {
    std::cout << i << " ms  " << number(trace.samples[i].position) << " rad  "
              << number(trace.samples[i].velocity) << " rad/s\n";
  }
  for (const Trace::Answered& answer : trace.answers) {
    std::cout << answer.at << " ms  " << answer.call << (answer.success ? ": " : " failed: ")
              << answer.message << "\n";
  }
  std::cout << told;
}

/// What was measured, for the table.
std::map<std::string, Row>& measured() {
  static std::map<std::string, Row> rows;
  return rows;
}

class StopMatrix : public testing::TestWithParam<Cell> {};

TEST_P(StopMatrix, ComesToRestWithinItsBound) {
  const auto& [stop, mover] = GetParam();
  const char* const chosen = std::getenv("CIA402_STOPS_CASE");
  std::string failures;
  std::size_t failed = 0, played = 0, index = 0;
  Row row;
  for (const Case& tested : casesOf(stop, mover, whole() || chosen != nullptr)) {
    if (chosen != nullptr && text(tested) != chosen) continue;
    if (index++ % kFew != 0 && few()) continue;
    Play play(robotOf(stop, mover), tested);
    const Trace trace = play.play();
    const Verdict verdict = judge(tested, trace);
    ++played;
    if (chosen != nullptr) print(trace, play.told());
    const bool longer = tested.follower == Follower::host_death ||
                        tested.follower == Follower::restart || trace.taken || tested.young > 0ms;
    if (!longer) row.add(tested, verdict);
    if (verdict.findings.empty()) continue;
    ++failed;
    failures += text(tested) + ":\n";
    for (const std::string& finding : verdict.findings) failures += "    " + finding + "\n";
  }
  EXPECT_TRUE(failures.empty()) << failed << " of " << played << " cases:\n" << failures;
  if (chosen != nullptr) return;
  const std::string name = rowName(stop, mover);
  measured()[name] = row;
  if (whole() || few() || asked("CIA402_STOPS_WRITE")) return;
  EXPECT_EQ(compare(row, readTable()[name]), "") << name;
}

// Modes that go to positions or distances one by one are left out, as docs/stops.md says: to the
// drive they are profile position, and families_distances_test.cpp stops them.
TEST(Movers, AreInEachOtherModeOfEachProfile) {
  std::set<std::string> moved, known;
  for (const Mover& mover : movers()) moved.insert(mover.drive + " in " + mover.mode);
  const std::filesystem::path folder = test::configFolder() + "/drives";
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    Problems problems;
    const drive::DriveProfile profile =
        config::loadDriveFamily(file.path().string(), problems).drive;
    EXPECT_TRUE(problems.empty()) << problems.text();
    for (const drive::ModeSpec& mode : profile.modes) {
      if (mode.kind == drive::ControlKind::homing || mode.handover.oneByOne()) continue;
      known.insert(profile.name + " in " + mode.name);
    }
  }
  EXPECT_EQ(moved, known);
}

INSTANTIATE_TEST_SUITE_P(All, StopMatrix, testing::ValuesIn(cells()), [](const auto& tested) {
  return std::string(toString(tested.param.stop)) + "_in_" + tested.param.mover.name();
});

/// Rows of tests that were not run stay as they are.
class Table : public testing::Environment {
 public:
  void TearDown() override {
    if (!asked("CIA402_STOPS_WRITE")) return;
    std::map<std::string, Row> rows = readTable();
    for (const auto& [name, row] : measured()) rows[name] = row;
    std::vector<std::string> order;
    for (const Cell& cell : cells()) order.push_back(rowName(cell.stop, cell.mover));
    writeTable(rows, order);
  }
};
[[maybe_unused]] testing::Environment* const kTable = testing::AddGlobalTestEnvironment(new Table);

}  // namespace
}  // namespace cia402::stops
