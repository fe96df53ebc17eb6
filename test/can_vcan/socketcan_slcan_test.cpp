// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SocketCan on a network driver of the kernel's can-dev, the one for serial adapters: the adapter
// is this test, at the other end of a pseudo terminal.
#include <fcntl.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): posix_openpt
#include <sys/ioctl.h>
#include <termios.h>

#include <atomic>
#include <cerrno>
#include <thread>

#include "can/link_settings.h"
#include "can_vcan/vcan_fixture.h"

namespace cia402::can {
namespace {

constexpr int kSlcanDiscipline = 17;  // N_SLCAN of linux/tty.h

class SerialAdapter : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!run("modprobe slcan")) {
      run("insmod /usr/lib/uml/modules/$(uname -r)/kernel/drivers/net/can/slcan/slcan.ko");
    }
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_GE(master_, 0);
    ASSERT_EQ(::grantpt(master_), 0);
    ASSERT_EQ(::unlockpt(master_), 0);
    slave_ = ::open(::ptsname(master_), O_RDWR | O_NOCTTY);
    ASSERT_GE(slave_, 0);
    termios settings{};
    ::tcgetattr(slave_, &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(slave_, TCSANOW, &settings);
    int discipline = kSlcanDiscipline;
    if (::ioctl(slave_, TIOCSETD, &discipline) != 0 && !onUserModeLinux()) {
      GTEST_SKIP() << "this kernel lets nobody attach a serial adapter here";
    }
    char name[IFNAMSIZ] = {};
    ASSERT_EQ(::ioctl(slave_, 0x8910 /* SIOCGIFNAME */, name), 0) << "no slcan";
    name_ = name;
    reader_ = std::thread([this] {  // the kernel waits for its commands to be read
      char bytes[64];
      while (!done_) {
        if (::read(master_, bytes, sizeof bytes) <= 0) std::this_thread::sleep_for(milliseconds(2));
      }
    });
    ASSERT_TRUE(
        run("ip link set " + name_ + " type can bitrate 500000 && ip link set " + name_ + " up"));
  }
  void TearDown() override {
    if (!name_.empty()) run("ip link set " + name_ + " down");
    done_ = true;
    if (reader_.joinable()) reader_.join();
    if (slave_ >= 0) ::close(slave_);
    if (master_ >= 0) ::close(master_);
  }
  // The adapter speaks.
  void say(const std::string& line) {
    const std::string text = line + "\r";
    ASSERT_EQ(::write(master_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  std::string name_;
  int master_ = -1, slave_ = -1;
  std::atomic<bool> done_{false};
  std::thread reader_;
};

TEST_F(SerialAdapter, ShowsItsSettingsAndCannotBeRestarted) {
  const LinkReader reader;
  const auto link = reader.read(name_);
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "can");
  EXPECT_TRUE(link->up && link->carrier);
  EXPECT_EQ(link->bitrate, 500000u);
  EXPECT_EQ(link->restart_ms, 0u);
  EXPECT_EQ(link->controller, BusState::error_active);
  EXPECT_FALSE(link->real_controller);
  EXPECT_TRUE(link->events);
  EXPECT_EQ(reader.restart(*link), EOPNOTSUPP) << "asked for it, this kernel would crash";
  const auto findings = findingsOf(*link, 1'000'000, milliseconds(4), true);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_THAT(findings[0].text, HasSubstr("runs at 500000 bit/s"));
  EXPECT_THAT(findings[1].text, HasSubstr("stays off after bus-off"));
}

TEST_F(SerialAdapter, ThatFallsOffTheBusIsToldHowToComeBack) {
  SocketCan::Options options;
  options.check_period = milliseconds(20);
  SocketCan can(name_, options);
  ASSERT_TRUE(becomes(can, BusState::error_active)) << can.describe();  // its carrier comes late
  say("t7011"
      "05");
  const auto received = receiveWithin(can, kPatience);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->frame, Frame(0x701, {5}));

  say("sp000130");
  ASSERT_TRUE(becomes(can, BusState::error_passive)) << can.describe();
  say("sb000255");
  ASSERT_TRUE(becomes(can, BusState::bus_off)) << can.describe();
  EXPECT_FALSE(can.send(Frame(0x080, {})));
  const Time end = now() + kPatience;
  while (can.recovery().empty() && now() < end) can.maintain(now());
  EXPECT_THAT(can.recovery(), HasSubstr("its kernel driver cannot restart it: run `ip link set " +
                                        name_ + " down; ip link set " + name_ + " up`"));
  EXPECT_EQ(can.state(), BusState::bus_off);
  EXPECT_THAT(can.describe(), HasSubstr("cannot restart it"));

  ASSERT_TRUE(run("ip link set " + name_ + " down && ip link set " + name_ + " up"));
  ASSERT_TRUE(becomes(can, BusState::error_active)) << can.describe();
  EXPECT_TRUE(takes(can, Frame(0x080, {}))) << can.describe();
  EXPECT_EQ(can.recovery(), "");
}

}  // namespace
}  // namespace cia402::can
