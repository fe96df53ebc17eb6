// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/bus_condition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::bus {
namespace {

using can::BusState;
using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

NetworkSnapshot busThatIs(BusState state) {
  NetworkSnapshot snapshot;
  snapshot.bus_state = state;
  snapshot.bus_text.assign("can0");
  return snapshot;
}

TEST(BusCondition, IsThatOfTheController) {
  const auto condition = [](BusState state) {
    return busSummaryOf(busThatIs(state), 0.5, 0).condition;
  };
  EXPECT_EQ(condition(BusState::error_active), Condition::well);
  EXPECT_EQ(condition(BusState::error_warning), Condition::warning);
  EXPECT_EQ(condition(BusState::error_passive), Condition::warning);
  EXPECT_EQ(condition(BusState::bus_off), Condition::error);
  EXPECT_EQ(condition(BusState::down), Condition::error);
  EXPECT_EQ(condition(BusState::missing), Condition::error);
}

TEST(BusCondition, WarnsOfLoadAboveFourFifths) {
  const NetworkSnapshot well = busThatIs(BusState::error_active);
  EXPECT_EQ(busSummaryOf(well, 0.8, 0).condition, Condition::well);
  EXPECT_EQ(busSummaryOf(well, 0.8, 0).text, "can0");
  EXPECT_EQ(busSummaryOf(well, 0.84, 0).condition, Condition::warning);
  EXPECT_EQ(busSummaryOf(well, 0.84, 0).text, "bus load 84 %");
}

TEST(BusCondition, IsAnErrorWhereSyncIsNotAsItMustBe) {
  NetworkSnapshot snapshot = busThatIs(BusState::error_active);
  snapshot.sync_problem.assign("no SYNC comes");
  EXPECT_EQ(busSummaryOf(snapshot, 0.9, 0).condition, Condition::error);
  EXPECT_EQ(busSummaryOf(snapshot, 0.9, 0).text, "bus load 90 %; no SYNC comes");
}

TEST(BusCondition, WarnsOfCyclesThatWereLeftOut) {
  const Summary summary = busSummaryOf(busThatIs(BusState::error_active), 0.5, 3);
  EXPECT_EQ(summary.condition, Condition::warning);
  EXPECT_THAT(summary.text, AllOf(HasSubstr("3 cycles"), HasSubstr("bus/sync_period")));
}

TEST(SkippedCycles, AreForgottenTenSecondsAfterTheLastOne) {
  SkippedCycles skipped;
  Time now = Time(100s);
  skipped.look(2, now);
  EXPECT_EQ(skipped.lately(), 2u);
  skipped.look(2, now += 9s);
  skipped.look(5, now);
  EXPECT_EQ(skipped.lately(), 5u);
  skipped.look(5, now + 9s);
  EXPECT_EQ(skipped.lately(), 5u);
  skipped.look(5, now + 10s);
  EXPECT_EQ(skipped.lately(), 0u);
  skipped.look(6, now + 11s);
  EXPECT_EQ(skipped.lately(), 1u) << "those of before do not count again";
}

TEST(BusCondition, AFindingOfTheInterfaceSaysItselfWhatItIs) {
  can::LinkFinding finding;
  finding.error = true;
  EXPECT_EQ(conditionOf(finding), Condition::error);
  finding.error = false;
  EXPECT_EQ(conditionOf(finding), Condition::warning);
}

}  // namespace
}  // namespace cia402::bus
