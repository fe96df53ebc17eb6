// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/bus/runner.h"

#include <pthread.h>
#include <sys/mman.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/robot_world.h"

namespace cia402::bus {
namespace {

using drive::ProcedureKind;
using test::FakeDrive;
using testing::HasSubstr;

/// What the test sees and sets of an interface that the runner owns.
struct Wire {
  std::atomic<can::BusState> state{can::BusState::error_active};
  std::atomic<int> frames{0};
  std::atomic<std::uint64_t> bus_off_events{0};
  std::atomic<long> rounds{0};  ///< of the bus thread
  std::promise<void> first_frame, shut_down;
  std::function<void()> while_flushing;  ///< called once, after the last frame was sent
  std::atomic<int> emergencies{0};       ///< that the shoulder has still to send
  std::atomic<bool> flood{false};        ///< always another frame
  std::promise<std::array<std::uint8_t, 8>> first_time;  ///< message of the service TIME
};

/// An interface with the drives shoulder and elbow behind it; used by the bus thread only.
class FakeInterface : public can::Interface {
 public:
  explicit FakeInterface(std::shared_ptr<Wire> wire) : wire_(std::move(wire)) {}

  bool send(const can::Frame& frame) override {
    if (wire_->frames++ == 0) wire_->first_frame.set_value();
    if (frame == can::Frame(0x000, {0x80, 0x00})) {
      wire_->shut_down.set_value();
      rounds_left_ = 3;
    }
    if (frame.id == 0x100 && times_++ == 0) wire_->first_time.set_value(frame.data);
    for (FakeDrive& drive : drives_) drive.receive(frame, now_);
    return true;
  }
  std::optional<can::ReceivedFrame> receive(Time now) override {
    now_ = now;
    if (wire_->flood) return can::ReceivedFrame{can::Frame(0x7A0, {}), now};
    if (wire_->emergencies > 0) {
      --wire_->emergencies;
      return can::ReceivedFrame{can::Frame(0x081, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0}), now};
    }
    for (FakeDrive& drive : drives_) {
      drive.tick(now);
      if (drive.out.empty()) continue;
      const can::ReceivedFrame received{drive.out.front(), now};
      drive.out.pop_front();
      ++counters_.frames_received;
      return received;
    }
    return std::nullopt;
  }
  void maintain(Time) override {
    ++wire_->rounds;
    counters_.bus_off_events = wire_->bus_off_events;
    if (rounds_left_ > 0 && --rounds_left_ == 0 && wire_->while_flushing) wire_->while_flushing();
  }
  Time nextDeadline() const override {
    Time next = kNever;
    for (const FakeDrive& drive : drives_) {
      next = std::min(next, drive.out.empty() ? drive.nextDeadline() : Time{});
    }
    return next;
  }
  int fd() const override { return -1; }
  can::BusState state() const override { return wire_->state; }
  const can::BusCounters& counters() const override { return counters_; }
  std::string describe() const override {
    return std::string("can0 is ") + can::toString(wire_->state);
  }
  std::size_t pending() const override { return 3; }
  std::optional<ErrorCounters> errorCounters() const override { return ErrorCounters{12, 34}; }

 private:
  std::shared_ptr<Wire> wire_;
  std::array<FakeDrive, 2> drives_{FakeDrive(1), FakeDrive(2)};
  can::BusCounters counters_;
  Time now_{};
  int rounds_left_ = 0, times_ = 0;
};

struct BusRunnerTest : testing::Test {
  BusRunnerTest() {
    config::RobotConfig robot = test::testRobot();
    robot.bus.sync_period = std::chrono::milliseconds(10);  // sanitizers are slow
    for (drive::AxisConfig& axis : robot.axes) axis.homing = test::homingOfOrder(0);
    runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                         std::make_unique<FakeInterface>(wire), options());
  }
  static BusRunner::Options options() {
    BusRunner::Options options;
    options.priority = 0;
    return options;
  }
  std::future<Answer> post(decltype(Command::body) body) {
    auto promise = std::make_shared<std::promise<Answer>>();
    Command command;
    command.body = std::move(body);
    command.reply = [promise](const Answer& answer) { promise->set_value(answer); };
    auto future = promise->get_future();
    posted = runner->post(std::move(command));
    return future;
  }
  std::future<Answer> post(ProcedureKind kind) {
    ProcedureCommand command;
    command.request.kind = kind;
    return post(command);
  }
  /// Returns when the bus thread has come round.
  void meet() {
    CallCommand call;
    call.function = [](Time) { return Answer(); };
    post(call).wait();
  }
  void waitFor(const std::function<bool()>& condition) {
    while (!condition()) meet();
  }
  bool seen(const std::string& words) {
    Event event;
    while (runner->nextEvent(event)) events += event.text.str() + "\n";
    return events.find(words) != std::string::npos;
  }
  bool ready() {
    const RobotSnapshot snapshot = runner->snapshot();
    return std::all_of(snapshot.axes.begin(), snapshot.axes.end(), [](const AxisSnapshot& axis) {
      return axis.state.health == canopen::NodeHealth::ready && axis.state.feedback_valid;
    });
  }

  std::shared_ptr<Wire> wire = std::make_shared<Wire>();
  std::unique_ptr<BusRunner> runner;
  std::string events;
  bool posted = false;
};

TEST_F(BusRunnerTest, RefusesCommandsBeforeItsStart) {
  auto answer = post(ProcedureKind::enable);
  EXPECT_FALSE(posted);
  EXPECT_EQ(answer.get().message, "refused: the driver is not running");
}

TEST_F(BusRunnerTest, EndsCleanlyThoughItWasNeverStarted) {
  runner.reset();
  EXPECT_EQ(wire->frames, 0);
}

TEST_F(BusRunnerTest, WaitsForAMissingInterfaceAndStartsTheRobotWhenItIsThere) {
  wire->state = can::BusState::missing;
  runner->start();
  waitFor([&] { return seen("can0 is missing"); });
  EXPECT_EQ(post(ProcedureKind::enable).get().message,
            "refused: the bus interface can0 is not there yet");
  EXPECT_EQ(wire->frames, 0);
  wire->state = can::BusState::error_active;
  wire->first_frame.get_future().wait();
  waitFor([&] { return seen("elbow (node 2): booted in"); });
  EXPECT_EQ(runner->snapshot().bus_state, can::BusState::error_active);
}

TEST_F(BusRunnerTest, CarriesCommandsOutAndShowsTheResultInItsSnapshot) {
  runner->start();
  waitFor([&] { return ready(); });
  const Answer enabled = post(ProcedureKind::enable).get();
  EXPECT_TRUE(enabled.success) << enabled.message;
  waitFor(
      [&] { return runner->snapshot().axes[1].state.state == drive::State::operation_enabled; });
  const RobotSnapshot snapshot = runner->snapshot();
  EXPECT_GT(snapshot.statistics.cycles(), 0u);
  EXPECT_GT(snapshot.counters.frames_received, 0u);
  EXPECT_EQ(snapshot.axes.size(), 2u);
  EXPECT_EQ(runner->lostEvents(), 0u);
}

TEST_F(BusRunnerTest, ShowsItsInterfaceInItsSnapshot) {
  wire->state = can::BusState::error_passive;
  std::atomic<std::int64_t> ahead_ms{0};
  BusRunner::Options ahead = options();
  ahead.clock = [&] { return realNow() + std::chrono::milliseconds(ahead_ms); };
  const config::RobotConfig robot = test::testRobot();
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<FakeInterface>(wire), ahead);
  runner->start();
  waitFor([&] { return ready(); });
  const Time before = runner->time().now();
  ahead_ms = 2000;  // the second in which frames are counted is over
  waitFor([&] { return runner->snapshot().now > before + std::chrono::milliseconds(1000); });
  const RobotSnapshot snapshot = runner->snapshot();
  EXPECT_EQ(snapshot.bus_text, "can0 is error passive");
  EXPECT_EQ(snapshot.pending, 3u);
  ASSERT_TRUE(snapshot.error_counters);
  EXPECT_EQ(snapshot.error_counters->transmit, 12);
  EXPECT_EQ(snapshot.error_counters->receive, 34);
  EXPECT_GT(snapshot.bus_load, 0.0);
  EXPECT_GT(snapshot.most_bus_load, snapshot.bus_load) << "with the most stuff bits";
  EXPECT_LT(snapshot.most_bus_load, 1.0);
  EXPECT_LE(snapshot.now, runner->time().now());
  runner.reset();
}

TEST_F(BusRunnerTest, CountsTheEmergenciesThatNobodyTakes) {
  runner->start();
  waitFor([&] { return ready(); });
  wire->emergencies = 5000;
  waitFor([&] { return wire->emergencies == 0; });
  meet();
  std::uint64_t taken = 0;
  EmergencyEvent event;
  while (runner->nextEmergency(event)) ++taken;
  EXPECT_LT(taken, 5000u);
  EXPECT_EQ(taken + runner->lostEmergencies(), 5000u);
}

// CiA 301, 7.2.6: milliseconds since midnight and days since 1 January 1984, here in UTC.
TEST_F(BusRunnerTest, SendsTheTimeOfTheWallClock) {
  config::RobotConfig robot = test::testRobot();
  robot.bus.time_interval = std::chrono::seconds(1);
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<FakeInterface>(wire), options());
  using std::chrono::milliseconds;
  const auto wall = [] {
    return std::chrono::duration_cast<milliseconds>(
        std::chrono::system_clock::now().time_since_epoch());
  };
  const milliseconds before = wall();
  runner->start();
  const std::array<std::uint8_t, 8> sent = wire->first_time.get_future().get();
  const std::int64_t of_day = sent[0] | sent[1] << 8 | sent[2] << 16 | sent[3] << 24;
  const std::int64_t days = sent[4] | sent[5] << 8;
  const milliseconds time(of_day + (days + 5113) * 86'400'000);
  EXPECT_GE(time, before - milliseconds(2)) << "to the millisecond";
  EXPECT_LE(time, wall() + milliseconds(2));
}

TEST_F(BusRunnerTest, AFloodDoesNotKeepItFromItsEnd) {
  wire->while_flushing = [&] { wire->flood = true; };
  runner->start();
  wire->first_frame.get_future().wait();
  runner->requestShutdown();
  runner->join();
  EXPECT_TRUE(wire->flood);
  EXPECT_FALSE(runner->running());
}

TEST_F(BusRunnerTest, ItsThreadIsKnownByItsName) {
  runner->start();
  std::array<char, 16> name{};
  CallCommand call;
  call.function = [&](Time) {
    pthread_getname_np(pthread_self(), name.data(), name.size());
    return Answer();
  };
  post(call).wait();
  EXPECT_STREQ(name.data(), "bus");
}

TEST_F(BusRunnerTest, EventsAreInItsRecordings) {
  char folder[] = "/tmp/runner_test_XXXXXX";
  config::RobotConfig robot = test::testRobot();
  robot.recorder.directory = mkdtemp(folder);
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<FakeInterface>(wire), options());
  runner->start();
  waitFor([&] { return seen("elbow (node 2): booted in"); });
  const RecordingService::News news = runner->recordings().request();
  EXPECT_TRUE(news.written) << news.text;
  std::ifstream in(news.log.substr(0, news.log.rfind('.')) + ".txt");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(text, HasSubstr("elbow (node 2): booted in"));
  runner.reset();
  std::filesystem::remove_all(folder);
}

TEST_F(BusRunnerTest, SleepsUntilSomethingIsDue) {
  runner->start();
  waitFor([&] { return ready(); });
  const auto cycles = [&] { return runner->snapshot().statistics.cycles(); };
  const std::uint64_t from = cycles();
  const long before = wire->rounds;
  while (cycles() < from + 20) std::this_thread::yield();
  EXPECT_LT(wire->rounds - before, 20 * 100);
}

TEST_F(BusRunnerTest, RefusesCommandsAfterItsEnd) {
  runner->start();
  wire->first_frame.get_future().wait();
  runner->requestShutdown();
  runner->join();
  EXPECT_FALSE(runner->running());
  EXPECT_TRUE(runner->snapshot().shut_down);
  auto answer = post(ProcedureKind::enable);
  EXPECT_FALSE(posted);
  EXPECT_EQ(answer.get().message, "refused: the driver is not running");
}

TEST_F(BusRunnerTest, ShutsDownInItsDestructorAndAnswersWhatWaits) {
  runner->start();
  waitFor([&] { return ready(); });
  std::vector<std::future<Answer>> answers;
  answers.push_back(post(ProcedureKind::home));
  for (int i = 0; i < 50; ++i) answers.push_back(post(ReadObjectCommand{"elbow", "6098:00"}));
  runner.reset();
  for (auto& answer : answers) EXPECT_FALSE(answer.get().message.empty());
  wire->shut_down.get_future().wait();
}

TEST_F(BusRunnerTest, AnswersCommandsThatComeWhileItEnds) {
  std::future<Answer> answer;
  wire->while_flushing = [&] { answer = post(ProcedureKind::enable); };
  runner->start();
  wire->first_frame.get_future().wait();
  runner->requestShutdown();
  runner->join();
  ASSERT_TRUE(posted);
  ASSERT_EQ(answer.wait_for(std::chrono::seconds(0)), std::future_status::ready);
  EXPECT_EQ(answer.get().message, "refused: the driver is shutting down");
}

TEST_F(BusRunnerTest, RefusesCommandsThatFindNoRoom) {
  runner->start();
  std::promise<void> arrived, release;
  CallCommand call;
  call.function = [&](Time) {
    arrived.set_value();
    release.get_future().wait();
    return Answer();
  };
  auto blocking = post(call);
  arrived.get_future().wait();
  std::vector<std::future<Answer>> queued;
  do {
    queued.push_back(post(SetpointCommand{0, 1.0}));
  } while (posted && queued.size() < 1000);
  EXPECT_EQ(queued.size(), 257u);
  EXPECT_EQ(queued.back().get().message, "refused: too many commands are waiting, try again");
  release.set_value();
  blocking.wait();
  meet();
}

TEST_F(BusRunnerTest, RecordsABusOffThatIsOverBeforeItLooks) {
  char folder[] = "/tmp/runner_test_XXXXXX";
  config::RobotConfig robot = test::testRobot();
  robot.recorder.directory = mkdtemp(folder);
  robot.recorder.keep = 1;
  robot.recorder.post_trigger = Duration::zero();
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<FakeInterface>(wire), options());
  runner->start();
  wire->first_frame.get_future().wait();
  wire->bus_off_events = 1;
  RecordingService::News news;
  waitFor([&] { return runner->recordings().nextNews(news); });
  EXPECT_THAT(news.text, HasSubstr("bus-off"));
  EXPECT_TRUE(seen("can0 was bus-off for a moment"));
  runner.reset();
  std::filesystem::remove_all(folder);
}

TEST_F(BusRunnerTest, TellsWhatTheOperatingSystemGranted) {
  config::RobotConfig robot = test::testRobot();
  BusRunner::Options options;
  options.priority = 1;
  runner = std::make_unique<BusRunner>(robot, test::masterOf(robot),
                                       std::make_unique<FakeInterface>(wire), options);
  const Time before = realNow();
  runner->start();
  meet();
  const RealtimeReport report = runner->realtime();
  EXPECT_THAT(report.text, HasSubstr("bus thread"));
  Event event;
  do {
    ASSERT_TRUE(runner->nextEvent(event)) << report.text;
  } while (event.text.str().substr(0, 100) != report.text.substr(0, 100));
  EXPECT_GE(event.stamp, before);
  EXPECT_LE(event.stamp, realNow());
  runner.reset();
  munlockall();
}

}  // namespace
}  // namespace cia402::bus
