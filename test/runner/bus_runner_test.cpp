// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The thread of the driver with simulated drives inside the process, and other threads around it.
#include "bus/runner.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <atomic>
#include <filesystem>
#include <future>
#include <limits>
#include <thread>

#include "sim/world/simulated_interface.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;

class SimulatedRunner : public testing::Test {
 protected:
  ~SimulatedRunner() override {
    runner.reset();
    if (!folder.empty()) std::filesystem::remove_all(folder);
  }
  void begin(std::function<Time()> clock = bus::realNow) {
    char name[] = "/tmp/bus_runner_test_XXXXXX";
    folder = mkdtemp(name);
    LoadedRobot loaded = loadText(mixedPair());
    loaded.robot.recorder.directory = folder;
    loaded.robot.recorder.keep = 3;
    bus::BusRunner::Options options;
    options.priority = priority;
    options.time = bus::BusTime::Kind::simulated;
    options.clock = clock;
    auto interface = std::make_unique<sim::SimulatedInterface>(
        loaded.drives, loaded.robot.bus.bitrate, options.clock());
    simulation = interface.get();
    if (monitor) simulation->world().bus().setMonitor(monitor);
    runner = std::make_unique<bus::BusRunner>(loaded.robot, loaded.master, std::move(interface),
                                              options);
    runner->start();
    faults_at_start = pageFaults();
    while (!all([](const bus::AxisSnapshot& axis) { return axis.state.feedback_valid; })) {
      std::this_thread::yield();
    }
  }
  /// A clock that the runner may read until it is destroyed.
  static std::function<Time()> clockThatJumps(int every_readings) {
    auto readings = std::make_shared<std::atomic<int>>(0);
    return [readings, every_readings] {
      return bus::realNow() + ((*readings)++ / every_readings) * Duration(10s);
    };
  }
  template <typename Condition>
  bool all(Condition&& condition) {
    const bus::NetworkSnapshot snapshot = runner->snapshot();
    return std::all_of(snapshot.axes.begin(), snapshot.axes.end(), condition);
  }
  std::uint64_t cycles() { return runner->snapshot().statistics.cycles(); }
  void waitCycles(std::uint64_t count) {
    for (const std::uint64_t end = cycles() + count; cycles() < end;) std::this_thread::yield();
  }
  template <typename Request>
  bus::Answer call(Request request) {
    auto promise = std::make_shared<std::promise<bus::Answer>>();
    auto answer = promise->get_future();
    runner->post(bus::Command(std::move(request),
                              [promise](const bus::Answer& given) { promise->set_value(given); }));
    return answer.get();
  }
  bus::Answer procedure(ProcedureKind kind, const std::string& axis = {}) {
    bus::ProcedureCommand command;
    command.axis = axis;
    command.request.kind = kind;
    return call(command);
  }

  /// Page faults that the thread of the bus has had so far, without and with reading from a disk.
  std::string pageFaults() {
    return call(bus::CallCommand{[](Time) {
             rusage usage{};
             getrusage(RUSAGE_THREAD, &usage);
             return bus::answerOf(
                 true, std::to_string(usage.ru_minflt) + ", " + std::to_string(usage.ru_majflt));
           }})
        .message;
  }

  int priority = 0;
  std::string folder, faults_at_start;
  std::function<void(const can::Frame&, Time)> monitor;  ///< of the bus, in its thread
  sim::SimulatedInterface* simulation = nullptr;
  std::unique_ptr<bus::BusRunner> runner;
};

TEST_F(SimulatedRunner, KeepsItsDrivesOnAClockThatJumps) {
  begin(clockThatJumps(200));
  ASSERT_TRUE(procedure(ProcedureKind::enable).success);
  waitCycles(500);
  EXPECT_TRUE(all([](const bus::AxisSnapshot& axis) {
    return axis.state.state == drive::State::operation_enabled && axis.emergencies.total == 0;
  }));
  EXPECT_EQ(runner->snapshot().statistics.overruns(), 0U);
  EXPECT_GE(runner->time().lost(), 10s);
}

TEST_F(SimulatedRunner, EndsOnAClockThatJumps) {
  begin(clockThatJumps(50));
  ASSERT_TRUE(procedure(ProcedureKind::enable).success);
  runner->requestShutdown();
  runner->join();
  EXPECT_FALSE(runner->running());
  EXPECT_TRUE(all([](const bus::AxisSnapshot& axis) {
    return axis.state.state != drive::State::operation_enabled;
  }));
}

/// Drives that watch SYNC see it on the wire when it is sent, not when something was there last.
TEST_F(SimulatedRunner, SendsSyncAtItsTimeOfTheSimulatedBus) {
  Time sync = Time::min();
  std::vector<double>
      later;  // s, from the end of SYNC to that of the RPDO half a period (2 ms) later
  monitor = [&](const can::Frame& frame, Time end) {
    if (frame.id == 0x80) sync = end;
    if (frame.id == 0x201 && sync > Time::min()) later.push_back(toSeconds(end - sync));
  };
  begin();
  waitCycles(300);
  runner.reset();
  EXPECT_GT(later.size(), 200U);
  // Either waits for the frame that is on its way, the RPDO also for those of the drives.
  EXPECT_THAT(later, testing::Each(testing::DoubleNear(0.0022, 0.0004)));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they have heaps of their own
// Boot, procedures, motion and failures; the simulated drives live in the same thread.
TEST_F(SimulatedRunner, ThreadOfTheBusHasNoPageFaultOnceItRuns) {
  priority = 1;
  bus::keepMemory();
  begin();
  ASSERT_TRUE(procedure(ProcedureKind::enable).success);
  bus::TrajectoryCommand trajectory;
  trajectory.group = "pair";
  trajectory.joints = {"left", "right"};
  for (int i = 1; i <= 100; ++i) {
    trajectory.points.push_back({{0.001 * i, 0.001 * i}, {0.0, 0.0}, {}, i * 1s});
  }
  const bus::Answer accepted = call(trajectory);
  ASSERT_TRUE(accepted.success) << accepted.message;
  waitCycles(100);
  const auto inject = [this](const char* what) {
    return call(bus::CallCommand{[this, what](Time now) {
      return bus::answerOf(simulation->world().drive(0).inject(what, now).ok(), what);
    }});
  };
  ASSERT_TRUE(inject("encoder").success);
  waitCycles(100);
  ASSERT_TRUE(inject("clear").success);
  EXPECT_TRUE(call(bus::ErrorHistoryCommand{"left"}).success);
  EXPECT_TRUE(procedure(ProcedureKind::recover).success);
  EXPECT_TRUE(call(bus::ReadObjectCommand{"left", "6064"}).success);
  EXPECT_FALSE(call(bus::WriteObjectCommand{"left", "none such", "1"}).success);
  EXPECT_TRUE(procedure(ProcedureKind::quick_stop).success);
  EXPECT_EQ(pageFaults(), faults_at_start);
  munlockall();
}
#endif

/// Everything that ROS does with it, from as many threads, with good and bad arguments.
TEST_F(SimulatedRunner, AnswersEveryCallOfManyThreadsAtOnce) {
  begin();
  std::atomic<bool> end{false};
  std::atomic<int> answers{0};
  std::vector<std::thread> threads;
  const auto often = [&](auto&& work) {
    threads.emplace_back([&end, work] {
      for (int i = 0; !end; ++i) work(i);
    });
  };
  const auto told = [&answers](const bus::Answer& answer) {
    EXPECT_TRUE(answer.success || !answer.message.empty());
    ++answers;
  };
  const std::vector<std::string> axes = {"left", "right", "", "nobody"};
  const std::vector<ProcedureKind> kinds = {
      ProcedureKind::enable,       ProcedureKind::halt,    ProcedureKind::recover,
      ProcedureKind::quick_stop,   ProcedureKind::disable, ProcedureKind::clear_faults,
      ProcedureKind::set_position, ProcedureKind::set_mode};
  for (std::size_t thread = 0; thread < 2; ++thread) {
    often([&, thread](int i) {
      const auto n = static_cast<std::size_t>(i) + thread;
      told(procedure(kinds[n % kinds.size()], axes[n % axes.size()]));
    });
  }
  often([&](int i) {
    const std::string& axis = axes[static_cast<std::size_t>(i) % axes.size()];
    told(call(bus::ReadObjectCommand{axis, i % 2 != 0 ? "6064" : "none such"}));
    told(call(bus::WriteObjectCommand{axis, "6065", i % 2 != 0 ? "123456" : "fast"}));
    told(call(bus::ErrorHistoryCommand{axis}));
    told(call(bus::NmtServiceCommand{axis, i % 2 != 0 ? "start" : "jump"}));
  });
  often([&](int i) {
    constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
    runner->post(bus::Command(bus::SetpointCommand{static_cast<std::size_t>(i % 2),
                                                   i % 5 == 0 ? kNoNumber : 0.001 * (i % 100)}));
    bus::TrajectoryCommand trajectory;
    trajectory.group = "pair";
    trajectory.joints = {"left", i % 3 == 0 ? "neck" : "right"};
    trajectory.points = {{{0.1, 0.1}, {0.0, 0.0}, {}, 1s}};
    if (i % 2 == 0) trajectory.start_time = runner->time().fromClock(bus::realNow() + 10ms);
    told(call(trajectory));
  });
  often([&](int i) {
    const auto inject = [this, i](Time now) {
      const auto done = simulation->world().drive(0).inject(i % 2 == 0 ? "encoder" : "clear", now);
      return bus::answerOf(done.ok(), "injected");
    };
    told(call(bus::CallCommand{inject}));
    waitCycles(20);
  });
  often([&](int) {
    const bus::NetworkSnapshot snapshot = runner->snapshot();
    EXPECT_GE(runner->time().now(), snapshot.now);
    EXPECT_GE(runner->time().toClock(snapshot.now), snapshot.now);
    for (bus::Event event; runner->nextEvent(event);) EXPECT_FALSE(event.text.empty());
    for (bus::EmergencyEvent event; runner->nextEmergency(event);) EXPECT_LT(event.axis, 2U);
    bus::RecordingService::News news;
    while (runner->recordings().nextNews(news)) EXPECT_TRUE(news.written) << news.text;
    (void)runner->realtime();
  });
  often([&](int) {
    EXPECT_FALSE(runner->recordings().request().text.empty());
    waitCycles(50);
  });
  waitCycles(1000);
  end = true;
  for (std::thread& thread : threads) thread.join();
  EXPECT_GE(answers.load(), 100);
}

}  // namespace
}  // namespace cia402
