// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A servo in canopen-python/canopen#306 answers nothing where it should abort: what a drive need
// not have counts as missing then, as it goes on answering for other objects.
#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

struct Silence {
  const char* name;
  const char* request;  ///< that gets no answer
};

void PrintTo(const Silence& silence, std::ostream* out) { *out << silence.name; }

constexpr Silence kOptional[] = {
    {"ProductCode", "603 40 18 10 02 00 00 00 00"},
    {"RevisionNumber", "603 40 18 10 03 00 00 00 00"},
    {"SerialNumber", "603 40 18 10 04 00 00 00 00"},
    {"ConsumerHeartbeat", "603 23 16 10 01 2C 01 7F 00"},
    {"ProducerHeartbeat", "603 2B 17 10 00 64 00 00 00"},
    {"CobIdOfSync", "603 40 05 10 00 00 00 00 00"},
    {"CobIdOfEmcy", "603 40 14 10 00 00 00 00 00"},
    {"InhibitTime", "603 40 00 18 03 00 00 00 00"},
    {"EventTimerOfATpdo", "603 40 00 18 05 00 00 00 00"},
    {"EventTimerOfAnRpdo", "603 40 00 14 05 00 00 00 00"},
    {"RpdoThatNobodyWants", "603 40 03 14 01 00 00 00 00"},
    {"TpdoThatNobodyWants", "603 40 03 18 01 00 00 00 00"},
};

constexpr Silence kMandatory[] = {
    {"DeviceType", "603 40 00 10 00 00 00 00 00"},
    {"CobIdOfATpdo", "603 40 00 18 01 00 00 00 00"},
    {"TransmissionType", "603 40 00 18 02 00 00 00 00"},
    {"NumberOfMappedObjects", "603 40 00 1A 00 00 00 00 00"},
};

class BootSilence : public test::NodeFixture, public testing::WithParamInterface<Silence> {
 protected:
  void bootWithout(const char* request) {
    peer.forget(request);
    boot();
    for (int i = 0; i < 100 && node->health() == Health::booting; ++i) {
      hear("703 7F");
      pass(milliseconds(100));
    }
  }
  std::ptrdiff_t asked() const {
    return std::count(peer.sent.begin(), peer.sent.end(), GetParam().request);
  }
};

class BootWithout : public BootSilence {};

TEST_P(BootWithout, IsDoneAfterThreeRequests) {
  bootWithout(GetParam().request);
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_EQ(asked(), 3);
}

INSTANTIATE_TEST_SUITE_P(Optional, BootWithout, testing::ValuesIn(kOptional),
                         [](const auto& param) { return std::string(param.param.name); });

class BootFailsWithout : public BootSilence {};

TEST_P(BootFailsWithout, NamesTheObject) {
  bootWithout(GetParam().request);
  EXPECT_NE(node->health(), Health::ready);
  const std::string request = GetParam().request;  // "603 40 lo hi sub ..."
  const std::string object =
      request.substr(10, 2) + request.substr(7, 2) + ":" + request.substr(13, 2);
  EXPECT_THAT(node->problem(), HasSubstr(object));
  EXPECT_THAT(node->problem(), HasSubstr("no answer"));
}

INSTANTIATE_TEST_SUITE_P(Mandatory, BootFailsWithout, testing::ValuesIn(kMandatory),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace cia402::canopen
