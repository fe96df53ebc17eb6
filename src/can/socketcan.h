// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "can/bus.h"
#include "can/bus_off_recovery.h"
#include "can/pending_queue.h"
#include "can/receive_filters.h"

namespace cia402::can {

class LinkProbe;
class LinkReader;
struct LinkSettings;
class RawSocket;

/// A CAN interface of Linux. Time stamps are the kernel's, mapped to CLOCK_MONOTONIC, which is the
/// BusClock of the real world; a step of the wall clock does not reach them.
///
/// The interface may be missing, go down, come up, vanish and come back with another index at any
/// time: state() tells, and maintain() opens it again.
///
/// After bus-off the controller is restarted with growing delays (BusOffRecovery): by the kernel
/// where its restart-ms is set, else by a request to the kernel, which needs CAP_NET_ADMIN; where
/// neither is possible describe() says what to do. Bus-off is over when an error frame says so,
/// when frames are received again, or when the kernel says that the controller is well. An
/// interface without a controller (vcan) is taken as back once its delay is over.
///
/// Safety: frames of the identifiers in Options::cyclic never wait longer than
/// Options::cyclic_lifetime, and only the newest of each identifier waits at all. While the
/// interface is missing, down or bus-off, send() refuses, and what still waited in our queue is
/// thrown away (counted in frames_dropped). A command from before the interruption never reaches a
/// drive after it.
///
/// Frames sent here are seen by other sockets on this machine, not by this one. Nothing allocates
/// once the object exists, but describe(), setFilters() and opening an interface. Not thread-safe
/// but for setFilters().
class SocketCan final : public Interface {
 public:
  /// What an interface is to do beside passing frames on.
  struct Options {
    /// 11-bit identifiers of frames of which only the newest is worth sending.
    std::bitset<2048> cyclic;
    Duration cyclic_lifetime{8'000'000};   ///< so long may such a frame wait
    Duration other_lifetime{500'000'000};  ///< so long may any other frame wait
    BusOffRecovery::Options recovery;
    std::size_t queue_capacity = 512;    ///< frames that may wait for the kernel
    Duration check_period{100'000'000};  ///< how often maintain() looks at the interface
    std::vector<ReceiveFilter> filters;  ///< by the kernel; empty: everything
    int receive_buffer = 1 << 20;        ///< bytes; the kernel may allow less
    unsigned bitrate = 1'000'000;        ///< bit/s, named in the advice of describe() only
    /// Error frames are received. Simulated drives do without: what the controller of this
    /// interface suffers is not theirs.
    bool error_frames = true;
  };

  /// Opens the interface if it is there; if not, maintain() will.
  explicit SocketCan(std::string name) : SocketCan(std::move(name), Options()) {}
  /// @param name of the interface: "can0"
  SocketCan(std::string name, Options options);
  ~SocketCan() override;
  SocketCan(const SocketCan&) = delete;
  SocketCan& operator=(const SocketCan&) = delete;

  /// Sends, or queues behind frames that wait. @return false, counted in frames_dropped: the queue
  /// is full, the interface is missing, down or bus-off, or the frame is none that can be sent.
  bool send(const Frame& frame) override;
  /// To be called until it returns nothing. Error frames of the controller have changed state()
  /// before they are handed out.
  std::optional<ReceivedFrame> receive(Time now) override;
  /// Sends waiting frames and, every check period, looks at the interface. Finding one that comes
  /// or goes can take the kernel a few milliseconds.
  void maintain(Time now) override;

  /// Another one, or -1, after each maintain() that lost or opened the interface.
  int fd() const override;
  /// From the kernel's error frames. Many drivers do not report that a disturbed controller is well
  /// again: error_warning and error_passive then stay until the interface restarts.
  BusState state() const override { return state_; }
  const BusCounters& counters() const override { return counters_; }
  /// As can::Interface says.
  std::string describe() const override;
  std::string recovery() const override { return recovery_note_; }
  std::optional<ErrorCounters> errorCounters() const override { return error_counters_; }

  /// Replaces the kernel's receive filters; an empty list receives everything. Any thread may call
  /// it, and should, but the one of the cycle: the kernel may let it wait while another process
  /// configures interfaces. Only opening or losing the interface waits for it.
  void setFilters(std::vector<ReceiveFilter> filters);
  /// The last error frame in words, or empty.
  std::string lastErrorFrame() const;
  /// Frames waiting for the kernel.
  std::size_t pending() const override { return pending_.size(); }
  const std::string& name() const { return name_; }

 private:
  enum class Attempt { sent, busy, failed };

  bool canSend() const;
  bool refuse();
  Attempt attempt(const Frame& frame);
  void flushPending();
  void checkLink();
  void updateState(bool up, bool carrier);
  void countOverflows();
  std::string describeMissing() const;
  void becomeUnusable(BusState state);
  void closeSocket();
  int openSocket(int interface_index);
  void handleError(int error);
  void handleErrorFrame(const Frame& frame, Time stamp);
  void countStale() { counters_.frames_stale = pending_.stale(); }
  void comeBack(BusState state);
  void tryToReturn();
  void restart(const LinkSettings& link);

  std::string name_;
  Options options_;
  std::unique_ptr<LinkProbe> probe_;
  std::unique_ptr<RawSocket> socket_;
  std::mutex opening_;  ///< the socket is opened or closed, or gets its filters
  PendingQueue pending_;
  std::unique_ptr<LinkReader> reader_;
  BusOffRecovery recovery_;
  std::string recovery_note_;
  std::optional<ErrorCounters> error_counters_;
  Time bus_off_at_{};
  BusState state_ = BusState::missing;
  BusCounters counters_;
  std::optional<Frame> last_error_frame_;
  Time next_check_ = Time::min();
  bool batch_done_ = false;           // everything was handed out since the last read
  std::uint32_t overflows_seen_ = 0;  // of this socket
  bool carrier_was_lost_ = false;     // since bus-off
  int open_error_ = 0;                // errno of the last attempt to open
};

}  // namespace cia402::can
