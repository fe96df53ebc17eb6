// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a device forbids to write, because its parameters may be locked.
#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using test::frame;

class SdoLockTest : public test::SdoClientFixture {};

// 2002:16 = 2 of a drive whose parameters are locked: it forbids writes, whatever the value.
TEST_F(SdoLockTest, a_write_that_is_forbidden_names_what_may_lock_it) {
  SdoClient with_lock{1, peer, options(), {}, nullptr, "parameters may be locked"};
  struct Case {
    const char* answer;
    bool forbidden;
  };
  for (const Case& test : {Case{"581 80 60 60 00 00 00 01 06", true},      // unsupported access
                           Case{"581 80 60 60 00 02 00 01 06", true},      // read only
                           Case{"581 80 60 60 00 20 00 00 08", true},      // cannot be stored
                           Case{"581 80 60 60 00 21 00 00 08", true},      // local control
                           Case{"581 80 60 60 00 22 00 00 08", true},      // device state
                           Case{"581 80 60 60 00 30 00 09 06", false},     // value
                           Case{"581 80 60 60 00 00 00 02 06", false}}) {  // no such object
    const SdoTicket ticket = with_lock.download({0x6060, 0}, {8}, "mode");
    with_lock.tick(now);
    with_lock.receive(frame(test.answer), now);
    ASSERT_TRUE(ticket->done()) << test.answer;
    EXPECT_EQ(ticket->message().find("; parameters may be locked") != std::string::npos,
              test.forbidden)
        << ticket->message();
  }
  const SdoTicket read = with_lock.upload({0x6060, 0}, "mode");
  with_lock.tick(now);
  with_lock.receive(frame("581 80 60 60 00 22 00 00 08"), now);
  ASSERT_TRUE(read->done());
  EXPECT_EQ(read->message().find("locked"), std::string::npos) << read->message();
}

}  // namespace
}  // namespace cia402::canopen
