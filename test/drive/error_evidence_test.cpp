// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Which error a drive is said to have: EMCY, 603Fh and 1001h against each other.
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;
using test::testConfig;

test::Layout withoutErrorCode() {
  test::Layout layout = test::testLayout();
  layout.inputs.pop_back();  // velocity, torque, error code
  return layout;
}

TEST(ErrorEvidence, AFaultIsNamedByItsEmergencyAndNotByTheWarningThatStoodBefore) {
  for (const test::Layout& layout : {test::testLayout(), withoutErrorCode()}) {
    Bench bench(testConfig(), layout);
    bench.drive.warning = true;
    bench.drive.error_object = 0x3220;
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.enable());
    bench.run(milliseconds(500));
    bench.fail(0x8611);
    bench.run(milliseconds(200));
    EXPECT_EQ(bench.axis.state().error_code, 0x8611);
    EXPECT_THAT(bench.axis.faultText(), HasSubstr("fault 0x8611 following error"));
  }
}

TEST(ErrorEvidence, AFaultIsNamedByTheErrorCodeThatCameWithIt) {
  for (const milliseconds before : {milliseconds(40), milliseconds(1000)}) {
    Bench bench;
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.enable());
    bench.emergency(0x3220);  // it has never ended
    bench.run(before);
    bench.drive.fail(0x8611);  // its own EMCY is lost
    bench.run(milliseconds(100));
    EXPECT_EQ(bench.axis.state().error_code, 0x8611) << before.count();
  }
}

TEST(ErrorEvidence, ADriveThatTellsOnlyByServiceDataObjectIsAsked) {
  Bench bench(testConfig(), withoutErrorCode());
  ASSERT_TRUE(bench.boot());
  bench.drive.fail(0x8611);
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.axis.state().error_code, 0x8611);
}

TEST(ErrorEvidence, WhatWasResetDoesNotNameTheNextFault) {
  for (const test::Layout& layout : {test::testLayout(), withoutErrorCode()}) {
    Bench bench(testConfig(), layout);
    bench.drive.error_object = 0;
    ASSERT_TRUE(bench.boot());
    bench.fail(0x8611);
    bench.run(milliseconds(200));
    ASSERT_EQ(bench.axis.state().error_code, 0x8611);
    ASSERT_TRUE(bench.perform(ProcedureKind::clear_faults).success);
    EXPECT_EQ(bench.axis.state().error_code, 0);
    bench.drive.fail(0x7305);  // its EMCY is lost
    bench.run(milliseconds(200));
    EXPECT_EQ(bench.axis.state().state, State::fault);
    EXPECT_EQ(bench.axis.state().error_code, 0);
  }
}

TEST(ErrorEvidence, ADriveThatTellsOnlyByServiceDataObjectIsAskedAboutEachFault) {
  Bench bench(testConfig(), withoutErrorCode());
  ASSERT_TRUE(bench.boot());
  bench.drive.fail(0x8611);
  bench.run(milliseconds(100));
  ASSERT_EQ(bench.axis.state().error_code, 0x8611);
  ASSERT_TRUE(bench.perform(ProcedureKind::clear_faults).success);
  bench.drive.fail(0x7305);
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.axis.state().error_code, 0x7305);
}

TEST(ErrorEvidence, WhatComesLongAfterTheFaultDoesNotRenameIt) {
  Bench bench;
  bench.drive.error_object = 0;
  ASSERT_TRUE(bench.boot());
  bench.fail(0x8611);
  bench.run(milliseconds(700));
  bench.emergency(0x8130);
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.axis.state().error_code, 0x8611);
}

TEST(ErrorEvidence, AnEmergencyWhileTheDriveStopsIsNewerThanTheErrorCode) {
  Bench bench;
  bench.drive.error_object = 0x3220;
  ASSERT_TRUE(bench.boot());
  bench.drive.fail(0x8611);
  bench.run(milliseconds(40));
  bench.emergency(0x8611);
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.axis.state().error_code, 0x8611);
}

TEST(ErrorEvidence, AWarningIsNamedByTheErrorCode) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.drive.warning = true;
  bench.drive.error_object = 0x4210;
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.axis.state().error_code, 0x4210);
  EXPECT_THAT(bench.axis.faultText(), HasSubstr("shoulder (node 3): warning 0x4210"));
  bench.drive.warning = false;
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.axis.state().error_code, 0) << "603Fh alone is a memory";
  EXPECT_EQ(bench.axis.faultText(), "");
}

TEST(ErrorEvidence, AWarningIsNotNamedByAnEmergencyThatHasEnded) {
  Bench bench;
  bench.drive.error_object = 0x4210;
  ASSERT_TRUE(bench.boot());
  bench.emergency(0x8611);
  bench.emergency(0);
  bench.drive.warning = true;
  bench.run(milliseconds(40));
  EXPECT_EQ(bench.axis.state().error_code, 0x4210);
}

TEST(ErrorEvidence, AnEmergencyThatNobodyEndsIsOverOnceTheErrorRegisterIsZero) {
  Bench bench;
  bench.drive.dictionary[{0x1001, 0}] = {0x09, 1};
  ASSERT_TRUE(bench.boot());
  bench.emergency(0x4210);
  bench.run(milliseconds(5000));
  EXPECT_EQ(bench.axis.state().error_code, 0x4210);
  EXPECT_THAT(bench.axis.faultText(), HasSubstr("error reported 0x4210"));
  bench.drive.dictionary[{0x1001, 0}].first = 0;
  bench.run(milliseconds(2000));
  EXPECT_EQ(bench.axis.state().error_code, 0);
  EXPECT_EQ(bench.axis.faultText(), "");
}

TEST(ErrorEvidence, ADriveThatAnswersNothingIsAskedAgainLater) {
  Bench bench;
  bench.drive.dictionary[{0x1001, 0}] = {0, 1};
  ASSERT_TRUE(bench.boot());
  bench.drive.mute = true;
  bench.emergency(0x4210);
  bench.run(milliseconds(6000));
  EXPECT_EQ(bench.axis.state().error_code, 0x4210);
  bench.drive.mute = false;
  bench.run(milliseconds(14000));
  EXPECT_EQ(bench.axis.state().error_code, 0);
}

TEST(ErrorEvidence, WithoutAnErrorRegisterClearFaultsForgetsTheEmergency) {
  Bench bench;  // has no 1001h, and answers so
  ASSERT_TRUE(bench.boot());
  ASSERT_TRUE(bench.enable());
  bench.emergency(0x8611);
  bench.run(milliseconds(5000));
  EXPECT_EQ(bench.axis.state().error_code, 0x8611);
  const ProcedureStatus& status = bench.perform(ProcedureKind::clear_faults);
  EXPECT_TRUE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder: no fault; the emergency that the drive has not "
                                        "ended is forgotten: 0x8611 following error"));
  EXPECT_EQ(bench.axis.state().error_code, 0);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::enabled) << "and nothing else is done";
  EXPECT_EQ(bench.drive.resets, 0);
}

TEST(ErrorEvidence, TheDriveItselfEndsAnEmergency) {
  Bench bench;
  ASSERT_TRUE(bench.boot());
  bench.emergency(0x8611);
  bench.run(milliseconds(8));
  EXPECT_EQ(bench.axis.state().error_code, 0x8611);
  bench.emergency(0);
  bench.run(milliseconds(8));
  EXPECT_EQ(bench.axis.state().error_code, 0);
}

}  // namespace
}  // namespace cia402::drive
